// The controls, and what they say. What is chosen is kept when the state of the run changes: a site keeps its number.

const element = (id) => document.getElementById(id);
const canvas = element('canvas');

/** Dark to light, evenly in lightness, also for those who do not see all colours. */
const SCALE = [[74, 60, 140], [62, 100, 168], [52, 138, 172], [62, 172, 158], [122, 200, 132], [192, 220, 112], [250, 232, 128]];
const STATUS = [
  { name: 'complete', color: [86, 150, 190] }, { name: 'empty', color: [150, 150, 150] }, { name: 'not certified', color: [214, 96, 40] },
];
const PICKED = [240, 90, 20], LIT = [255, 206, 110], DIM = [150, 156, 164];

let view = null, cells = null, picked = -1, state = meta.states.length - 1;
/** Neighbours of the cell that is picked, with the areas of the facets. */
let facets = new Map();
let isFlipped = false, isThrough = false, isAlone = false, isDue = false;

const number = (x, digits = 6) => Number(x.toPrecision(digits)).toLocaleString('en', { maximumSignificantDigits: digits, useGrouping: Math.abs(x) < 1e9 })
  .replace(/^-?0$/, '0');
const shownNumber = (x, digits = 6) => (x !== 0 && (Math.abs(x) < 1e-4 || Math.abs(x) >= 1e9) ? x.toExponential(digits - 1).replace(/\.?0+e/, 'e') : number(x, digits));
const mixed = (a, b, share) => [0, 1, 2].map((k) => a[k] + share * (b[k] - a[k]));

function scaled(share) {
  const at = Math.min(1, Math.max(0, share)) * (SCALE.length - 1), below = Math.min(SCALE.length - 2, Math.floor(at));
  return mixed(SCALE[below], SCALE[below + 1], at - below);
}

function make(name, text, to) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (to) to.append(made);
  return made;
}

function fillList(list, rows) {
  list.replaceChildren();
  for (const [name, value] of rows) {
    make('dt', name, list);
    make('dd', value, list);
  }
}

/** Numbers that differ by roundings are one. */
const isConstant = ({ most: [lo, hi] }) => hi - lo <= 1e-5 * Math.max(Math.abs(lo), Math.abs(hi));

function painter() {
  const name = element('field').value;
  if (name === 'status') return (c) => STATUS[cells.status[c]].color;
  const index = meta.fields.findIndex((field) => field.name === name), field = meta.fields[index];
  if (isConstant(field)) return () => scaled(0.4);
  const values = cells.fields[index], [lo, hi] = ends(field);
  if (isLog(field)) return (c) => scaled(Math.log(values[c] * field.scale / lo) / Math.log(hi / lo));
  return (c) => scaled((values[c] * field.scale - lo) / (hi - lo));
}

/** Numbers of so different sizes that most would have one colour are coloured by their logarithms. */
const isLog = (field) => ends(field)[0] > 0 && ends(field)[1] > 100 * ends(field)[0];

/** What the colours range over: all but a hundredth at each end, unless that is one number. */
const ends = ({ range, most }) => (range[1] > range[0] ? range : most);

function recolor() {
  const paint = painter();
  if (picked < 0) {
    view.setTints(paint);
    return;
  }
  view.setTints((c) => {
    if (c === picked) return PICKED;
    return facets.has(c) ? mixed(paint(c), LIT, 0.72) : mixed(paint(c), DIM, 0.6);
  });
}

function showLegend() {
  const legend = element('legend'), name = element('field').value;
  legend.replaceChildren();
  if (name === 'status') {
    for (const { name, color } of STATUS) {
      if (name === 'empty') continue;
      const row = make('div', undefined, legend);
      row.className = 'swatch';
      make('i', undefined, row).style.background = `rgb(${color})`;
      row.append(name);
    }
    return;
  }
  const field = meta.fields.find((field) => field.name === name), [lo, hi] = ends(field), unit = field.unit ? ` (${field.unit})` : '';
  if (isConstant(field)) {
    make('p', `${name}${unit}: ${shownNumber(field.most[0])} for all cells`, legend).className = 'note';
    return;
  }
  const bar = make('div', undefined, legend);
  bar.className = 'bar';
  bar.style.background = `linear-gradient(to right, ${SCALE.map((color) => `rgb(${color})`)})`;
  const labels = make('div', undefined, legend);
  labels.className = 'ends';
  for (const x of [lo, isLog(field) ? Math.sqrt(lo * hi) : (lo + hi) / 2, hi]) make('span', shownNumber(x, 3), labels);
  const beyond = field.most[0] < lo || field.most[1] > hi ? ` All: ${shownNumber(field.most[0], 3)} to ${shownNumber(field.most[1], 3)}; the colours leave out 1 % at each end.` : '';
  make('p', `${name}${unit}${isLog(field) ? ', by its logarithm' : ''}.${beyond}`, legend).className = 'note';
}

