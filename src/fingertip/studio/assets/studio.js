// Form of the studio: each change goes to the server, and its answer to the 3D view, the fields and the checks.
(() => {
  'use strict';

  const root = document.documentElement;
  const view = globalThis.fingertipView; // undefined in a browser without WebGL
  const client = crypto.randomUUID();
  const MAX_LINKS = 3; // to refused parameters, beside their number
  const SILENCE = '✗ The studio does not answer: start it again in its terminal, and open the address that it shows.';
  const byId = (id) => document.getElementById(id);

  const fields = [...document.querySelectorAll('.field')].map((element) => {
    const { path, kind, pointer } = element.dataset;
    const input = byId(`f-${path}`);
    return {
      element, path, kind, pointer, input,
      slider: element.querySelector('input[type=range]'),
      reset: element.querySelector('.reset'),
      refusal: byId(`e-${path}`),
      initial: input.value,
    };
  });
  const isNumber = ({ kind }) => kind === 'number' || kind === 'integer';

  // What is no number is sent as text: the server says what is wrong with it.
  function read(field) {
    const text = field.input.value.trim();
    return isNumber(field) && text !== '' && Number.isFinite(Number(text)) ? Number(text) : field.input.value;
  }
  function collect() {
    const tables = {};
    for (const field of fields) {
      const steps = field.path.split('.');
      const name = steps.pop();
      const table = steps.reduce((found, step) => { found[step] ??= {}; return found[step]; }, tables);
      table[name] = read(field);
    }
    return tables;
  }
  const hasChanged = (field) => (isNumber(field) && field.input.value !== ''
    ? Number(field.input.value) !== Number(field.initial) : field.input.value !== field.initial);

  function ask(address) {
    return fetch(`/api/${address}`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json', 'X-Fingertip-Token': root.dataset.token },
      body: JSON.stringify({ client, tables: collect() }),
    });
  }

  function say(text, kind) {
    const paragraph = document.createElement('p');
    paragraph.className = `verdict ${kind}`;
    paragraph.textContent = text;
    byId('verdict').replaceChildren(paragraph);
  }

  function showRefusals(issues) {
    const known = new Map(fields.map((field) => [field.pointer, field]));
    const own = new Map();
    const others = [];
    for (const issue of issues) {
      const field = known.get(issue.pointer);
      if (field) own.set(field, [...(own.get(field) ?? []), issue.message]);
      else others.push(issue.field ? `${issue.field}: ${issue.message}` : issue.message);
    }
    for (const field of fields) {
      const messages = own.get(field) ?? [];
      field.refusal.textContent = messages.join(' ');
      field.refusal.hidden = messages.length === 0;
      field.element.classList.toggle('refused', messages.length > 0);
      if (messages.length) {
        field.input.setAttribute('aria-invalid', 'true');
        field.element.closest('details').open = true;
      } else field.input.removeAttribute('aria-invalid');
    }
    byId('other-refusals').hidden = others.length === 0;
    byId('other-refusals').replaceChildren(...others.map((text) => {
      const item = document.createElement('li');
      item.textContent = text;
      return item;
    }));
    count();
  }

  function count() {
    for (const group of document.querySelectorAll('.group')) {
      const inside = fields.filter(({ element }) => group.contains(element));
      const changed = inside.filter(hasChanged).length;
      const refused = inside.filter(({ element }) => element.classList.contains('refused')).length;
      group.querySelector('.counts').textContent =
        `${changed ? `, ${changed} changed` : ''}${refused ? `, ${refused} refused` : ''}`;
    }
    for (const field of fields) {
      field.element.classList.toggle('changed', hasChanged(field));
      field.reset.hidden = !hasChanged(field);
    }
  }

  // The answer of a request; null if there is none to show, and the page then says why.
  async function receive(response) {
    const answer = await response.json();
    if (answer.superseded) return null; // by a newer request of this page
    if (answer.issues) {
      showRefusals(answer.issues);
      say(`✗ ${answer.issues.length} refused; the view shows the last design that passed: `, 'failed');
      for (const { field } of answer.issues.filter((issue) => byId(`p-${issue.field}`)).slice(0, MAX_LINKS)) {
        const link = document.createElement('a');
        link.href = `#p-${field}`;
        link.textContent = field;
        byId('verdict').firstChild.append(link, ' ');
      }
      return null;
    }
    if (answer.error) {
      say(`✗ ${answer.error}`, 'failed');
      return null;
    }
    return answer;
  }
  const isFile = (response) => response.headers.has('Content-Disposition');

  let isBusy = false;
  let changedAt = null; // when the oldest change that was not sent yet was made
  async function update() {
    if (isBusy) return;
    isBusy = true;
    root.dataset.busy = 'true';
    try {
      while (changedAt !== null) {
        const started = changedAt;
        changedAt = null;
        const answer = await receive(await ask('parts'));
        if (answer) {
          showRefusals([]);
          view?.replace(answer.scene, answer.boxes);
          await view?.drawn();
          const taken = performance.now() - started;
          root.dataset.changeMs = String(Math.round(taken));
          byId('change-time').textContent = `drawn in ${(taken / 1000).toFixed(2)} s`;
          if (changedAt === null) await check('checks');
        }
      }
    } catch {
      say(SILENCE, 'failed');
    } finally {
      isBusy = false;
      delete root.dataset.busy;
    }
  }

  async function askUnlessChanged(address) {
    const asked = ask(address);
    // A change that comes meanwhile is sent at once: the server then gives this up.
    const waiting = new Promise((resolve) => { interrupt = () => resolve(null); });
    const response = await Promise.race([asked, waiting]);
    interrupt = () => {};
    if (response === null) {
      asked.catch(() => {}); // nobody waits for its answer any more
      return null;
    }
    return receive(response);
  }

  async function check(address) {
    say('checking', '');
    const answer = await askUnlessChanged(address);
    if (!answer) return;
    byId('verdict').innerHTML = answer.verdict;
    byId('checks').innerHTML = answer.checks;
    globalThis.fingertipWatch(byId('checks'));
    root.dataset.checked = String(answer.count);
    for (const button of answer.moves ? document.querySelectorAll('[data-named]') : []) {
      const items = answer.moves[button.dataset.named] ?? [];
      button.dataset.moves = items.join(' ');
      button.hidden = items.length === 0;
    }
    const drawn = answer.pad ? answer : changedAt === null && await askUnlessChanged('pad');
    if (drawn) byId('pad').innerHTML = drawn.pad;
  }
  let interrupt = () => {};

  function change() {
    changedAt ??= performance.now();
    interrupt();
    count();
    update();
  }

  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  function follow(field) { // the slider follows the number
    const value = Number(field.input.value);
    if (!field.slider || !Number.isFinite(value)) return;
    const position = 'log' in field.slider.dataset ? Math.log10(value) : value;
    field.slider.value = String(clamp(position, Number(field.slider.min), Number(field.slider.max)));
    tell(field);
  }
  function tell({ slider, input, element }) {
    slider?.setAttribute('aria-valuetext', `${input.value} ${element.querySelector('.unit').textContent}`.trim());
  }
  for (const field of fields) {
    const { input, slider, reset, kind } = field;
    input.addEventListener('input', () => {
      follow(field);
      change();
    });
    slider?.addEventListener('input', () => {
      const value = Number(slider.value);
      const chosen = 'log' in slider.dataset ? Number((10 ** value).toPrecision(3)) : Number(value.toPrecision(12));
      input.value = String(kind === 'integer' ? Math.round(chosen) : chosen);
      tell(field);
      change();
    });
    reset.addEventListener('click', () => {
      input.value = field.initial;
      follow(field);
      input.focus();
      change();
    });
    tell(field);
  }
  byId('form').addEventListener('submit', (event) => event.preventDefault());

  // Fields without the words that are sought, and groups without fields, are hidden.
  byId('find').addEventListener('input', ({ target }) => {
    const words = target.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const group of document.querySelectorAll('.group')) {
      let found = 0;
      for (const { element, path } of fields.filter((field) => group.contains(field.element))) {
        const text = `${path} ${byId(`d-${path}`).textContent}`.toLowerCase();
        element.hidden = !words.every((word) => text.includes(word));
        found += element.hidden ? 0 : 1;
      }
      group.hidden = found === 0;
      if (words.length && found) group.open = true;
    }
  });
  addEventListener('click', ({ target }) => { // a check names its parameters
    const link = target.closest('#checks a[href^="#p-"]');
    const group = link && byId(decodeURIComponent(link.hash.slice(1)))?.closest('details');
    if (group) group.open = true;
  });

  byId('check-all').addEventListener('click', async ({ target }) => {
    target.disabled = true;
    await check('all-checks').catch(() => say(SILENCE, 'failed'));
    target.disabled = false;
  });
  for (const button of document.querySelectorAll('[data-download]')) {
    button.addEventListener('click', async () => {
      button.disabled = true;
      try {
        const response = await ask(`download/${button.dataset.download}`);
        if (!isFile(response)) await receive(response);
        else {
          const link = document.createElement('a');
          link.href = URL.createObjectURL(await response.blob());
          [, link.download] = response.headers.get('Content-Disposition').match(/filename="([^"]*)"/);
          link.click();
          setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
        }
      } catch {
        say(SILENCE, 'failed');
      }
      button.disabled = false;
    });
  }
  change();
})();
