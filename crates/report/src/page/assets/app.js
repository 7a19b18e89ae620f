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
    this.controls = new Controls(this);
    this.overlay = new Overlay(this, byId('overlay'));
    if (this.runs.some((run) => run.animation?.elements.length)) this.path = new Path(this);
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
    if (run.setup) byId('title').textContent = run.setup.title;
    // How the run ended comes first: a verdict on a part of it is none on its result.
    const { kind, words } = ending(s);
    Object.assign(byId('outcome'), { textContent: words, className: `badge ${kind}` });
    Object.assign(byId('verdict'), { ...judgement(s, unitOf(run, 'time')), onclick: () => this.panels.open('Verdict') });
    byId('failure').textContent = s?.outcome?.reason ?? '';
    for (const id of ['outcome', 'verdict']) byId(id).hidden = Boolean(run.setup);
    byId('facts').textContent = run.setup ? 'the scene before its run' : s ? `${run.name} · ${s.steps} steps to t = ${text(s.time)}${after(unitOf(run, 'time'))} · ${text(s.wall_seconds)} s` : run.name;
    this.panels.setRun(run);
    this.place = null;
    this.pick(null);
    this.play(false);
    const { classList } = document.querySelector('main');
    classList.toggle('plain', !this.isAnimated());
    classList.toggle('setup', Boolean(run.setup));
    if (this.isAnimated()) {
      // A section is seen along z.
      if (run.run?.section) Object.assign(this.viewer.camera, { azimuth: -90, elevation: 90 });
      this.viewer.setRun(run.animation);
      this.viewer.layers = run.setup ? new Layers(this, run.setup.layers) : null;
      this.controls.setRun(run.animation);
      this.path?.clear();
      this.setTime(this.viewer.time);
    }
    this.redraw();
  }

  setField(number) {
    byId('field').value = number;
    this.viewer.setField(number);
    const field = this.viewer.field();
    if (field) [byId('low').value, byId('high').value] = typicalRange(field, this.run.animation).map((value) => Number(value.toPrecision(3)));
    this.controls.apply();
    this.showNode();
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

  /** Marks a node, or none; it may be an end of the path. */
  pick(node) {
    this.picked = node;
    if (node && this.panels.opened === 'Path') this.path.take(node);
    this.showNode();
    this.redraw();
  }

  /** The charts of the picked node: the field that is shown, and the components of all arrays. */
  showNode() {
    if (!this.picked) return;
    const { animation } = this.run;
    const { node } = this.picked;
    const line = (name, read, colour) => {
      const y = animation.times.map((_, frame) => read(frame * animation.nodes + node)).map((v) => (Number.isNaN(v) ? null : v));
      return { name, x: animation.times, y, colour };
    };
    const chart = (title, unit, series) => ({ title: `${this.nameOf(this.picked)}: ${withUnit(title, unit)}`, series, unit: unitOf(this.run, 'time') });
    const shown = this.viewer.field() ?? animation.fields[0];
    const charts = [chart(shown.label, shown.unit, [line(shown.label, (k) => valueAt(shown, k), COLOURS[0])])];
    for (const array of animation.arrays) {
      const fields = animation.fields.filter((field) => field.array === array && (array.read.length === 1 || field.part.kind === 'component'));
      if (fields.length === 1 && fields[0] === shown) continue;
      const series = fields.map((field, k) => line(field.label, (place) => valueAt(field, place), COLOURS[k % COLOURS.length]));
      const known = series.filter(({ y }) => y.some((value) => value !== null));
      if (known.length) charts.push(chart(array.label, fields[0].unit, known));
    }
    this.panels.tab('Node').prepend(this.panels.values);
    this.panels.replace('Node', charts);
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
    this.drawPicked();
    this.path?.show();
    this.overlay.draw();
  }

  /** Place and displacement of the picked node with the value that is shown; all its values in the panel. */
  drawPicked() {
    if (!this.picked) return byId('picked').replaceChildren();
    const { node } = this.picked;
    const { animation } = this.run;
    const length = unitOf(this.run, 'length');
    const place = [withUnit('position', length), add(referenceOf(animation, node), this.viewer.moved(node)).map(text).join('  ')];
    const rows = [];
    for (const array of animation.arrays) {
      const fields = animation.fields.filter((found) => found.array === array && (array.read.length === 1 || found.part.kind === 'component'));
      const values = fields.map((found) => this.viewer.value(found, node));
      if (!values.every(Number.isNaN)) rows.push([withUnit(array.label, fields[0].unit), values.map(text).join('  ')]);
    }
    const field = this.viewer.field();
    const shown = field ? [[withUnit(field.label, field.unit), text(this.viewer.value(field, node))]] : [];
    const name = () => element('b', { textContent: this.nameOf(this.picked) });
    byId('picked').replaceChildren(name(), table([...shown, place, rows[0]]));
    this.panels.values.replaceChildren(name(), table([place, ...rows]));
  }

  resized() {
    if (this.isAnimated() && this.viewer.isHome()) this.viewer.home();
    this.panels.redraw();
    // At once: the browser is about to show the picture in its new size.
    this.draw();
  }
}

/** What the address asks for behind its `#`, such as `t=0.5&field=velocity&tab=Contact&view=0,90`, and controls by their names, such as `clip=0&extremes=true`; `fit=true` fills the picture. */
function obey(app, wishes) {
  const time = Number(wishes.get('t'));
  const named = wishes.get('field')?.replaceAll('_', ' ');
  const field = app.run.animation?.fields.findIndex(({ label }) => label === named) ?? -1;
  const view = wishes.get('view')?.split(',').map(Number) ?? [];
  if (app.isAnimated() && view.length === 2 && view.every(Number.isFinite)) {
    [app.viewer.camera.azimuth, app.viewer.camera.elevation] = view;
    app.viewer.home();
  }
  if (app.isAnimated() && field >= 0) app.setField(field);
  for (const id of app.isAnimated() ? KEPT.filter((kept) => wishes.has(kept)) : []) {
    const control = byId(id);
    if (control.type === 'checkbox') control.checked = wishes.get(id) === 'true';
    else control.value = wishes.get(id);
    control.dispatchEvent(new Event(control.onchange ? 'change' : 'input'));
  }
  if (app.panels.tabs.has(wishes.get('tab'))) app.panels.open(wishes.get('tab'));
  if (wishes.has('t') && Number.isFinite(time)) app.setTime(time);
  if (app.isAnimated() && wishes.get('fit') === 'true') app.viewer.fit();
}

async function start() {
  const texts = [...document.querySelectorAll('script.run')].map((script) => script.textContent);
  const app = new App(await Promise.all(texts.map(unpack)));
  obey(app, new URLSearchParams(location.hash.slice(1)));
  follow(app);
  return app;
}
