'use strict';
// Draws the bodies of a run at any time of it with WebGL2.
//
// The displacements of all frames are in one buffer. Two of them are bound at once and mixed by the vertex shader, so that a frame costs
// no copy; facets are lit by their own normal, which the fragment shader takes from the derivatives of the place.

/** Pixels by which a line is moved to become thick, and wider. */
const THICK = [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]];
const WIDE = [[2, 0], [-2, 0], [0, 2], [0, -2], [1.4, 1.4], [1.4, -1.4], [-1.4, 1.4], [-1.4, -1.4]];
const NO_PLANE = [0, 0, 0, 1];

class Viewer {
  /** Throws if there is no WebGL2. */
  constructor(canvas) {
    this.canvas = canvas;
    this.camera = new Camera();
    const gl = canvas.getContext('webgl2', { antialias: !isSoftware(), alpha: false });
    if (!gl) throw new Error('this browser has no WebGL2, so that there is no animation');
    this.gl = gl;
    [this.ofBodies, this.free, this.ofArrows] = [BODY, FREE, ARROW].map((vertex) => programOf(gl, vertex));
    makeMap(gl);
    this.arrow = this.buffer(gl.ARRAY_BUFFER, Float32Array.from(SHAPE.flat()));
    this.moving = gl.createBuffer();
    /** What is shown; the page's controls change it. */
    this.show = {
      field: -1, range: 'typical', fixed: [0, 1], mesh: true, outline: false, hidden: new Set(), clip: null, isFilled: true,
      enlarged: 1, arrows: null, copies: { mirrors: [null, null, null], count: 1, axis: 2 },
    };
    this.time = 0;
  }

  /** Takes another run. */
  setRun(animation) {
    const gl = this.gl;
    for (const buffer of this.buffers ?? []) gl.deleteBuffer(buffer);
    this.run = animation;
    this.reference = this.buffer(gl.ARRAY_BUFFER, animation.reference);
    this.displacement = this.buffer(gl.ARRAY_BUFFER, animation.displacement);
    this.values = this.buffer(gl.ARRAY_BUFFER, new Float32Array(animation.nodes * animation.times.length));
    this.triangles = this.buffer(gl.ELEMENT_ARRAY_BUFFER, trianglesOf(animation.facets));
    const sides = animation.bodies.map((body) => sidesOf(animation, body));
    this.sides = this.elements(sides.map((side) => side.all));
    this.outlines = this.elements(sides.map((side) => side.sharp));
    this.segments = this.buffer(gl.ELEMENT_ARRAY_BUFFER, animation.segments);
    this.points = this.buffer(gl.ELEMENT_ARRAY_BUFFER, animation.points);
    this.buffers = [
      this.reference, this.displacement, this.values, this.triangles, this.sides.buffer, this.outlines.buffer, this.segments, this.points,
    ];
    this.outer = animation.bodies.map((body) => outerNodes(animation, body));
    this.whole = animation.bodies.map((body) => nodesOf(animation, body));
    this.known = {};
    this.show.hidden.clear();
    this.setField(this.show.field);
    this.resize();
    this.home();
  }