/** Which cells are shown. */
function shownCells() {
  const shown = new Uint8Array(cells.count);
  if (isAlone && picked >= 0) {
    shown[picked] = 1;
    for (const c of facets.keys()) if (c >= 0) shown[c] = 1;
    return shown;
  }
  const axis = element('axis').selectedIndex, share = element('cut').value / 1000, extent = view.extent[axis];
  for (let c = 0; c < cells.count; c++) {
    const at = cells.barycenter[3 * c + axis];
    shown[c] = share === 1 || (isFlipped ? at >= (1 - share) * extent : at <= share * extent) ? 1 : 0;
  }
  return shown;
}

/** The same where a plane cuts cells through: also which it cuts, where it is, and it as the view takes it. */
function cutThrough() {
  const axis = element('axis').selectedIndex, share = element('cut').value / 1000, sign = isFlipped ? -1 : 1;
  const at = (isFlipped ? 1 - share : share) * view.extent[axis], { lo, hi } = spans(cells, axis);
  const shown = new Uint8Array(cells.count), isCut = new Uint8Array(cells.count);
  for (let c = 0; c < cells.count; c++) {
    shown[c] = (isFlipped ? hi[c] > at : lo[c] < at) ? 1 : 0;
    isCut[c] = lo[c] < at && at < hi[c] ? 1 : 0;
  }
  return { shown, isCut, axis, sign, at, plane: [0, 1, 2].map((k) => (k === axis ? sign : 0)).concat(sign * at) };
}

/** Draws which cells are shown; once a frame, however fast a slider is. */
function reshape() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    reshapeNow();
  });
}

function reshapeNow() {
  const axis = element('axis').selectedIndex, share = element('cut').value / 1000;
  const at = meta.lo[axis] + (isFlipped ? 1 - share : share) * (meta.hi[axis] - meta.lo[axis]);
  element('cut-label').value = share === 1 ? 'none' : `${'xyz'[axis]} ${isFlipped ? '≥' : '≤'} ${shownNumber(at, 4)}`;
  const spread = element('spread').value / 100;
  element('spread-label').value = spread ? `${element('spread').value} %` : 'none';
  // What stands apart, or alone, is whole.
  if (isThrough && share < 1 && spread === 0 && !(isAlone && picked >= 0)) {
    view.setThrough(cutThrough());
  } else {
    view.setShown(shownCells(), spread);
  }
}

/** The facets of a cell: of each neighbour (-1 the outside) the area. */
function facetsOf(c) {
  const { first, list } = facesOfCells(cells), found = new Map();
  for (let k = first[c]; k < first[c + 1]; k++) {
    const f = list[k], beyond = cells.inner[f] === c ? cells.outer[f] : cells.inner[f];
    found.set(beyond, (found.get(beyond) || 0) + areaOf(cells, f) * meta.size ** 2);
  }
  return found;
}

/** Picks a cell, by its place among the cells; -1 lets go. */
function pick(c) {
  picked = c;
  facets = c < 0 ? new Map() : facetsOf(c);
  if (c < 0) isAlone = false;
  showPicked();
  recolor();
  reshape();
}

