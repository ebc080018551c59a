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
    const { path, kind } = element.dataset;
    const input = byId(`f-${path}`);
    return {
      element, path, kind, input,
      slider: element.querySelector('input[type=range]'),
      reset: element.querySelector('.reset'),
      refusal: byId(`e-${path}`),
      passing: byId(`b-${path}`),
      initial: input.value,
    };
  });
  const find = (path) => fields.find((field) => field.path === path);
  const isNumber = ({ kind }) => kind === 'number' || kind === 'integer';

  // What is no number is sent as text: the server says what is wrong with it.
  function read(field) {
    const text = field.input.value.trim();
    if (field.input.matches('select') && (text === 'true' || text === 'false')) return text === 'true';
    return isNumber(field) && text !== '' && Number.isFinite(Number(text)) ? Number(text) : field.input.value;
  }
  function collect(values) {
    const tables = {};
    for (const field of fields) {
      const steps = field.path.split('.');
      const name = steps.pop();
      const table = steps.reduce((found, step) => { found[step] ??= {}; return found[step]; }, tables);
      table[name] = values ? values[field.path] : read(field);
    }
    return tables;
  }
  const hasChanged = (field) => (isNumber(field) && field.input.value !== ''
    ? Number(field.input.value) !== Number(field.initial) : field.input.value !== field.initial);

  function ask(address, { signal, ...more } = {}) {
    return fetch(`/api/${address}`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json', 'X-Fingertip-Token': root.dataset.token },
      body: JSON.stringify({ client, tables: collect(), ...more }),
      signal,
    });
  }

  function say(text, kind, paths = []) {
    const paragraph = make('p', { className: `verdict ${kind}`, textContent: text });
    paragraph.append(...paths.flatMap((path) => [make('a', { href: `#p-${path}`, textContent: path }), ' ']));
    keepPlace(() => byId('verdict').replaceChildren(paragraph));
  }

  const make = (name, properties) => Object.assign(document.createElement(name), properties);

  // The field in hand stays where it is on the screen, whatever is said above it.
  function keepPlace(act) {
    const top = held?.element.getBoundingClientRect().top;
    act();
    if (held) scrollBy(0, held.element.getBoundingClientRect().top - top);
  }

  // What is refused stands beside the field in hand and beside those that are blamed.
  function showRefusals(issues, passing) {
    const own = new Map();
    const others = [];
    for (const issue of issues) {
      const field = find(issue.field);
      if (field) own.set(field, [...(own.get(field) ?? []), issue.message]);
      else others.push(issue.field ? `${issue.field}: ${issue.message}` : issue.message);
    }
    if (held && issues.length && !own.has(held)) own.set(held, issues.map((issue) => `${issue.field}: ${issue.message}`));
    for (const field of fields) {
      const messages = own.get(field) ?? [];
      field.refusal.replaceChildren(messages.join(' '));
      field.refusal.hidden = messages.length === 0;
      field.element.classList.toggle('refused', messages.length > 0);
      for (const input of [field.input, field.slider].filter(Boolean)) {
        if (messages.length) input.setAttribute('aria-invalid', 'true');
        else input.removeAttribute('aria-invalid');
      }
    }
    if (passing !== undefined) {
      const [field] = own.keys();
      const fix = make('button', { type: 'button', textContent: `set ${passing}` });
      fix.setAttribute('aria-label', `set ${passing} for ${field.path}`);
      fix.addEventListener('click', () => put(field, String(passing)));
      field.refusal.append(' ', fix);
    }
    byId('other-refusals').hidden = others.length === 0;
    byId('other-refusals').replaceChildren(...others.map((textContent) => make('li', { textContent })));
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
  async function receive(response, offersFit = true) {
    const answer = await response.json();
    if (answer.superseded) return null; // by a newer request of this page
    if (answer.issues) {
      if (answer.bands) showBands(find(answer.issues[0].field), answer);
      const paths = answer.issues.map((issue) => issue.field).filter(find).slice(0, MAX_LINKS);
      keepPlace(() => { // the line of the verdict grows too
        showRefusals(answer.issues, answer.passing);
        say(`✗ ${answer.issues.length} refused; the view shows the last design that passed: `, 'failed', paths);
        if (!offersFit) return;
        const button = make('button', { type: 'button', id: 'fit', textContent: 'Fit the other values' });
        button.addEventListener('click', fit);
        byId('verdict').firstChild.append(button);
      });
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
        const [path, tables] = [held?.path ?? '', collect()];
        const passed = await receive(await ask('rules', { field: path, tables }));
        root.dataset.rulesMs = String(Math.round(performance.now() - started));
        if (!passed) continue;
        keepPlace(() => showRefusals([]));
        const answer = await receive(await ask('parts', { tables }));
        if (answer) {
          view?.replace(answer.scene, answer.boxes);
          await view?.drawn();
          const taken = performance.now() - started;
          root.dataset.changeMs = String(Math.round(taken));
          byId('change-time').textContent = `drawn in ${(taken / 1000).toFixed(2)} s`;
          for (const follow of [showFigures, check]) if (changedAt === null) await follow();
        }
      }
    } catch {
      say(SILENCE, 'failed');
    } finally {
      isBusy = false;
      delete root.dataset.busy;
      hold(held);
    }
  }

  // A change that comes meanwhile is sent at once: the server then gives this up.
  let work = new AbortController();
  async function askUnlessChanged(address, more = {}) {
    try {
      return await receive(await ask(address, { signal: work.signal, ...more }), address !== 'fit');
    } catch (error) {
      if (error.name === 'AbortError') return null;
      throw error;
    }
  }

  // What was changed by hand stays; the other values follow where they have to, and are marked.
  const given = new Set();
  async function fit() {
    say('fitting the other values', '');
    root.dataset.busy = 'true';
    const answer = await askUnlessChanged('fit', { field: [...given].join(' ') }).catch(() => say(SILENCE, 'failed'));
    if (!isBusy) delete root.dataset.busy; // else a change came meanwhile
    if (!answer) return;
    for (const field of fields) field.element.classList.remove('fitted');
    const moved = answer.fitted.map(({ name, before, after, reason }) => {
      const field = find(name);
      field.input.value = String(after);
      field.element.classList.add('fitted');
      follow(field);
      const item = make('li', { textContent: `: ${before} became ${after}; ${reason}` });
      item.prepend(make('a', { href: `#p-${name}`, textContent: name }));
      return item;
    });
    byId('fitted').replaceChildren(...moved);
    byId('fitted').hidden = moved.length === 0;
    change(held);
  }

  async function showFigures() {
    const answer = await askUnlessChanged('figures');
    if (answer) byId('figures').innerHTML = answer.figures;
  }

  async function check(address = 'checks') {
    say('checking', '');
    const answer = await askUnlessChanged(address);
    if (!answer) return;
    keepPlace(() => { byId('verdict').innerHTML = answer.verdict; });
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

  function change(field) {
    changedAt ??= performance.now();
    if (field !== held) probing.abort();
    held = field;
    work.abort();
    work = new AbortController();
    for (const other of fields) if (other !== field) showBands(other, {});
    count();
    update();
  }

  // Values that pass, on the track of a slider and in words: of the field in hand, as the others are. They are asked for
  // when somebody takes it in hand, and given up when another one is.
  let held = null;
  let probing = new AbortController();
  async function hold(field) {
    if (field !== held) probing.abort();
    held = field;
    if (!field || !isNumber(field) || field.isProbed) return;
    field.isProbed = true;
    probing = new AbortController();
    const asked = ask('bands', { field: field.path, signal: probing.signal }).then((answer) => answer.json());
    showBands(field, await asked.catch(() => ({}))); // given up, maybe while the answer is read
  }
  function showBands(field, { bands, band_text: text }) {
    field.isProbed = Boolean(bands);
    field.passing.hidden = !bands;
    if (!bands) {
      field.slider?.style.removeProperty('--bands');
      return;
    }
    field.passing.textContent = text ? `not refused: ${text}` : 'every value is refused with the others as they are';
    const share = (value) => {
      const [low, high] = [Number(field.slider.min), Number(field.slider.max)];
      return `${(100 * clamp((place(field, value) - low) / (high - low), 0, 1)).toFixed(2)}%`;
    };
    const colours = bands.flatMap(([low, high]) => [
      `transparent ${share(low)}`, `var(--good) ${share(low)}`, `var(--good) max(${share(high)}, ${share(low)} + 3px)`,
      `transparent max(${share(high)}, ${share(low)} + 3px)`,
    ]);
    field.slider?.style.setProperty('--bands', `linear-gradient(to right, ${colours.join(', ') || 'transparent 0 100%'})`);
  }

  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  function follow(field) { // the slider follows the number
    const value = Number(field.input.value);
    if (!field.slider || !Number.isFinite(value)) return;
    field.slider.value = String(clamp(place(field, value), Number(field.slider.min), Number(field.slider.max)));
    tell(field);
  }
  function place({ slider }, value) {
    return 'log' in slider.dataset ? Math.log10(value) : value;
  }
  function put(field, value) {
    field.input.value = value;
    follow(field);
    field.input.focus();
    give(field);
  }
  function give(field) {
    if (hasChanged(field)) given.add(field.path);
    else given.delete(field.path);
    field.element.classList.remove('fitted');
    change(field);
  }
  function tell({ slider, input, element }) {
    slider?.setAttribute('aria-valuetext', `${input.value} ${element.querySelector('.unit').textContent}`.trim());
  }
  for (const field of fields) {
    const { element, input, slider, reset, kind } = field;
    for (const taken of ['focusin', 'pointerdown']) element.addEventListener(taken, () => hold(field));
    input.addEventListener('input', () => {
      follow(field);
      give(field);
    });
    slider?.addEventListener('input', () => {
      const value = Number(slider.value);
      const chosen = 'log' in slider.dataset ? Number((10 ** value).toPrecision(3)) : Number(value.toPrecision(12));
      input.value = String(kind === 'integer' ? Math.round(chosen) : chosen);
      tell(field);
      give(field);
    });
    reset.addEventListener('click', () => put(field, field.initial));
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
  addEventListener('click', ({ target }) => { // a check or a verdict names its parameters
    const link = target.closest('a[href^="#p-"]');
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
          const link = make('a', { href: URL.createObjectURL(await response.blob()) });
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

  // Bundled designs to start from, with pictures that are asked for one after another while nothing else is.
  const presets = JSON.parse(byId('presets').textContent);
  const starts = [...document.querySelectorAll('button[data-design]')];
  for (const button of starts) {
    button.addEventListener('click', () => {
      for (const field of fields) {
        field.input.value = String(presets[button.dataset.design][field.path]);
        follow(field);
      }
      given.clear();
      change(null);
    });
  }
  async function drawPresets() {
    for (const button of starts) {
      while (isBusy) await new Promise((resolve) => { setTimeout(resolve, 200); });
      const response = await ask('download/picture', { tables: collect(presets[button.dataset.design]) });
      if (!isFile(response)) return;
      button.firstChild.src = URL.createObjectURL(await response.blob());
      button.firstChild.hidden = false;
    }
  }
  change(null);
  drawPresets().catch(() => {});
})();