  buffer(target, data) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, data, this.gl.STATIC_DRAW);
    return buffer;
  }

  /** One buffer of indices for several bodies, and the part of each. */
  elements(lists) {
    const starts = [0];
    for (const list of lists) starts.push(starts[starts.length - 1] + list.length);
    const all = new Uint32Array(starts[starts.length - 1]);
    lists.forEach((list, k) => all.set(list, starts[k]));
    return { starts, buffer: this.buffer(this.gl.ELEMENT_ARRAY_BUFFER, all) };
  }

  /** The field that colours, or nothing. */
  field() {
    return this.run.fields[this.show.field];
  }

  /** Colours by the field of that number; -1 by bodies. */
  setField(number) {
    this.show.field = number < this.run.fields.length ? number : -1;
    if (!this.field()) return;
    const values = valuesOf(this.field(), this.run).map((value) => (Number.isNaN(value) ? NONE : value));
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.values);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, values, this.gl.STATIC_DRAW);
  }

  /** Takes account of another enlargement or of other copies. */
  resize() {
    this.copies = copiesOf(this.show.copies);
    [this.low, this.high] = boxOfCopies(this.copies, boxOf(this.run, this.show.enlarged));
  }

  /** Length of the diagonal of all that moves. */
  extent() {
    return size(subtract(this.high, this.low));
  }

  aspect() {
    return this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1);
  }

  /** Looks at all that moves, from the same side. */
  home() {
    this.camera.show(this.low, subtract(this.high, this.low), this.aspect());
    this.atHome = JSON.stringify(this.camera);
  }

  /** Looks at what is shown at this moment on this side of the plane, from the same side. */
  fit() {
    const places = this.places();
    const [x, y, z, offset] = this.clip();
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const copy of this.copies) {
      for (const node of this.shownNodes()) {
        const place = placed(copy, places.subarray(3 * node, 3 * node + 3));
        if (dot([x, y, z], place) > offset) continue;
        for (let k = 0; k < 3; k++) {
          low[k] = Math.min(low[k], place[k]);
          high[k] = Math.max(high[k], place[k]);
        }
      }
    }
    if (low[0] <= high[0]) this.camera.show(low, subtract(high, low), this.aspect());
  }

  /** Whether the camera is where it was put, and not where somebody has moved it. */
  isHome() {
    return this.atHome === JSON.stringify(this.camera);
  }

  /** Frame before the time and the part of the way to the next one. */
  moment() {
    const times = this.run.times;
    const frame = Math.max(placeIn(times, this.time), 0);
    if (frame + 1 >= times.length) return { frame, next: frame, part: 0 };
    const part = (this.time - times[frame]) / (times[frame + 1] - times[frame]);
    return { frame, next: frame + 1, part: Math.min(Math.max(part, 0), 1) };
  }

  /** What was made for this moment and these settings, or is made now. */
  once(name, key, make) {
    const found = this.known[name];
    if (found?.key !== key) this.known[name] = { key, value: make(found?.value) };
    return this.known[name].value;
  }

  /** Where all nodes are drawn, or are with displacements times a factor, three numbers each. */
  places(enlarged = this.show.enlarged) {
    const { run } = this;
    return this.once(enlarged === this.show.enlarged ? 'places' : 'other places', `${this.time} ${enlarged}`, (old) => {
      const out = old ?? new Float32Array(3 * run.nodes);
      const { frame, next, part } = this.moment();
      const rows = [frame, next].map((row) => 3 * row * run.nodes);
      for (let k = 0; k < out.length; k++) {
        const axis = k % 3;
        const moved = (1 - part) * run.displacement[rows[0] + k] + part * run.displacement[rows[1] + k];
        out[k] = run.corner[axis] + (run.reference[k] / 65535) * run.edges[axis] + (enlarged * run.largest[axis] * moved) / 32767;
      }
      return out;
    });
  }

  /** Where a node is drawn. */
  place(node) {
    return add(referenceOf(this.run, node), scaled(this.moved(node), this.show.enlarged));
  }

  /** Displacement of a node. */
  moved(node) {
    const { frame, next, part } = this.moment();
    return mixed(movedOf(this.run, frame, node), movedOf(this.run, next, node), part);
  }

  /** Between two frames; a number of a state is that of the nearer one. */
  between(field, a, b) {
    const { part } = this.moment();
    if (field.array.isWhole) return part < 0.5 ? a : b;
    return part === 0 ? a : a + part * (b - a);
  }

  /** Value of a field at a node. */
  value(field, node) {
    const { frame, next } = this.moment();
    return this.between(field, valueAt(field, frame * this.run.nodes + node), valueAt(field, next * this.run.nodes + node));
  }

  /** Values of the field that colours at all nodes. */
  now() {
    const { run } = this;
    const field = this.field();
    return this.once('now', `${this.time} ${this.show.field}`, (old) => {
      const out = old ?? new Float32Array(run.nodes);
      if (!field) return out.fill(NaN);
      const values = valuesOf(field, run);
      const { frame, next } = this.moment();
      for (let node = 0; node < run.nodes; node++) {
        out[node] = this.between(field, values[frame * run.nodes + node], values[next * run.nodes + node]);
      }
      return out;
    });
  }

  /** Nodes of the bodies that are not hidden, inside and outside. */
  * shownNodes() {
    for (let k = 0; k < this.whole.length; k++) if (!this.show.hidden.has(k)) yield* this.whole[k];
  }

  /** Nodes with the smallest and the largest value of the field among those on this side of the plane; nothing without any. */
  extremes() {
    const [values, places] = [this.now(), this.places()];
    const [x, y, z, offset] = this.clip();
    let [low, high] = [-1, -1];
    for (const node of this.shownNodes()) {
      const value = values[node];
      if (Number.isNaN(value) || x * places[3 * node] + y * places[3 * node + 1] + z * places[3 * node + 2] > offset) continue;
      if (low < 0 || value < values[low]) low = node;
      if (high < 0 || value > values[high]) high = node;
    }
    return low < 0 ? null : [low, high].map((node) => ({ node, value: values[node] }));
  }

  /** Values at the two ends of the colour bar. */
  range() {
    const field = this.field();
    if (!field) return [0, 1];
    const ranges = {
      fixed: () => this.show.fixed,
      frame: () => endsOf(this.now()),
      run: () => rangeOf(field, this.run),
      typical: () => typicalRange(field, this.run),
    };
    const [low, high] = ranges[this.show.range]();
    // A constant is in the middle of the colours.
    const around = low < high ? 0 : (Math.abs(low) || 1) * 1e-6;
    return [low - around, low < high ? high : low + around];
  }

  /** The clip plane: what lies beyond `normal . x = offset` is left out. */
  clip() {
    const { clip } = this.show;
    if (!clip) return NO_PLANE;
    const sign = clip.flipped ? -1 : 1;
    const normal = [0, 0, 0];
    normal[clip.axis] = sign;
    return [...normal, sign * (this.low[clip.axis] + clip.part * (this.high[clip.axis] - this.low[clip.axis]))];
  }

  matrices() {
    const view = this.camera.view();
    return { view, projection: this.camera.projection(this.canvas.width / Math.max(this.canvas.height, 1)) };
  }

  /** Place in the picture (pixels of the page) of a place in space; nothing behind the eye. */
  project(place) {
    const { view, projection } = this.matrices();
    const all = product(projection, view);
    const row = (k) => all[k] * place[0] + all[4 + k] * place[1] + all[8 + k] * place[2] + all[12 + k];
    const w = row(3);
    if (w <= 0) return null;
    return [(0.5 + (0.5 * row(0)) / w) * this.canvas.clientWidth, (0.5 - (0.5 * row(1)) / w) * this.canvas.clientHeight];
  }

  draw() {
    const { gl, show } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.frame = { ...this.matrices(), range: this.range(), clip: this.clip(), ratio };
    for (const copy of this.copies) {
      this.drawBodies(copy);
      if (show.clip && show.isFilled) drawCut(this, copy);
    }
    this.layers?.draw(this);
    if (show.arrows) for (const copy of this.copies) drawWays(this, arrowsAt(this, show.arrows, this.extent()), copy, [0.13, 0.3, 0.55, 0.9]);
  }

  /** Takes a program for the present picture. */
  use(program, copy) {
    const gl = this.gl;
    this.program = program;
    gl.useProgram(program.program);
    const { at } = program;
    const { view, projection, range, clip } = this.frame;
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniformMatrix4fv(at.projection, false, projection);
    gl.uniformMatrix4fv(at.copy, false, copy);
    gl.uniform4fv(at.clip, clip);
    gl.uniform2fv(at.range, range);
  }

  /** Takes an attribute of the present program from a buffer; it stands again after `stride` bytes. */
  take(name, buffer, [count, type, isNormal], stride = 0, start = 0, divisor = 0) {
    const gl = this.gl;
    const place = this.program.takes[name];
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, count, type, isNormal, stride, start);
    gl.vertexAttribDivisor(place, divisor);
  }

  /** Forgets the attributes of the present program. */
  leave() {
    for (const place of Object.values(this.program.takes)) {
      this.gl.vertexAttribDivisor(place, 0);
      this.gl.disableVertexAttribArray(place);
    }
  }

  /** Sets what the fragment shader does. */
  paint(colour, { byField = false, isLit = false, isRound = false, shift = [0, 0] } = {}) {
    const { gl, program: { at } } = this;
    gl.uniform4fv(at.colour, colour);
    gl.uniform1i(at.byField, byField ? 1 : 0);
    gl.uniform1i(at.isLit, isLit ? 1 : 0);
    gl.uniform1i(at.isRound, isRound ? 1 : 0);
    if (at.shift) gl.uniform2fv(at.shift, shift);
  }

  drawBodies(copy) {
    const { gl, run, show } = this;
    this.use(this.ofBodies, copy);
    const { at } = this.program;
    gl.uniform3fv(at.corner, run.corner);
    gl.uniform3fv(at.edges, run.edges);
    gl.uniform3fv(at.largest, run.largest);
    gl.uniform1f(at.enlarged, show.enlarged);
    const { frame, next, part } = this.moment();
    gl.uniform1f(at.part, part);
    this.take('reference', this.reference, [3, gl.UNSIGNED_SHORT, true], 6);
    const rows = [['before', 'value0', frame], ['after', 'value1', next]];
    for (const [moved, value, row] of rows) {
      this.take(moved, this.displacement, [3, gl.SHORT, true], 6, 6 * row * run.nodes);
      this.take(value, this.values, [1, gl.FLOAT, false], 4, 4 * row * run.nodes);
    }
    const shown = run.bodies.map((body, k) => [body, k]).filter(([, k]) => !show.hidden.has(k));
    for (const [body, k] of shown) this.drawSurface(body, k);
    for (const [body, k] of shown) this.drawLines(body, k);
    if (show.outline) {
      gl.uniform1f(at.enlarged, 0);
      for (const [, k] of shown) {
        this.drawSides(this.sides, k, [0.25, 0.35, 0.55, 0.15]);
        this.drawSides(this.outlines, k, [0.25, 0.35, 0.55, 0.8]);
      }
    }
    this.leave();
  }

  drawSurface(body, k) {
    const gl = this.gl;
    const byField = this.show.field >= 0;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.paint(byField ? GREY : BODIES[k % BODIES.length], { byField, isLit: true });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.triangles);
    gl.drawElements(gl.TRIANGLES, 6 * body.facets[1], gl.UNSIGNED_INT, 24 * body.facets[0]);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (this.show.mesh) this.drawSides(this.sides, k, [0.1, 0.12, 0.18, 0.22]);
  }

  drawSides({ starts, buffer }, k, colour) {
    const gl = this.gl;
    this.paint(colour);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.drawElements(gl.LINES, starts[k + 1] - starts[k], gl.UNSIGNED_INT, 4 * starts[k]);
  }

  /** Lines of beams and strings, made thick by drawing them several times beside each other, over a wider dark line; and single points. */
  drawLines(body, k) {
    const { gl, canvas, frame: { ratio } } = this;
    const byField = this.show.field >= 0;
    const colour = byField ? GREY : BODIES[k % BODIES.length];
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.segments);
    const draw = (paint, shifts) => {
      for (const [x, y] of body.segments[1] ? shifts : []) {
        this.paint(paint, { byField: byField && paint === colour, shift: [(2 * ratio * x) / canvas.width, (2 * ratio * y) / canvas.height] });
        gl.drawElements(gl.LINES, 2 * body.segments[1], gl.UNSIGNED_INT, 8 * body.segments[0]);
      }
    };
    gl.depthMask(false);
    draw([0.2, 0.23, 0.28, 1], WIDE);
    gl.depthMask(true);
    draw(colour, THICK);
    gl.uniform1f(this.program.at.pointSize, 12 * ratio);
    this.paint(colour, { byField, isRound: true });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.points);
    gl.drawElements(gl.POINTS, body.points[1], gl.UNSIGNED_INT, 4 * body.points[0]);
  }
}
