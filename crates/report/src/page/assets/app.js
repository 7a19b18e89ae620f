'use strict';
// Puts the page together: the animation, its controls and the panels.

const byId = (id) => document.getElementById(id);
/** Seconds that a whole run takes at speed 1. */
const DURATION = 8;

class App {
  constructor(runs) {
    this.runs = runs;
    this.isPlaying = false;
    this.picked = null;
    this.place = null;
    this.panels = new Panels(runs, (target) => this.go(target), (run) => this.setRun(run));
    byId('runs').style.display = runs.length > 1 ? '' : 'none';
    byId('run').append(...runs.map((run, k) => element('option', { value: k, textContent: run.name })));
    byId('run').onchange = () => this.setRun(Number(byId('run').value));
    if (runs.some((run) => run.animation?.times.length)) this.makeViewer();
    this.setRun(Math.max(0, runs.findIndex((run) => run.animation?.times.length)));
    const observer = new ResizeObserver(() => this.resized());
    for (const id of ['picture', 'panels']) observer.observe(byId(id));
  }

  /** The animation; without WebGL2 a message, and the rest of the page is as it is. */
  makeViewer() {
    try {
      this.viewer = new Viewer(byId('scene'));
    } catch (error) {
      document.querySelector('main').before(message(error.message));
      return;
    }
    this.listen();
  }

  /** Whether there is something to see of the present run. */
  isAnimated() {
    return Boolean(this.viewer && this.run.animation?.times.length);
  }

  setRun(number) {
    const run = this.runs[number];
    this.run = run;
    byId('run').value = number;
    byId('title').textContent = run.summary?.title ?? run.name;
    const s = run.summary;
    // How the run ended comes first: a verdict on a part of it is none on its result.
    const { kind, words } = ending(s);
    Object.assign(byId('outcome'), { textContent: words, className: `badge ${kind}` });
    Object.assign(byId('verdict'), { ...judgement(s, unitOf(run, 'time')), onclick: () => this.panels.open('Verdict') });
    byId('failure').textContent = s?.outcome?.reason ?? '';
    byId('facts').textContent = s ? `${run.name} · ${s.steps} steps to t = ${text(s.time)}${after(unitOf(run, 'time'))} · ${text(s.wall_seconds)} s` : run.name;
    this.panels.setRun(run);
    this.place = null;
    this.pick(null);
    this.play(false);
    document.querySelector('main').classList.toggle('plain', !this.isAnimated());
    if (this.isAnimated()) {
      this.viewer.setRun(run.animation);
      this.makeChoices(run.animation);
      this.setTime(this.viewer.time);
    }
    this.redraw();
  }

  /** The lists of fields and bodies. */
  makeChoices(animation) {
    const before = byId('field').selectedOptions[0]?.textContent ?? 'von Mises stress';
    const options = animation.fields.map(({ label }, k) => element('option', { value: k, textContent: label }));
    byId('field').replaceChildren(element('option', { value: -1, textContent: 'bodies' }), ...options);
    const wanted = [before, 'velocity', 'displacement'].map((name) => animation.fields.findIndex(({ label }) => label === name));
    this.setField(before === 'bodies' ? -1 : wanted.find((k) => k >= 0) ?? -1);
    byId('bodies').replaceChildren(...animation.bodies.map((body, k) => {
      const box = element('input', { type: 'checkbox', checked: true });
      box.onchange = () => {
        if (box.checked) this.viewer.show.hidden.delete(k);
        else this.viewer.show.hidden.add(k);
        this.redraw();
      };
      const swatch = element('span', { className: 'swatch' });
      swatch.style.background = `rgb(${scaled(BODIES[k % BODIES.length], 255).join(' ')})`;
      return element('label', {}, [box, swatch, body.name]);
    }));
  }

  setField(number) {
    byId('field').value = number;
    this.viewer.setField(number);
    const field = this.run.animation.fields[number];
    if (field) [byId('low').value, byId('high').value] = field.range.map((value) => Number(value.toPrecision(3)));
    this.fixRange();
    this.pick(this.picked);
  }

  fixRange() {
    const { show } = this.viewer;
    show.range = byId('range').value;
    show.fixed = [Number(byId('low').value), Number(byId('high').value)];
    byId('ends').classList.toggle('on', show.range === 'fixed');
    this.redraw();
  }

  fixClip() {
    const axis = byId('clip').value;
    byId('plane').classList.toggle('on', axis !== '');
    const flipped = byId('flip').classList.contains('on');
    this.viewer.show.clip = axis === '' ? null : { axis: Number(axis), part: Number(byId('offset').value), flipped };
    this.redraw();
  }

