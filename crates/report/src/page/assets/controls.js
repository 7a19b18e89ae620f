'use strict';
// The controls of the picture: what they say becomes what the viewer shows.

/** Part of the size of all that moves which the largest displacement becomes by itself. */
const VISIBLE = 0.1;

class Controls {
  constructor(app) {
    this.app = app;
    byId('play').onclick = () => app.play(!app.isPlaying);
    byId('back').onclick = () => app.step(-1);
    byId('forth').onclick = () => app.step(1);
    byId('scrub').oninput = () => app.setTime(Number(byId('scrub').value));
    byId('field').onchange = () => app.setField(Number(byId('field').value));
    for (const id of ['range', 'low', 'high', 'offset', 'own']) byId(id).oninput = () => this.apply();
    for (const id of ['mesh', 'outline', 'extremes', 'filled', 'enlarge', 'arrows', 'sectors', 'about']) byId(id).onchange = () => this.apply();
    for (const [box, place] of this.mirrors()) box.onchange = place.oninput = () => this.apply();
    byId('clip').onchange = () => {
      // What is between the eye and the plane is left out.
      const towards = app.viewer.camera.axes().eye[Number(byId('clip').value)];
      byId('flip').classList.toggle('on', towards < 0);
      this.apply();
    };
    byId('flip').onclick = () => {
      byId('flip').classList.toggle('on');
      this.apply();
    };
    byId('fit').onclick = () => {
      app.viewer.fit();
      app.redraw();
    };
    byId('save').onclick = () => pictureOf(app).toBlob((blob) => download(`${fileName(byId('title').textContent)}.png`, blob));
    for (const button of byId('views').querySelectorAll('[data-view]')) button.onclick = () => {
      const { camera } = app.viewer;
      [camera.azimuth, camera.elevation] = button.dataset.view.split(',').map(Number);
      app.viewer.home();
      app.redraw();
    };
    document.onkeydown = (event) => this.key(event);
    this.pointer(byId('scene'));
  }

  /** Box and place of the plane across each axis. */
  mirrors() {
    return ['x', 'y', 'z'].map((axis) => [byId(`mirror-${axis}`), byId(`mirror-at-${axis}`)]);
  }

