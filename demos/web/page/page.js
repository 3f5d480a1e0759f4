// The page: controls, numbers, mouse and keys. The simulation runs in worker.js.
import {Camera, scaled} from './camera.js';
import {hit_on_plane, hit_on_sheet, turned_towards} from './pick.js';
import {View} from './view.js';

const $ = (id) => document.getElementById(id);
const parts = [['fluid', '#2f7fb5'], ['contact', '#1a7f4b'], ['cloth', '#bd6a4b'], ['verify', '#9a8fc7']];
const off = ['contact.ccd=false', 'contact.zones=false'];

const canvas = $('view'), camera = new Camera();
let view, worker, scene = '', expected = [], settings = [], wanted = {}, drag = null, held = null, redraw = true, running = false;

function refuse(why) {
  $('notice').textContent = why;
  $('notice').hidden = false;
}

function number(x) { return x.toLocaleString('en').replaceAll(',', '\u2009'); }

// --- numbers
function show_verdict(report) {
  $('crossings').value = number(report.crossings);
  const certified = report.certified === report.steps;
  $('verdict').classList.toggle('bad', report.crossings > 0 || !certified);
  $('certificate').textContent = certified ? `Certificate: ${report.certified} of ${report.steps} steps` :
    `Certificate: ${report.certified} of ${report.steps} steps – the others had no promise`;
}

function show_times(milliseconds) {
  const total = parts.reduce((t, [name]) => t + milliseconds[name], 0) || 1;
  $('bar').replaceChildren(...parts.map(([name, colour]) => {
    const part = document.createElement('i');
    part.style.cssText = `width: ${100 * milliseconds[name] / total}%; background: ${colour}`;
    return part;
  }));
}

function show(frame) {
  const report = frame.report;
  show_verdict(report);
  $('particles').textContent = number(report.particles);
  $('steps').textContent = number(report.steps);
  $('time').value = report.time.toFixed(3);
  $('contacts').textContent = number(report.contacts);
  $('pairs').textContent = number(report.verified_pairs);
  $('milliseconds').value = frame.milliseconds ? frame.milliseconds.toFixed(1) : '–';
  show_times(report.milliseconds);
  running = frame.running;
  $('run').textContent = running ? 'Pause' : 'Run';
  if (!frame.untouched) {
    $('comparison').textContent = 'Not compared: the run was changed by hand. Restart to compare.';
    $('comparison').className = '';
  }
}

// --- the state hash
function expected_hashes() {
  const found = expected.find((e) => e.settings.join(' ') === settings.join(' '));
  return found ? found.hashes : {};
}

function compare({step, value}) {
  const desktop = expected_hashes()[step];
  $('hash').textContent = value;
  $('comparison').className = desktop === undefined ? '' : desktop === value ? 'same' : 'differs';
  $('comparison').textContent = desktop === undefined ? `Step ${step}: the desktop's is not known` :
    desktop === value ? `Step ${step}: equal to the desktop's` : `Step ${step}: differs from the desktop's, ${desktop}`;
}

// --- the worker
function open() {
  settings = [];
  if ($('spacing').value) settings.push('fluid.spacing=' + $('spacing').value);
  if (!$('contact').checked) settings.push(...off);
  $('hash').textContent = '–';
  $('comparison').className = '';
  $('comparison').textContent = "Compared with the desktop's as the steps go.";
  worker.postMessage({open: {scene, settings, every: wanted.every}});
}

function receive({data}) {
  if (data.refused) refuse(data.refused);
  if (data.ready) open();
  if (data.opened) {
    view.open(data.opened, data.triangles);
    $('description').textContent = data.opened.description;
    $('build').textContent = `Bullet in ${data.opened.precision}, ${data.opened.instruction_set}, one thread`;
    for (const id of ['run', 'step', 'restart']) $(id).disabled = false;
  }
  if (data.hash) compare(data.hash);
  if (data.frame) {
    [view.particles, view.nodes] = [data.frame.particles, data.frame.nodes];
    view.aim(data.frame.report.nozzle);
    show(data.frame);
    redraw = true;
  }
}

