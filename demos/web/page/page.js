// The page: controls, numbers, mouse and keys. The simulation runs in worker.js.
import {Camera} from './camera.js';
import {View} from './view.js';

const $ = (id) => document.getElementById(id);
const parts = [['fluid', '#2f7fb5'], ['contact', '#1a7f4b'], ['cloth', '#bd6a4b'], ['verify', '#9a8fc7']];
const off = ['contact.ccd=false', 'contact.zones=false'];

const canvas = $('view'), camera = new Camera();
let view, worker, scene = '', expected = [], settings = [], wanted = {}, drag = null, redraw = true, running = false;

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
  contact() {
    $('contact').checked = !$('contact').checked;
    switch_contact();
  },
};
const keys = {' ': 'run', s: 'step', r: 'restart', c: 'contact'};

/// Before the first step, the scene is opened anew, so that its hash can be compared.
function switch_contact() {
  tell_contact();
  if ($('steps').textContent === '0') open(); else worker.postMessage({contact: $('contact').checked});
}

// --- mouse
function press(event) {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  drag = [event.clientX, event.clientY];
}

function move(event) {
  if (!drag) return;
  camera.turn(event.clientX - drag[0], event.clientY - drag[1]);
  drag = [event.clientX, event.clientY];
  redraw = true;
}

function release() { drag = null; }

function listen() {
  for (const id of ['run', 'step', 'restart']) $(id).onclick = () => commands[id]();
  $('contact').onchange = switch_contact;
  $('spacing').onchange = open;
  canvas.addEventListener('pointerdown', press);
  canvas.addEventListener('pointermove', move);
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(0.001 * event.deltaY));
    redraw = true;
  }, {passive: false});
  addEventListener('keydown', (event) => {
    const command = keys[event.key.toLowerCase()];
    const elsewhere = ['BUTTON', 'SELECT', 'INPUT'].includes(event.target.tagName) && event.key === ' ';
    if (!command || elsewhere || event.ctrlKey || event.metaKey || event.repeat || $('run').disabled) return;
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
