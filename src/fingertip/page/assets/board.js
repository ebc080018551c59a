// List of parts and pictures of the board: a line highlights its parts on all pictures, and a part its line.
(() => {
  const table = document.getElementById('bom');
  const parts = [...document.querySelectorAll('[data-part]')];
  if (!table || !parts.length) return;
  const lines = [...table.tBodies[0].rows].map((row) => ({ row, names: row.dataset.parts.split(' ') }));
  const lineOf = new Map(lines.flatMap((line) => line.names.map((name) => [name, line])));
  const ticks = globalThis.fingertipTicks('placed');
  let picked = [];

  function mark(names, name) {
    for (const part of parts) part.classList.toggle(name, names.includes(part.dataset.part));
  }
  function show(names) {
    picked = names;
    mark(names, 'picked');
    for (const { row, names: own, button } of lines) {
      const isPicked = names.some((name) => own.includes(name));
      row.classList.toggle('picked', isPicked);
      button.setAttribute('aria-pressed', String(isPicked));
    }
    select.value = names.length === 1 ? names[0] : '';
    const line = names.length ? lineOf.get(names[0]) : null;
    status.textContent = !names.length ? 'Nothing is highlighted.'
      : `${names.join(', ')}${line ? `: ${line.row.dataset.value}` : ''}`;
  }
  function count() {
    const all = lines.reduce((sum, { names }) => sum + names.length, 0);
    const done = lines.reduce((sum, { names }) => sum + (ticks.has(names[0]) ? names.length : 0), 0);
    total.textContent = `${done} of ${all} parts placed`;
    mark(lines.filter(({ names }) => ticks.has(names[0])).flatMap(({ names }) => names), 'placed');
  }

  const controls = document.getElementById('bom-controls');
  const label = document.createElement('label');
  const select = document.createElement('select');
  const status = document.createElement('output');
  const total = document.createElement('output');
  select.id = 'bom-part';
  status.id = 'bom-status';
  total.id = 'bom-placed';
  label.append('highlight part ', select);
  const order = new Intl.Collator('en', { numeric: true });
  for (const name of ['', ...new Set(parts.map((part) => part.dataset.part))].sort(order.compare)) {
    select.add(new Option(name || 'none', name));
  }
  select.addEventListener('change', () => show(select.value ? [select.value] : []));
  controls.append(label, status, total);
  controls.hidden = false;

  const heading = document.createElement('th');
  heading.scope = 'col';
  heading.textContent = 'placed';
  table.tHead.rows[0].prepend(heading);
  for (const line of lines) {
    const { row, names } = line;
    const cell = row.querySelector('.references');
    line.button = document.createElement('button');
    line.button.type = 'button';
    line.button.className = 'code';
    line.button.textContent = cell.textContent;
    line.button.setAttribute('aria-pressed', 'false');
    line.button.addEventListener('click', () => {
      const isOff = line.button.getAttribute('aria-pressed') === 'true' && picked.length === names.length;
      show(isOff ? [] : names);
    });
    cell.replaceChildren(line.button);
    row.addEventListener('pointerenter', () => mark(names, 'pointed'));
    row.addEventListener('pointerleave', () => mark([], 'pointed'));
    line.button.addEventListener('focus', () => mark(names, 'pointed'));
    line.button.addEventListener('blur', () => mark([], 'pointed'));
    const box = document.createElement('input');
    box.type = 'checkbox';
    box.checked = ticks.has(names[0]);
    box.setAttribute('aria-label', `${names.join(', ')} placed`);
    box.addEventListener('change', () => {
      ticks.set(names[0], box.checked);
      count();
    });
    Object.assign(row.insertCell(0), { className: 'tick' }).append(box);
  }
  for (const part of parts) {
    part.addEventListener('click', () => {
      const name = part.dataset.part;
      show(picked.length === 1 && picked[0] === name ? [] : [name]);
      const line = picked.length ? lineOf.get(name) : null;
      if (line) line.row.scrollIntoView({ block: 'nearest' });
    });
    const line = lineOf.get(part.dataset.part);
    part.addEventListener('pointerenter', () => line?.row.classList.add('pointed'));
    part.addEventListener('pointerleave', () => line?.row.classList.remove('pointed'));
  }
  show([]);
  count();
})();
