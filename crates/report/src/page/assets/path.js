'use strict';
// A path through the bodies: a field along the line between two nodes, which moves with them, or between two points.

class Path {
  constructor(app) {
    this.app = app;
    const panel = app.panels.tab('Path');
    const words = 'With this panel open click two nodes in the picture, or type two points. The chart shows the field along the straight line between them, in the deformed bodies.';
    panel.append(element('p', { textContent: words }));
    this.inputs = ['from', 'to'].map((name, end) => {
      const inputs = ['x', 'y', 'z'].map((axis) => element('input', { type: 'number', step: 'any', ariaLabel: `${name} ${axis}`, oninput: () => this.typed(end) }));
      const label = element('span');
      panel.append(element('div', { className: 'choice place' }, [element('span', { textContent: name }), ...inputs, label]));
      return { inputs, label };
    });
    this.note = element('p', { className: 'note' });
    panel.append(this.note);
    this.clear();
  }

  /** No path. */
  clear() {
    this.ends = [null, null];
    this.next = 0;
    for (const { inputs, label } of this.inputs) {
      label.textContent = '';
      for (const input of inputs) input.value = '';
    }
    this.app.panels.replace('Path', []);
    this.chart = null;
    this.key = null;
  }

  /** The next end is a node. */
  take(node) {
    const { inputs, label } = this.inputs[this.next];
    this.ends[this.next] = { node: node.node };
    label.textContent = this.app.nameOf(node);
    for (const input of inputs) input.value = '';
    this.next = 1 - this.next;
  }

  typed(end) {
    const { inputs, label } = this.inputs[end];
    const place = inputs.map(({ value }) => (value === '' ? NaN : Number(value)));
    this.ends[end] = place.every(Number.isFinite) ? { place } : null;
    label.textContent = '';
    this.app.redraw();
  }

  /** The ends in the bodies as they are, or as they are drawn. */
  places(isDrawn) {
    const { viewer, run } = this.app;
    return this.ends.map(({ node, place }) => {
      if (place) return place;
      return isDrawn ? viewer.place(node) : add(referenceOf(run.animation, node), viewer.moved(node));
    });
  }

  isWhole() {
    return this.ends[0] !== null && this.ends[1] !== null;
  }

  /** Profiles of the field in all bodies that the line crosses: `{ name, x, y, colour }`. */
  profiles() {
    const { viewer, run: { animation } } = this.app;
    const [from, to] = this.places(false);
    if (!(size(subtract(to, from)) > 0) || !viewer.field()) return [];
    const places = viewer.places(1);
    const series = animation.bodies.map((body, k) => {
      const colour = COLOURS[k % COLOURS.length];
      return { name: body.name, ...profileOf(animation, places, viewer.now(), body.elements, from, to), colour };
    });
    return series.filter(({ x, y }, k) => !viewer.show.hidden.has(k) && x.length && y.some((value) => value !== null));
  }

  /** Brings the chart to the present time, field and ends. */
  show() {
    const { app } = this;
    if (app.panels.opened !== 'Path' || !this.isWhole()) return;
    const key = JSON.stringify([app.viewer.time, app.viewer.show.field, this.ends, [...app.viewer.show.hidden]]);
    if (key === this.key) return;
    this.key = key;
    const series = this.profiles();
    const field = app.viewer.field();
    this.note.textContent = series.length ? '' : 'No body with values of the field is on the line: choose a field, and ends in or on a deformable body.';
    const over = withUnit('distance', unitOf(app.run, 'length'));
    const title = field ? `${withUnit(field.label, field.unit)} over ${over}` : '';
    const isSame = this.chart?.title === title && this.chart.series.map(({ name }) => name).join() === series.map(({ name }) => name).join();
    if (isSame) {
      series.forEach((line, k) => Object.assign(this.chart.series[k], line));
      this.chart.draw();
      return;
    }
    app.panels.replace('Path', series.length ? [{ title, over, series }] : []);
    this.chart = app.panels.charts.find(({ box }) => box.parentNode === app.panels.tab('Path'));
  }

  /** The line in the picture. */
  draw(overlay) {
    const { panels, viewer } = this.app;
    if (panels.opened !== 'Path') return;
    for (const end of this.ends.filter(Boolean)) overlay.ring(end.place ?? viewer.place(end.node), '#8a5aa8', 5);
    if (!this.isWhole()) return;
    const seen = this.places(true).map((place) => viewer.project(place));
    if (!seen.every(Boolean)) return;
    overlay.pen.strokeStyle = '#8a5aa8';
    overlay.pen.lineWidth = 1.6;
    line(overlay.pen, seen);
  }
}
