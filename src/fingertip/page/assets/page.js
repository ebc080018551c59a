// Tabs, boxes to tick, and pictures to enlarge. Without this script a page is one long document.
(() => {
  'use strict';

  const make = (name, properties) => Object.assign(document.createElement(name), properties);
  const panels = [...document.querySelectorAll('.panel')];
  const list = document.getElementById('tabs');
  const tabs = [...list.querySelectorAll('a')];

  function select(chosen) {
    panels.forEach((panel, i) => {
      panel.hidden = panel !== chosen;
      tabs[i].setAttribute('aria-selected', String(panel === chosen));
      tabs[i].tabIndex = panel === chosen ? 0 : -1;
    });
  }
  // Select the tab that holds what the address names, unfold it, and go there.
  function follow() {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const panel = target?.closest('.panel');
    if (!panel) return;
    select(panel);
    for (let inner = target; inner !== panel; inner = inner.parentElement) if (inner.tagName === 'DETAILS') inner.open = true;
    if (target === panel) scrollTo(0, 0);
    else target.scrollIntoView();
  }
  list.setAttribute('role', 'tablist');
  tabs.forEach((tab, i) => {
    tab.parentElement.setAttribute('role', 'none');
    tab.setAttribute('role', 'tab');
    tab.setAttribute('aria-controls', panels[i].id);
    panels[i].setAttribute('role', 'tabpanel');
    tab.addEventListener('click', () => { if (location.hash === tab.hash) follow(); });
    tab.addEventListener('keydown', (event) => {
      const last = tabs.length - 1;
      const next = { ArrowRight: i < last ? i + 1 : 0, ArrowLeft: i ? i - 1 : last, Home: 0, End: last }[event.key];
      if (next === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      tabs[next].focus();
      tabs[next].click();
    });
  });
  if (matchMedia('(max-width: 48rem)').matches) {
    for (const details of document.querySelectorAll('details.roomy')) details.open = false;
  }
  select(panels[0]);
  addEventListener('hashchange', () => {
    follow();
    // The browser has taken the focus from the tab, which arrow keys go on from.
    tabs.find((tab) => tab.hash === location.hash)?.focus({ preventScroll: true });
  });
  follow();

  // Names that were ticked in a list of this design. A browser may refuse to store anything for a file; ticks then last
  // as long as the page is open.
  globalThis.fingertipTicks = (name) => {
    const key = `fingertip-${name}-${document.documentElement.dataset.design}`;
    let ticked = new Set();
    try { ticked = new Set(JSON.parse(localStorage.getItem(key)) || []); } catch { /* as above */ }
    return {
      has: (item) => ticked.has(item),
      set(item, isDone) {
        if (isDone) ticked.add(item);
        else ticked.delete(item);
        try { localStorage.setItem(key, JSON.stringify([...ticked])); } catch { /* as above */ }
      },
    };
  };
  for (const name of new Set([...document.querySelectorAll('[data-ticks]')].map((each) => each.dataset.ticks))) {
    const lists = [...document.querySelectorAll(`[data-ticks="${name}"]`)];
    const ticks = globalThis.fingertipTicks(name);
    const total = make('output', { id: `ticks-${name}` });
    const reset = make('button', { type: 'button', textContent: 'untick all' });
    const row = make('div', { className: 'row ticked' });
    row.append(total, reset);
    (lists[0].closest('.scroll') ?? lists[0]).before(row);
    for (const table of lists) table.tHead?.rows[0].prepend(make('th', { scope: 'col', textContent: 'done' }));
    const boxes = lists.flatMap((each) => [...each.querySelectorAll('tbody tr, [data-tick]')]).map((item) => {
      const said = (item.dataset.tick ?? [...item.cells].map((cell) => cell.textContent).join(' ')).trim();
      const box = make('input', { type: 'checkbox', checked: ticks.has(said) });
      box.setAttribute('aria-label', `done: ${said}`);
      const details = item.querySelector('details');
      if (item.cells) Object.assign(item.insertCell(0), { className: 'tick' }).append(box);
      else item.prepend(box);
      box.addEventListener('change', () => {
        ticks.set(said, box.checked);
        count();
        // The next step is unfolded in place of the one that is done.
        const next = item.nextElementSibling?.querySelector('details');
        if (box.checked && details?.open) {
          details.open = false;
          if (next) next.open = true;
        }
      });
      return { box, item, said };
    });
    function count() {
      for (const { box, item } of boxes) item.classList.toggle('done', box.checked);
      const done = boxes.filter(({ box }) => box.checked).length;
      total.textContent = `${done} of ${boxes.length} ${lists[0].dataset.noun}`;
      reset.hidden = done === 0;
    }
    reset.addEventListener('click', () => {
      for (const each of boxes) {
        each.box.checked = false;
        ticks.set(each.said, false);
      }
      count();
    });
    count();
  }

  // A picture of a step stands small beside its title too. Every picture can be enlarged.
  const dialog = make('dialog', { className: 'enlarged' });
  const shown = make('div', { tabIndex: 0 });
  const close = make('button', { type: 'button', textContent: 'close' });
  close.addEventListener('click', () => dialog.close());
  dialog.addEventListener('click', ({ target }) => { if (target === dialog) dialog.close(); });
  dialog.append(close, shown);
  document.body.append(dialog);
  for (const picture of document.querySelectorAll('figure:not(.finger) > svg, figure:not(.finger) > img, .steps img')) {
    const said = picture.getAttribute('alt') ?? picture.querySelector('title').textContent;
    const enlarge = make('button', { type: 'button', className: 'enlarge', textContent: 'enlarge' });
    enlarge.setAttribute('aria-label', `enlarge: ${said}`);
    const open = () => {
      dialog.setAttribute('aria-label', said);
      shown.replaceChildren(picture.cloneNode(true));
      dialog.showModal();
    };
    enlarge.addEventListener('click', open);
    if (picture.tagName === 'IMG') picture.addEventListener('click', open);
    const title = picture.closest('.steps details')?.firstElementChild;
    title?.append(Object.assign(picture.cloneNode(), { alt: '' }));
    picture.after(enlarge);
  }
})();