function showPicked() {
  const box = element('picked');
  box.hidden = picked < 0;
  box.replaceChildren();
  if (picked < 0) return;
  const point = (array) => [0, 1, 2].map((k) => shownNumber(meta.lo[k] + array[3 * picked + k] * meta.size)).join(', ');
  make('h2', `Cell of site ${cells.site[picked]}`, box);
  const rows = meta.fields.map((field, k) => [field.name, `${shownNumber(cells.fields[k][picked] * field.scale)}${field.unit ? ` ${field.unit}` : ''}`]);
  const list = make('dl', undefined, box);
  const outside = facets.get(-1), others = [...facets].filter(([c]) => c >= 0).sort((a, b) => b[1] - a[1]);
  rows.push(['site at', point(cells.position)], ['barycenter', point(cells.barycenter)], ['status', STATUS[cells.status[picked]].name]);
  if (outside) rows.push(['on the border', `area ${shownNumber(outside, 4)}`]);
  rows.push(['neighbours', others.length]);
  fillList(list, rows);
  const label = make('label', undefined, box), alone = make('input', undefined, label);
  alone.type = 'checkbox';
  alone.id = 'alone';
  alone.checked = isAlone;
  alone.addEventListener('change', () => {
    isAlone = alone.checked;
    reshape();
  });
  label.append('Only it and its neighbours');
  const neighbours = make('ul', undefined, box);
  neighbours.id = 'neighbours';
  neighbours.setAttribute('aria-label', 'Neighbours, with the area of the facet');
  for (const [c, area] of others) {
    const button = make('button', undefined, make('li', undefined, neighbours));
    button.type = 'button';
    make('span', `site ${cells.site[c]}`, button);
    make('span', `area ${shownNumber(area, 4)}`, button);
    button.addEventListener('click', () => pick(c));
  }
}

/** Picks the cell of a site; false where it has none. */
function pickSite(site) {
  const c = cells.site.indexOf(site);
  pick(c);
  if (c >= 0) return true;
  const box = element('picked');
  box.hidden = false;
  make('p', `Site ${site} has no cell here: it is empty, or there is no such site.`, box).className = 'note';
  return false;
}

/** Shows a state of the run; of several asked for in a hurry the last. */
async function showState(index) {
  state = index;
  element('state').value = index;
  const read = await readBlock(index);
  if (state !== index) return;
  const site = picked < 0 ? -1 : cells.site[picked];
  cells = read;
  view.setCells(cells);
  picked = site < 0 ? -1 : cells.site.indexOf(site);
  facets = picked < 0 ? new Map() : facetsOf(picked);
  showPicked();
  recolor();
  reshapeNow();
  element('state-label').value = `${cells.label} (${index + 1} of ${meta.states.length})`;
  if (plot) plot.mark(cells.row);
}

let plot = null, isPlaying = false;

async function play() {
  isPlaying = !isPlaying;
  element('play').textContent = isPlaying ? '❚❚' : '▶';
  element('play').setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
  let next = state + 1 < meta.states.length ? state : -1;
  while (isPlaying && next + 1 < meta.states.length) {
    await Promise.all([showState(++next), new Promise((done) => setTimeout(done, 140))]);
  }
  if (isPlaying) play();
}