  key(event) {
    const { app } = this;
    if (['INPUT', 'SELECT', 'BUTTON'].includes(event.target.tagName) || !app.isAnimated()) return;
    const act = { ' ': () => app.play(!app.isPlaying), ArrowLeft: () => app.step(-1), ArrowRight: () => app.step(1) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  /** The lists for a run: fields by arrays, arrows, bodies; planes of mirrors lie at its faces. */
  setRun(animation) {
    const { app } = this;
    const firsts = app.run.setup ? ['gap', 'distance to other bodies'] : ['von Mises stress'];
    const first = firsts.find((name) => animation.fields.some(({ label }) => label === name));
    const before = byId('field').selectedOptions[0]?.textContent ?? first;
    const groups = new Map();
    animation.fields.forEach(({ array, label }, k) => {
      groups.set(array, [...(groups.get(array) ?? []), element('option', { value: k, textContent: label })]);
    });
    const lists = [...groups].map(([{ label }, options]) => (options.length > 1 ? element('optgroup', { label }, options) : options[0]));
    byId('field').replaceChildren(element('option', { value: -1, textContent: 'bodies' }), ...lists);
    this.arrows = arrowsOf(animation);
    byId('arrows').replaceChildren(
      element('option', { value: '', textContent: 'none' }), ...this.arrows.map(({ label }, k) => element('option', { value: k, textContent: label })));
    const [low, high] = boxOf(animation, 0);
    this.mirrors().forEach(([, place], axis) => {
      if (place.value === '') place.value = Number(symmetryPlane(low[axis], high[axis]).toPrecision(6));
    });
    const others = app.run.setup ? [] : ['velocity', 'displacement'];
    const wanted = [before, ...others].map((name) => animation.fields.findIndex(({ label }) => label === name));
    app.setField(before === 'bodies' ? -1 : wanted.find((k) => k >= 0) ?? -1);
    byId('bodies').replaceChildren(...animation.bodies.map((body, k) => this.body(body, k)));
    this.apply();
  }

  body({ name }, k) {
    const { hidden } = this.app.viewer.show;
    const box = element('input', { type: 'checkbox', checked: true });
    box.onchange = () => {
      if (box.checked) hidden.delete(k);
      else hidden.add(k);
      this.app.redraw();
    };
    const swatch = element('span', { className: 'swatch' });
    swatch.style.background = `rgb(${scaled(BODIES[k % BODIES.length], 255).join(' ')})`;
    return element('label', {}, [box, swatch, name]);
  }

  /** Takes what all controls say. */
  apply() {
    const { viewer } = this.app;
    const { show } = viewer;
    const number = (id) => Number(byId(id).value);
    Object.assign(show, { range: byId('range').value, fixed: [number('low'), number('high')] });
    for (const id of ['mesh', 'outline']) show[id] = byId(id).checked;
    const axis = byId('clip').value;
    show.clip = axis === '' ? null : { axis: Number(axis), part: number('offset'), flipped: byId('flip').classList.contains('on') };
    show.isFilled = byId('filled').checked;
    show.arrows = byId('arrows').value === '' ? null : this.arrows[number('arrows')] ?? null;
    const isAt = ([box, place]) => (box.checked ? Number(place.value) : null);
    const copies = { mirrors: this.mirrors().map(isAt), count: Math.min(Math.max(Math.floor(number('sectors')), 1), 72), axis: number('about') };
    const enlarged = this.enlarged();
    const isHome = viewer.isHome();
    const key = JSON.stringify([enlarged, copies]);
    if (key !== this.space) {
      Object.assign(show, { enlarged, copies });
      viewer.resize();
      if (isHome) viewer.home();
      this.space = key;
    }
    byId('ends').classList.toggle('on', show.range === 'fixed');
    byId('plane').classList.toggle('on', axis !== '');
    byId('own').classList.toggle('on', byId('enlarge').value === 'own');
    this.app.redraw();
  }

  /** The factor of the displacements. */
  enlarged() {
    const wanted = byId('enlarge').value;
    const own = Number(byId('own').value);
    if (wanted === 'own') return Number.isFinite(own) ? own : 1;
    if (wanted !== 'auto') return Number(wanted);
    const { animation } = this.app.run;
    const [low, high] = boxOf(animation, 0);
    const [, largest] = rangeOf(animation.fields[0], animation);
    const factor = largest > 0 ? (VISIBLE * size(subtract(high, low))) / largest : 1;
    // Large motions are shown as they are; else a round number.
    if (factor <= 1) return 1;
    const power = 10 ** Math.floor(Math.log10(factor));
    return power * [5, 2, 1].find((n) => n * power <= factor * (1 + 1e-9));
  }

  pointer(canvas) {
    const { app } = this;
    const { camera } = app.viewer;
    const touches = new Map();
    let way = 0;
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      if (!touches.size) way = 0;
      touches.set(event.pointerId, [event.clientX, event.clientY]);
    };
    canvas.onpointermove = (event) => {
      const last = touches.get(event.pointerId);
      if (!last) return;
      const now = [event.clientX, event.clientY];
      const [dx, dy] = [now[0] - last[0], now[1] - last[1]];
      way += Math.abs(dx) + Math.abs(dy);
      const other = [...touches].find(([id]) => id !== event.pointerId)?.[1];
      touches.set(event.pointerId, now);
      if (other) {
        // Two fingers: their distance is the size, their middle the place.
        const apart = (place) => Math.max(Math.hypot(place[0] - other[0], place[1] - other[1]), 1);
        camera.zoom(apart(last) / apart(now));
        camera.pan(dx / 2 / canvas.clientHeight, dy / 2 / canvas.clientHeight);
      } else if (event.shiftKey || event.buttons & 6) camera.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      else camera.turn(-0.4 * dx, 0.4 * dy);
      app.redraw();
    };
    canvas.onpointerup = (event) => {
      touches.delete(event.pointerId);
      const box = canvas.getBoundingClientRect();
      if (way < 4) app.pick(pickIn(app.viewer, event.clientX - box.left, event.clientY - box.top));
    };
    canvas.onpointercancel = (event) => touches.delete(event.pointerId);
    canvas.oncontextmenu = (event) => event.preventDefault();
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(0.0012 * event.deltaY));
      app.redraw();
    }, { passive: false });
  }
}

/** Where a model between two places along an axis is likely to be mirrored: at the end that is nearer to zero, for there it is cut. */
function symmetryPlane(low, high) {
  return Math.abs(high) < Math.abs(low) ? high : low;
}