  listen() {
    const { show } = this.viewer;
    byId('play').onclick = () => this.play(!this.isPlaying);
    byId('back').onclick = () => this.step(-1);
    byId('forth').onclick = () => this.step(1);
    byId('scrub').oninput = () => this.setTime(Number(byId('scrub').value));
    byId('field').onchange = () => this.setField(Number(byId('field').value));
    for (const id of ['range', 'low', 'high']) byId(id).oninput = () => this.fixRange();
    for (const id of ['mesh', 'outline']) byId(id).onchange = () => {
      show[id] = byId(id).checked;
      this.redraw();
    };
    byId('clip').onchange = byId('offset').oninput = () => this.fixClip();
    byId('flip').onclick = () => {
      byId('flip').classList.toggle('on');
      this.fixClip();
    };
    for (const button of byId('views').querySelectorAll('button')) button.onclick = () => {
      const { camera } = this.viewer;
      [camera.azimuth, camera.elevation] = button.dataset.view.split(',').map(Number);
      this.viewer.home();
      this.redraw();
    };
    document.onkeydown = (event) => {
      if (['INPUT', 'SELECT', 'BUTTON'].includes(event.target.tagName) || !this.isAnimated()) return;
      const act = { ' ': () => this.play(!this.isPlaying), ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1) }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    };
    this.listenToPointer(byId('scene'));
  }

  listenToPointer(canvas) {
    const { camera } = this.viewer;
    let last = null;
    let way = 0;
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      last = [event.clientX, event.clientY];
      way = 0;
    };
    canvas.onpointermove = (event) => {
      if (!last) return;
      const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
      last = [event.clientX, event.clientY];
      way += Math.abs(dx) + Math.abs(dy);
      if (event.shiftKey || event.buttons & 6) camera.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      else camera.turn(-0.4 * dx, 0.4 * dy);
      this.redraw();
    };
    canvas.onpointerup = (event) => {
      last = null;
      const box = canvas.getBoundingClientRect();
      if (way < 4) this.pick(this.viewer.pick(event.clientX - box.left, event.clientY - box.top));
    };
    canvas.oncontextmenu = (event) => event.preventDefault();
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(0.0012 * event.deltaY));
      this.redraw();
    }, { passive: false });
  }

  /** First and last time of the frames. */
  ends() {
    const { times } = this.run.animation;
    return [times[0], times[times.length - 1]];
  }

  play(isPlaying) {
    this.isPlaying = isPlaying;
    byId('play').textContent = isPlaying ? '\u275a\u275a' : '\u25b6';
    if (!isPlaying) return;
    const [first, last] = this.ends();
    if (this.viewer.time >= last) this.setTime(first);
    let before = performance.now();
    const next = (now) => {
      if (!this.isPlaying) return;
      const time = this.viewer.time + (((now - before) / 1000) * Number(byId('speed').value) * (last - first)) / DURATION;
      before = now;
      this.setTime(time > last ? first : Math.max(time, first));
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  /** Goes to a frame before or after the present time. */
  step(by) {
    this.play(false);
    const { times } = this.run.animation;
    const { frame, part } = this.viewer.moment();
    const target = by < 0 && part > 0 ? frame : frame + by;
    this.setTime(times[Math.min(Math.max(target, 0), times.length - 1)]);
  }

  setTime(time) {
    if (this.isAnimated()) {
      const [first, last] = this.ends();
      this.viewer.time = Math.min(Math.max(time, first), last);
      Object.assign(byId('scrub'), { min: first, max: last, value: this.viewer.time });
      const { frame } = this.viewer.moment();
      byId('now').textContent = `t = ${text(this.viewer.time)}${after(unitOf(this.run, 'time'))}  (${frame + 1}/${this.run.animation.times.length})`;
    }
    this.panels.setTime(time);
    this.redraw();
  }

  /** Shows a time and perhaps a place. */
  go({ time, place }) {
    this.play(false);
    this.place = place ?? null;
    if (place && this.isAnimated()) {
      this.viewer.camera.target = place.slice();
      this.viewer.camera.distance = 2.5 * this.viewer.camera.radius;
    }
    this.setTime(time);
  }

  /** Marks a node, or none. */
  pick(node) {
    this.picked = node;
    if (node) {
      const { animation } = this.run;
      const field = animation.fields[Math.max(this.viewer.show.field, 0)];
      const values = valuesOf(field);
      const y = animation.times.map((_, frame) => values[frame * animation.nodes + node.node]).map((v) => (Number.isNaN(v) ? null : v));
      const series = [{ name: withUnit(field.label, field.unit), x: animation.times, y, colour: COLOURS[0] }];
      this.panels.node({ title: this.nameOf(node), series, unit: unitOf(this.run, 'time') });
    }
    this.redraw();
  }

  nameOf({ body, node }) {
    const { animation } = this.run;
    const found = animation.bodies[body];
    return `Node ${animation.numbers[node] - found.first} of ${found.name}`;
  }

  redraw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.draw();
    });
  }

  draw() {
    if (!this.isAnimated()) return;
    this.viewer.draw();
    this.drawBar();
    this.drawPicked();
    this.drawOverlay();
  }

  drawBar() {
    const field = this.run.animation.fields[this.viewer.show.field];
    byId('bar').classList.toggle('off', !field);
    if (!field) return;
    const [low, high] = this.viewer.range();
    const key = [field.label, field.unit, low, high].join();
    if (key === this.barKey) return;
    this.barKey = key;
    byId('bar-name').textContent = withUnit(field.label, field.unit);
    const canvas = byId('bar-colours');
    Object.assign(canvas, { width: 1, height: 256 });
    const pen = canvas.getContext('2d');
    for (let k = 0; k < 256; k++) {
      pen.fillStyle = `rgb(${mapColour(1 - k / 255).join(' ')})`;
      pen.fillRect(0, k, 1, 1);
    }
    const at = (k) => high - (k / 4) * (high - low);
    const number = (value) => (Math.abs(value) < 1e-9 * (high - low) ? '0' : text(Number(value.toPrecision(3))));
    // Of a state only whole numbers have a meaning.
    const states = Math.floor(high) - Math.ceil(low) + 1;
    const parts = field.largest === null && states > 1 ? [...Array(states).keys()].map((k) => (4 * k) / (states - 1)) : [0, 1, 2, 3, 4];
    const numbers = parts.map((k) => element('span', { textContent: number(at(k)) }));
    byId('bar-numbers').replaceChildren(...numbers);
  }

  drawPicked() {
    if (!this.picked) return byId('picked').replaceChildren();
    const { node } = this.picked;
    const place = this.viewer.place(node);
    const move = subtract(place, placeOf(this.run.animation, 0, node));
    const length = unitOf(this.run, 'length');
    const rows = [[withUnit('position', length), place.map(text).join('  ')], [withUnit('displacement', length), move.map(text).join('  ')]];
    for (const field of this.run.animation.fields.slice(1)) rows.push([withUnit(field.label, field.unit), text(this.viewer.value(field, node))]);
    byId('picked').replaceChildren(element('b', { textContent: this.nameOf(this.picked) }), table(rows));
  }

  /** Axes, the picked node and the place of a finding. */
  drawOverlay() {
    const canvas = byId('overlay');
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const pen = canvas.getContext('2d');
    pen.scale(ratio, ratio);
    const { right, up } = this.viewer.camera.axes();
    pen.font = '11px system-ui, sans-serif';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    ['x', 'y', 'z'].forEach((name, k) => {
      const [x, y] = [44 + 26 * right[k], height - 44 - 26 * up[k]];
      pen.strokeStyle = pen.fillStyle = ['#c8553d', '#4f9a5b', '#2f6db3'][k];
      pen.lineWidth = 1.6;
      line(pen, [[44, height - 44], [x, y]]);
      pen.fillText(name, 44 + 36 * right[k], height - 44 - 36 * up[k]);
    });
    const ring = (place, colour, radius) => {
      const seen = this.viewer.project(place);
      if (!seen) return;
      pen.strokeStyle = colour;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.arc(seen[0], seen[1], radius, 0, 2 * Math.PI);
      pen.stroke();
    };
    if (this.picked) ring(this.viewer.place(this.picked.node), '#2f6db3', 6);
    if (this.place) ring(this.place, '#c0392b', 12);
  }

  resized() {
    if (this.isAnimated() && this.viewer.isHome()) this.viewer.home();
    this.panels.redraw();
    this.redraw();
  }
}

/** What the address asks for behind its `#`, such as `t=0.5&field=velocity&tab=Contact&view=0,90`. */
function obey(app, wishes) {
  const time = Number(wishes.get('t'));
  const field = app.run.animation?.fields.findIndex(({ label }) => label === wishes.get('field')) ?? -1;
  if (app.isAnimated() && wishes.has('view')) {
    [app.viewer.camera.azimuth, app.viewer.camera.elevation] = wishes.get('view').split(',').map(Number);
    app.viewer.home();
  }
  if (app.isAnimated() && field >= 0) app.setField(field);
  if (app.panels.tabs.has(wishes.get('tab'))) app.panels.open(wishes.get('tab'));
  if (wishes.has('t') && Number.isFinite(time)) app.setTime(time);
}

async function start() {
  const texts = [...document.querySelectorAll('script.run')].map((script) => script.textContent);
  const app = new App(await Promise.all(texts.map(unpack)));
  obey(app, new URLSearchParams(location.hash.slice(1)));
  follow(app);
  return app;
}