function tell_contact() {
  const on = $('contact').checked;
  $('contact_text').textContent = on ? 'Contact on: nothing passes' : 'Contact off: impulses alone, it leaks';
}

const commands = {
  run() { worker.postMessage({run: !running}); },
  step() { worker.postMessage({run: false, step: 1}); },
  restart() { open(); },
  left() { turn_nozzle(-1, 0); },
  right() { turn_nozzle(1, 0); },
  up() { turn_nozzle(0, 1); },
  down() { turn_nozzle(0, -1); },
  contact() {
    $('contact').checked = !$('contact').checked;
    switch_contact();
  },
};
const keys = {' ': 'run', s: 'step', r: 'restart', c: 'contact', arrowleft: 'left', arrowright: 'right', arrowup: 'up',
              arrowdown: 'down'};

/// Before the first step, the scene is opened anew, so that its hash can be compared.
function switch_contact() {
  tell_contact();
  if ($('steps').textContent === '0') open(); else worker.postMessage({contact: $('contact').checked});
}

/// By 3 degrees to a side of the picture.
function turn_nozzle(right, up) {
  if (!view.nozzle) return;
  const [r, u] = camera.axes(), side = scaled(right ? r : u, right || up);
  worker.postMessage({aim: turned_towards(view.nozzle.direction, side, 3 * Math.PI / 180)});
}

// --- mouse
function ray_at(event) {
  const box = canvas.getBoundingClientRect();
  const x = 2 * (event.clientX - box.left) / box.width - 1, y = 1 - 2 * (event.clientY - box.top) / box.height;
  return camera.ray(x, y, box.width / box.height);
}

/// The left button on the cloth takes hold of it; all else turns the view.
function press(event) {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  const hit = event.button === 0 ? hit_on_sheet(ray_at(event), view.nodes, view.triangles) : null;
  if (hit) {
    held = {point: hit, normal: camera.axes()[2]};
    worker.postMessage({grab: hit});
  } else {
    drag = [event.clientX, event.clientY];
  }
}

function pull(event) {
  const goal = hit_on_plane(ray_at(event), held.point, held.normal);
  if (goal) worker.postMessage({pull: goal});
}

function move(event) {
  if (held) return pull(event);
  if (!drag) return;
  camera.turn(event.clientX - drag[0], event.clientY - drag[1]);
  drag = [event.clientX, event.clientY];
  redraw = true;
}

function release() {
  if (held) worker.postMessage({release: true});
  drag = held = null;
}

function listen() {
  for (const id of ['run', 'step', 'restart']) $(id).onclick = () => commands[id]();
  $('contact').onchange = switch_contact;
  $('spacing').onchange = open;
  canvas.addEventListener('pointerdown', press);
  canvas.addEventListener('pointermove', move);
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(0.001 * event.deltaY));
    redraw = true;
  }, {passive: false});
  addEventListener('keydown', (event) => {
    const command = keys[event.key.toLowerCase()];
    const elsewhere = ['BUTTON', 'SELECT', 'INPUT'].includes(event.target.tagName) && event.key === ' ';
    const repeats = event.repeat && !event.key.startsWith('Arrow');
    if (!command || elsewhere || event.ctrlKey || event.metaKey || repeats || $('run').disabled) return;
    event.preventDefault();
    commands[command]();
  });
  addEventListener('resize', () => { redraw = true; });
}

function draw() {
  if (redraw) {
    redraw = false;
    view.draw(camera);
    worker.postMessage({drawn: true});
  }
  requestAnimationFrame(draw);
}

async function start() {
  $('legend').replaceChildren(...parts.map(([name, colour]) => {
    const item = document.createElement('span'), mark = document.createElement('i');
    mark.style.background = colour;
    item.append(mark, name);
    return item;
  }));
  view = new View(canvas);
  scene = await (await fetch('jet.json')).text();
  wanted = await (await fetch('hashes.json')).json();
  expected = wanted.runs;
  for (const {text, value} of wanted.spacings) $('spacing').add(new Option(text, value));
  listen();
  worker = new Worker('worker.js');
  worker.onmessage = receive;
  worker.onerror = (event) => refuse('the simulation cannot start: ' + event.message);
  draw();
}

start().catch((error) => refuse(error.message));
