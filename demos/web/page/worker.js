// The simulation, in a thread of its own: the page draws while a step is computed.
//
// Messages to it: {open: {scene, settings, every}}, {run: true | false}, {step: count}, {contact: true | false},
// {grab: point}, {pull: point}, {release: true}, {aim: direction}, {drawn: true}.
// Messages from it: {ready: true}, {opened: description}, {frame: …}, {hash: {step, value}}, {refused: why}.
'use strict';
importScripts('oilskin_page.js');

let module;
let running = false;
let opened = false;
let every = 0;        // steps between two hashes that are compared; 0 = none
let untouched = true; // since the scene was opened
let drawn = true;     // the page has drawn the last frame
let milliseconds = 0; // of a step, a running mean
let scheduled = false;

const wake = new MessageChannel();
wake.port1.onmessage = () => { scheduled = false; work(); };

function schedule() {
  if (scheduled) return;
  scheduled = true;
  wake.port2.postMessage(0);
}

function text(call) { return module.UTF8ToString(module[call]()); }

function refuse() {
  running = false;
  postMessage({refused: text('_page_message')});
}

/// A copy of the list that a function returns, `per` numbers to an element.
function list(call, per, heap) {
  const count = module._malloc(4);
  const data = module[call](count) >> 2;
  const length = per * module.HEAPU32[count >> 2];
  module._free(count);
  return module[heap].slice(data, data + length);
}

function send_frame() {
  const report = JSON.parse(text('_page_report'));
  const particles = list('_page_particles', 4, 'HEAPF32');
  const nodes = list('_page_nodes', 3, 'HEAPF32');
  drawn = false;
  postMessage({frame: {report, milliseconds, running, untouched, particles, nodes}}, [particles.buffer, nodes.buffer]);
}

function step() {
  const start = performance.now();
  if (!module._page_step(1)) return refuse(), false;
  const took = performance.now() - start;
  milliseconds = milliseconds === 0 ? took : 0.9 * milliseconds + 0.1 * took;
  const steps = module._page_steps();
  if (every > 0 && untouched && steps % every === 0) postMessage({hash: {step: steps, value: text('_page_state_hash')}});
  return true;
}

function work() {
  if (!running || !step()) return;
  if (drawn) send_frame();
  schedule();
}

function open(wanted) {
  const [scene, settings] = [wanted.scene, wanted.settings.join('\n')].map((s) => module.allocateUTF8(s));
  const done = module._page_open(scene, settings);
  module._free(scene);
  module._free(settings);
  if (!done) return refuse();
  every = wanted.every;
  untouched = opened = true;
  milliseconds = 0;
  postMessage({opened: JSON.parse(text('_page_description')), triangles: list('_page_triangles', 3, 'HEAPU32')});
  send_frame();
}

/// A call that changes the course of the run: from then on its hash is not that of the desktop.
function touch(done) {
  if (!done) return refuse();
  untouched = false;
}

function receive({data}) {
  if (data.open) open(data.open);
  if (data.drawn) drawn = true;
  if (!opened) return;
  if ('run' in data) {
    running = data.run;
    if (running) schedule(); else send_frame();
  }
  if (data.step) {
    for (let i = 0; i < data.step && step(); ++i);
    send_frame();
  }
  if (data.grab) touch(module._page_grab(...data.grab));
  if (data.pull) touch(module._page_pull(...data.pull));
  if (data.release) module._page_release();
  if (data.aim) {
    touch(module._page_aim(...data.aim));
    if (!running) send_frame();
  }
  if ('contact' in data) touch(module._page_set_contact(data.contact ? 1 : 0));
}

createOilskin().then((made) => {
  module = made;
  onmessage = receive;
  postMessage({ready: true});
}, (error) => postMessage({refused: 'the module cannot be loaded: ' + error}));