function listen() {
  element('field').addEventListener('change', () => {
    showLegend();
    recolor();
  });
  for (const id of ['axis', 'cut']) element(id).addEventListener('input', reshape);
  element('flip').addEventListener('click', () => {
    isFlipped = !isFlipped;
    element('flip').setAttribute('aria-pressed', isFlipped);
    reshape();
  });
  element('through').addEventListener('click', () => {
    isThrough = !isThrough;
    element('through').setAttribute('aria-pressed', isThrough);
    element('cut-note').textContent = isThrough ? 'Cells are cut through, where they do not stand apart.' : 'Cells whose barycenter is beyond the plane are left out, whole.';
    reshape();
  });
  element('spread').addEventListener('input', () => {
    const spread = element('spread').value / 100;
    // New triangles only where cells begin to stand apart, or no longer do.
    if (spread > 0 && view.uniforms.spread.value > 0) {
      element('spread-label').value = `${element('spread').value} %`;
      view.setSpread(spread);
    } else {
      reshape();
    }
  });
  element('number').addEventListener('change', (event) => {
    if (event.target.value !== '') pickSite(Number(event.target.value));
  });
  element('home').addEventListener('click', () => view.home());
  element('state').addEventListener('input', (event) => {
    if (isPlaying) play();
    showState(Number(event.target.value));
  });
  element('play').addEventListener('click', play);
  let down = null;
  canvas.addEventListener('pointerdown', (event) => { down = event.isPrimary && event.button === 0 ? event : null; });
  canvas.addEventListener('pointerup', (event) => {
    const near = down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5;
    down = null;
    if (near) pick(view.pick(event.offsetX, event.offsetY));
  });
  canvas.addEventListener('keydown', (event) => {
    const keys = {
      ArrowLeft: () => view.turn(-0.12, 0), ArrowRight: () => view.turn(0.12, 0), ArrowUp: () => view.turn(0, 0.12), ArrowDown: () => view.turn(0, -0.12),
      '+': () => view.zoom(0.87), '=': () => view.zoom(0.87), '-': () => view.zoom(1.15), Home: () => view.home(), Escape: () => pick(-1),
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}

function listenToPanel() {
  const open = element('open');
  const set = (isOpen) => {
    document.body.classList.toggle('closed', !isOpen);
    open.setAttribute('aria-expanded', isOpen);
    open.textContent = isOpen ? 'Close' : 'Controls';
  };
  set(!matchMedia('(max-width: 720px)').matches);
  open.addEventListener('click', () => set(document.body.classList.contains('closed')));
}

function fill() {
  fillList(element('facts'), meta.facts);
  for (const { name } of [...meta.fields, { name: 'status' }]) {
    const option = make('option', name, element('field'));
    option.value = name;
  }
  element('field').value = meta.first;
  showLegend();
  const isRun = meta.states.length > 1 || meta.plot;
  element('time').hidden = !isRun;
  element('state').max = meta.states.length - 1;
  element('shown').textContent = meta.plot ? `The curve: ${meta.plot.y} by ${meta.plot.x}. The slider: ${meta.shown}.` : meta.shown;
  if (meta.plot) {
    element('plot').hidden = false;
    element('plot').setAttribute('aria-label', `${meta.plot.y} by ${meta.plot.x}`);
    plot = new Plot(element('plot'), meta.plot);
  }
}

/** Why there is no picture, in the place of it. */
function sayInstead(text) {
  element('message').textContent = text;
  element('message').hidden = false;
}

/** For scripts and tests: what a user does, and what he sees. */
const laguerre = window.laguerre = {
  meta, firstPicture: null, pickSite, cutThrough, pickAt: (x, y) => view.pick(x, y), view: () => view,
  seen: () => ({ picked: picked < 0 ? null : cells.site[picked], neighbours: facets.size, cells: cells.count, vertices: view.vertices, state }),
  /** Milliseconds a frame while the view turns once. */
  spin(frames) {
    const start = performance.now();
    for (let k = 0; k < frames; k++) {
      view.turn(2 * Math.PI / frames, 0);
      view.drawNow();
      view.finish();
    }
    return (performance.now() - start) / frames;
  },
};

async function begin() {
  listenToPanel();
  fill();
  const context = canvas.getContext('webgl2', { antialias: true, alpha: true, powerPreference: 'high-performance' });
  if (!context) {
    sayInstead('This browser or device offers no WebGL 2, by which the cells are drawn. The figures of the run are among the controls; another browser, or one with its graphics acceleration switched on, shows the cells.');
    return;
  }
  if (!window.DecompressionStream) {
    sayInstead('This browser is too old to read the cells (it has no DecompressionStream). A newer one shows them.');
    return;
  }
  canvas.addEventListener('webglcontextlost', () => sayInstead('The graphics card has dropped the picture. Load the page again to see it.'));
  view = new View(canvas, context);
  view.onShare = (share) => {
    element('share').hidden = share === 1;
    element('share').textContent = `Drawn is the outermost ${Math.ceil(100 * share)} %, which this device takes a second for. A cut shows the others.`;
  };
  await showState(state);
  view.onDrawn = () => {
    view.onDrawn = null;
    view.finish();
    element('message').hidden = true;
    laguerre.firstPicture = performance.now();
  };
  view.draw();
  listen();
}

begin().catch((error) => {
  sayInstead(`The cells could not be shown: ${error.message}`);
  throw error;
});
