// 3D view of a design, and what of the page needs a script. THREE is the bundle that stands before this script.
(() => {
  'use strict';

  const CREASE_COSINE = Math.cos((35 * Math.PI) / 180);
  const TURN = Math.PI / 24; // angle of one press of an arrow key
  const HIGHLIGHT = 0xffb02e;
  const STEP = 1.15; // zoom of one press of a key
  const DIRECTIONS = {
    slanted: [-0.8, 0.42, 0.43],
    dorsal: [0, 1, 0.0001],
    palmar: [0, -1, 0.0001],
    side: [-1, 0, 0],
    tip: [0, 0, 1],
  };
  const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

  const byId = (id) => document.getElementById(id);

  // All of a page is printed, also what is folded up on the screen.
  const folded = () => [...document.querySelectorAll('details:not([open])')];
  let unfolded = [];
  addEventListener('beforeprint', () => {
    unfolded = folded();
    for (const details of unfolded) details.open = true;
  });
  addEventListener('afterprint', () => {
    for (const details of unfolded) details.open = false;
  });

  // What scrolls by itself is reached with the keyboard, and nothing else.
  const watcher = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
      else target.removeAttribute('tabindex');
    }
  });
  globalThis.fingertipWatch = (within) => {
    for (const box of within.querySelectorAll('.scroll')) watcher.observe(box);
  };
  globalThis.fingertipWatch(document);

  const canvas = byId('canvas');
  if (!canvas) return;

  function decode(text, Type) {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
    return new Type(bytes.buffer);
  }

  // Normals at the corners, smoothed over facets that meet at less than the crease angle, and the creases as lines.
  function shade(vertices, triangles) {
    const corners = triangles.length;
    const points = new Float32Array(3 * corners);
    const facets = new Float32Array(corners);
    const begin = new Uint32Array(vertices.length / 3 + 1); // where the corners at each vertex begin in `around`
    for (let c = 0; c < corners; c += 1) {
      const v = 3 * triangles[c];
      points[3 * c] = vertices[v];
      points[3 * c + 1] = vertices[v + 1];
      points[3 * c + 2] = vertices[v + 2];
      begin[triangles[c] + 1] += 1;
    }
    for (let v = 1; v < begin.length; v += 1) begin[v] += begin[v - 1];
    const around = new Uint32Array(corners);
    const next = begin.slice();
    for (let c = 0; c < corners; c += 1) {
      around[next[triangles[c]]] = c;
      next[triangles[c]] += 1;
    }
    for (let t = 0; t < corners; t += 3) {
      const p = 3 * t;
      const ux = points[p + 3] - points[p];
      const uy = points[p + 4] - points[p + 1];
      const uz = points[p + 5] - points[p + 2];
      const wx = points[p + 6] - points[p];
      const wy = points[p + 7] - points[p + 1];
      const wz = points[p + 8] - points[p + 2];
      const x = uy * wz - uz * wy;
      const y = uz * wx - ux * wz;
      const z = ux * wy - uy * wx;
      const length = Math.sqrt(x * x + y * y + z * z) || 1;
      facets[t] = x / length;
      facets[t + 1] = y / length;
      facets[t + 2] = z / length;
    }
    const normals = new Float32Array(3 * corners);
    const lines = [];
    for (let c = 0; c < corners; c += 1) {
      const t = c - (c % 3);
      const end = t + ((c + 1) % 3); // the edge from corner c to this one
      for (let k = begin[triangles[c]]; k < begin[triangles[c] + 1]; k += 1) {
        const o = around[k] - (around[k] % 3);
        const cosine = facets[t] * facets[o] + facets[t + 1] * facets[o + 1] + facets[t + 2] * facets[o + 2];
        if (o === t || cosine > CREASE_COSINE) {
          normals[3 * c] += facets[o];
          normals[3 * c + 1] += facets[o + 1];
          normals[3 * c + 2] += facets[o + 2];
        } else if (t < o && triangles[o + ((around[k] + 2) % 3)] === triangles[end]) {
          // The other facet at this edge runs along it the other way.
          for (const corner of [c, end]) lines.push(points[3 * corner], points[3 * corner + 1], points[3 * corner + 2]);
        }
      }
    }
    return { points, normals, lines: new Float32Array(lines) };
  }

  function makeGeometry(points, normals) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    if (normals) geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
    geometry.computeBoundingBox();
    return geometry;
  }

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({
      canvas, antialias: true, alpha: true, stencil: true, preserveDrawingBuffer: true,
    });
  } catch {
    byId('view').hidden = true;
    byId('no-view').hidden = false;
    return;
  }
  renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
  renderer.localClippingEnabled = true;

  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8d8478, 2.2));
  const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
  scene.add(lamp);
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableDamping = false;
  controls.enableZoom = false; // the wheel scrolls the page until the view is used
  canvas.style.touchAction = 'pan-y'; // and so does a finger

  const plane = new THREE.Plane(new THREE.Vector3(-1, 0, 0), 0);
  const stencil = (side, operation) => new THREE.MeshBasicMaterial({
    side, clippingPlanes: [plane], colorWrite: false, depthWrite: false, depthTest: false,
    stencilWrite: true, stencilFunc: THREE.AlwaysStencilFunc,
    stencilFail: operation, stencilZFail: operation, stencilZPass: operation,
  });
  const behind = stencil(THREE.BackSide, THREE.IncrementWrapStencilOp);
  const before = stencil(THREE.FrontSide, THREE.DecrementWrapStencilOp);

  // Each item: its mesh and creases, and for the section what counts the surfaces in front of the plane and fills the cut.
  const make = (data, number) => {
    const vertices = decode(data.vertices, Float32Array);
    const triangles = decode(data.triangles, data.wide ? Uint32Array : Uint16Array);
    const { points, normals, lines } = shade(vertices, triangles);
    const geometry = makeGeometry(points, normals);
    const colour = new THREE.Color().setRGB(...data.colour, 'srgb');
    const material = new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide });
    const group = new THREE.Group();
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = 1000;
    const creases = new THREE.LineSegments(makeGeometry(lines), new THREE.LineBasicMaterial({ color: 0x2a2f36 }));
    creases.renderOrder = 1001;
    const counters = new THREE.Group();
    for (const counting of [behind, before]) {
      const counter = new THREE.Mesh(geometry, counting);
      counter.renderOrder = number;
      counters.add(counter);
    }
    group.add(mesh, creases, counters);
    group.scale.setScalar(1 / data.scale);
    const cap = new THREE.Mesh(
      new THREE.PlaneGeometry(400, 400),
      new THREE.MeshBasicMaterial({
        color: colour.clone().multiplyScalar(0.72), side: THREE.DoubleSide,
        stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc,
        stencilFail: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp,
        stencilZPass: THREE.ReplaceStencilOp,
      }),
    );
    cap.renderOrder = number + 0.1;
    cap.onAfterRender = (own) => own.clearStencil();
    scene.add(group, cap);
    return { ...data, vertices, triangles, group, mesh, creases, counters, cap, material, colour, shown: true };
  };
  function discard({ group, cap, mesh, creases, material }) {
    scene.remove(group, cap);
    for (const owned of [mesh.geometry, material, creases.geometry, creases.material, cap.geometry, cap.material]) {
      owned.dispose();
    }
  }
  let items = JSON.parse(byId('scene').textContent).map(make);
  const hasCore = () => items.some((item) => item.name === 'core');
  const OF_FINGER = ['bone', 'skin', 'sensor', 'joint_pin'];
  const isInMold = ({ name }) =>
    name !== 'joint_pin' && (!hasCore() || !OF_FINGER.includes(name) || name === 'skin');
  const PRESETS = {
    finger: { apart: 0, has: (item) => OF_FINGER.includes(item.name) },
    closed: { apart: 0, has: isInMold },
    opened: { apart: 50, has: isInMold },
    apart: { apart: 100, has: () => true },
  };

  let highlighted = [];
  let queued = false;
  function draw() {
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => {
      queued = false;
      lamp.position.copy(camera.position).sub(controls.target);
      lamp.position.addScaledVector(camera.up, lamp.position.length() * 0.6);
      renderer.render(scene, camera);
      if (!document.documentElement.dataset.drawnMs) {
        document.documentElement.dataset.drawnMs = String(Math.round(performance.now()));
      }
    });
  }

  function place() {
    const share = Number(byId('apart').value) / 100;
    const open = Math.min(1, 2 * share);
    const away = Math.max(0, 2 * share - 1);
    for (const item of items) {
      item.group.position.set(...item.opened.map((x, i) => x * open + item.apart[i] * away));
    }
    byId('apart-value').textContent = share === 0 ? 'closed' : share === 0.5 ? 'mold open' : `${Math.round(100 * share)} %`;
  }

  function shownCorners() {
    const corners = [];
    for (const item of items.filter((one) => one.shown)) {
      const { min, max } = item.mesh.geometry.boundingBox;
      for (let k = 0; k < 8; k += 1) {
        const corner = new THREE.Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z);
        corners.push(corner.divideScalar(item.scale).add(item.group.position));
      }
    }
    return corners;
  }

  // Centre what is shown and make it fill the view, seen from the direction of the camera or from another one.
  function fit(direction) {
    const corners = shownCorners();
    if (!corners.length || !canvas.clientHeight) return; // nothing is shown, or the view's tab is not
    const away = direction
      ? new THREE.Vector3(...direction).normalize()
      : camera.position.clone().sub(controls.target).normalize();
    const right = new THREE.Vector3(0, 1, 0).cross(away).normalize();
    const up = away.clone().cross(right);
    const range = (axis) => {
      const values = corners.map((corner) => corner.dot(axis));
      return [Math.min(...values), Math.max(...values)];
    };
    const [left, rightmost] = range(right);
    const [low, high] = range(up);
    const [near, far] = range(away);
    controls.target.set(0, 0, 0)
      .addScaledVector(right, (left + rightmost) / 2)
      .addScaledVector(up, (low + high) / 2)
      .addScaledVector(away, (near + far) / 2);
    camera.position.copy(controls.target).addScaledVector(away, 200);
    const aspect = canvas.clientWidth / canvas.clientHeight;
    const half = 0.54 * Math.max(high - low, (rightmost - left) / aspect);
    camera.zoom = 1;
    Object.assign(camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    camera.updateProjectionMatrix();
    controls.update();
    draw();
  }

  function cut() {
    const isOn = byId('cut').checked;
    const axis = new THREE.Vector3(...AXES[byId('cut-axis').value]);
    const values = shownCorners().map((corner) => corner.dot(axis));
    const [low, high] = values.length ? [Math.min(...values), Math.max(...values)] : [0, 0];
    const share = Number(byId('cut-place').value) / 100;
    const height = low + (high - low) * share;
    // What lies on the side of the default view is cut away.
    const towards = byId('cut-axis').value === 'x' ? -1 : 1;
    plane.normal.copy(axis).multiplyScalar(-towards);
    plane.constant = towards * height;
    byId('cut-value').textContent = isOn ? `${height.toFixed(1)} mm` : '';
    byId('cut-axis').disabled = !isOn;
    byId('cut-place').disabled = !isOn;
    for (const item of items) {
      const planes = isOn ? [plane] : null;
      item.material.clippingPlanes = planes;
      item.creases.material.clippingPlanes = planes;
      item.counters.visible = isOn;
      item.cap.visible = isOn && item.shown;
      item.cap.position.copy(axis).multiplyScalar(height);
      item.cap.lookAt(item.cap.position.clone().add(axis));
    }
    draw();
  }

  function paint() {
    const isClear = byId('clear').checked;
    for (const item of items) {
      const isDimmed = highlighted.length > 0 && !highlighted.includes(item.name);
      const isSeenThrough = isClear && ['skin', 'mold_palmar', 'mold_dorsal'].includes(item.name);
      item.group.visible = item.shown;
      item.material.transparent = isDimmed || isSeenThrough;
      item.material.opacity = isDimmed ? 0.12 : isSeenThrough ? 0.35 : 1;
      item.material.depthWrite = !(isDimmed || isSeenThrough);
      if (highlighted.includes(item.name)) item.material.color.setHex(HIGHLIGHT);
      else item.material.color.copy(item.colour);
      item.material.needsUpdate = true;
      item.creases.visible = !isDimmed;
    }
    cut();
  }

  const findBoxes = () => new Map(
    [...new Set(items.map((item) => item.label))].map((label, number) => [label, byId(`show-${number}`)]),
  );
  let boxes = findBoxes();
  function show(has) {
    for (const [label, box] of boxes) {
      for (const item of items.filter((one) => one.label === label)) item.shown = has(item);
      box.checked = items.some((item) => item.label === label && item.shown);
    }
  }

  const presets = [...document.querySelectorAll('[data-preset]')];
  function choose(name) {
    for (const button of presets) button.setAttribute('aria-pressed', String(button.dataset.preset === name));
  }
  for (const button of presets) {
    button.addEventListener('click', () => {
      const preset = PRESETS[button.dataset.preset];
      byId('apart').value = String(preset.apart);
      show(preset.has);
      choose(button.dataset.preset);
      place();
      paint();
      fit();
    });
  }
  byId('apart').addEventListener('input', () => {
    choose('');
    place();
    cut();
    fit();
  });
  byId('boxes').addEventListener('change', ({ target }) => {
    const [label] = [...boxes].find(([, box]) => box === target);
    for (const item of items.filter((one) => one.label === label)) item.shown = target.checked;
    choose('');
    paint();
  });
  byId('clear').addEventListener('change', paint);
  for (const id of ['cut', 'cut-axis', 'cut-place']) byId(id).addEventListener('input', cut);
  for (const button of document.querySelectorAll('[data-from]')) {
    button.addEventListener('click', () => fit(DIRECTIONS[button.dataset.from]));
  }

  function zoom(factor) {
    camera.zoom = Math.min(20, Math.max(0.2, camera.zoom * factor));
    camera.updateProjectionMatrix();
    draw();
  }
  function turn(azimuth, elevation) {
    const away = camera.position.clone().sub(controls.target);
    const angle = Math.atan2(away.x, away.z) + azimuth;
    const flat = Math.hypot(away.x, away.z);
    const tilt = Math.min(1.57, Math.max(-1.57, Math.atan2(away.y, flat) + elevation));
    const length = away.length();
    away.set(Math.sin(angle) * Math.cos(tilt), Math.sin(tilt), Math.cos(angle) * Math.cos(tilt));
    camera.position.copy(controls.target).addScaledVector(away, length);
    controls.update();
    draw();
  }
  const KEYS = {
    ArrowLeft: () => turn(-TURN, 0), ArrowRight: () => turn(TURN, 0),
    ArrowUp: () => turn(0, TURN), ArrowDown: () => turn(0, -TURN),
    '+': () => zoom(STEP), '-': () => zoom(1 / STEP), 0: () => fit(DIRECTIONS.slanted),
  };
  canvas.addEventListener('keydown', (event) => {
    const act = KEYS[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
  canvas.addEventListener('pointerdown', () => { controls.enableZoom = true; canvas.focus({ preventScroll: true }); });
  canvas.addEventListener('click', () => { canvas.style.touchAction = 'none'; });
  canvas.addEventListener('blur', () => {
    controls.enableZoom = false;
    canvas.style.touchAction = 'pan-y';
  });
  controls.addEventListener('change', draw);

  // Highlighting of what a parameter moves.
  const movers = [...document.querySelectorAll('[data-moves]')];
  for (const button of movers) {
    button.addEventListener('click', () => {
      const isOff = button.getAttribute('aria-pressed') === 'true';
      for (const other of movers) other.setAttribute('aria-pressed', 'false');
      button.setAttribute('aria-pressed', String(!isOff));
      highlighted = isOff ? [] : button.dataset.moves.split(' ');
      for (const item of items) if (highlighted.includes(item.name)) item.shown = true;
      show((item) => item.shown);
      paint();
      const said = [...new Set(items.filter((item) => highlighted.includes(item.name)).map((item) => item.label))];
      byId('view-status').textContent = isOff ? 'Nothing is highlighted.'
        : `${button.dataset.named ?? button.textContent.trim()} shapes: ${said.join(', ')}.`;
      const { bottom, height } = canvas.getBoundingClientRect();
      if (!height && !isOff) location.hash = '#model'; // the view stands in another tab
      else if (bottom < 80) canvas.scrollIntoView({ block: 'start' });
    });
  }

  function save(data, name) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(data);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  byId('save-picture').addEventListener('click', () => {
    canvas.toBlob((picture) => save(picture, `${document.documentElement.dataset.design}.png`));
  });
  // The mesh as it was exported, as binary STL.
  function encodeStl({ vertices, triangles, name }) {
    const count = triangles.length / 3;
    const view = new DataView(new ArrayBuffer(84 + 50 * count));
    [...`fingertip ${name}, unit mm`].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
    view.setUint32(80, count, true);
    for (let t = 0; t < count; t += 1) {
      for (let k = 0; k < 9; k += 1) {
        view.setFloat32(96 + 50 * t + 4 * k, vertices[3 * triangles[3 * t + Math.floor(k / 3)] + (k % 3)], true);
      }
    }
    return view;
  }
  for (const button of document.querySelectorAll('[data-stl]')) {
    button.addEventListener('click', () => {
      const item = items.find((one) => one.name === button.dataset.stl);
      save(new Blob([encodeStl(item)], { type: 'model/stl' }), `${item.name}.stl`);
    });
  }

  let width = 0;
  new ResizeObserver(() => {
    const { clientWidth, clientHeight } = canvas;
    if (!clientWidth || !clientHeight) return;
    renderer.setSize(clientWidth, clientHeight, false);
    const isFirst = width === 0;
    width = clientWidth;
    fit(isFirst ? DIRECTIONS.slanted : undefined);
  }).observe(canvas);
  const first = PRESETS[presets.find((button) => button.getAttribute('aria-pressed') === 'true').dataset.preset];
  byId('apart').value = String(first.apart);
  show(first.has);
  place();
  paint();

  // For the studio: other parts in place of these. What is hidden stays hidden, and the view stays as it is.
  globalThis.fingertipView = {
    replace(data, markup) {
      const hidden = new Set(items.filter((item) => !item.shown).map((item) => item.label));
      const known = new Set(items.map((item) => item.label));
      const preset = presets.find((button) => button.getAttribute('aria-pressed') === 'true');
      items.forEach(discard);
      items = data.map(make);
      byId('boxes').innerHTML = markup;
      boxes = findBoxes();
      const isShown = preset ? PRESETS[preset.dataset.preset].has : () => true;
      show((item) => (known.has(item.label) ? !hidden.has(item.label) : isShown(item)));
      place();
      paint();
    },
    drawn: () => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }),
  };
})();
