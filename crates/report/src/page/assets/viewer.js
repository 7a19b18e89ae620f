'use strict';
// Draws the bodies of a run at any time of it with WebGL2.
//
// The positions of all frames are in one buffer. Two of them are bound at once and mixed by the vertex shader, so that a frame costs
// no copy; facets are lit by their own normal, which the fragment shader takes from the derivatives of the place.

const VERTEX = `#version 300 es
in vec3 before, after;
in float value0, value1;
uniform float part, pointSize;
uniform vec3 corner, edges;
uniform vec2 shift;
uniform mat4 view, projection;
out vec3 world, seen;
out float value, known;
void main() {
  world = corner + edges * mix(before, after, part);
  vec4 place = view * vec4(world, 1.0);
  seen = place.xyz;
  known = float(abs(value0) < 1e37 && abs(value1) < 1e37);
  value = known > 0.5 ? mix(value0, value1, part) : 0.0;
  gl_Position = projection * place;
  gl_Position.xy += shift * gl_Position.w;
  gl_PointSize = pointSize;
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 world, seen;
in float value, known;
uniform vec4 colour, clip;
uniform vec2 range;
uniform bool byField, isLit, isRound;
uniform sampler2D map;
out vec4 result;
void main() {
  if (dot(clip.xyz, world) > clip.w) discard;
  if (isRound && length(gl_PointCoord - 0.5) > 0.5) discard;
  if (isRound && length(gl_PointCoord - 0.5) > 0.36) {
    result = vec4(0.2, 0.23, 0.28, 1.0);
    return;
  }
  vec3 base = colour.rgb;
  if (byField && known > 0.999) base = texture(map, vec2((value - range.x) / (range.y - range.x), 0.5)).rgb;
  if (isLit) {
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    vec3 light = normalize(vec3(0.25, 0.45, 1.0));
    base *= 0.45 + 0.6 * abs(dot(normal, light));
  }
  result = vec4(base, colour.a);
}`;

/** Stops of the colour map, darker at every stop: that of the pictures (`paint/colour.rs`). */
const STOPS = [[233, 237, 242], [250, 222, 150], [247, 172, 76], [226, 103, 60], [172, 42, 80], [88, 18, 84]];
const GREY = [0.75, 0.78, 0.81, 1];
const BODIES = [[0.55, 0.68, 0.8, 1], [0.85, 0.72, 0.52, 1], [0.6, 0.75, 0.6, 1], [0.78, 0.62, 0.72, 1], [0.7, 0.7, 0.74, 1]];
/** Pixels by which a line is moved to become thick, and wider. */
const THICK = [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]];
const WIDE = [[2, 0], [-2, 0], [0, 2], [0, -2], [1.4, 1.4], [1.4, -1.4], [-1.4, 1.4], [-1.4, -1.4]];
/** No number, for the graphics card. */
const NONE = 1e38;

/** Colour of the map at a part between 0 and 1, as three numbers up to 255. */
function mapColour(part) {
  const place = Math.min(Math.max(part, 0), 1) * (STOPS.length - 1);
  const low = Math.min(Math.floor(place), STOPS.length - 2);
  return mixed(STOPS[low], STOPS[low + 1], place - low).map(Math.round);
}

class Viewer {
  /** Throws if there is no WebGL2. */
  constructor(canvas) {
    this.canvas = canvas;
    this.camera = new Camera();
    const gl = canvas.getContext('webgl2', { antialias: !isSoftware(), alpha: false });
    if (!gl) throw new Error('this browser has no WebGL2, so that there is no animation');
    this.gl = gl;
    this.program = programOf(gl, VERTEX, FRAGMENT);
    const uniforms = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS);
    this.at = {};
    for (let k = 0; k < uniforms; k++) {
      const { name } = gl.getActiveUniform(this.program, k);
      this.at[name] = gl.getUniformLocation(this.program, name);
    }
    this.attributes = ['before', 'after', 'value0', 'value1'].map((name) => gl.getAttribLocation(this.program, name));
    this.makeMap();
    /** What is shown; the page's controls change it. */
    this.show = { field: -1, range: 'run', fixed: [0, 1], mesh: true, outline: false, hidden: new Set(), clip: null };
    this.time = 0;
  }

  makeMap() {
    const gl = this.gl;
    const texels = new Uint8Array(4 * 256);
    for (let k = 0; k < 256; k++) texels.set([...mapColour(k / 255), 255], 4 * k);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    for (const name of ['TEXTURE_WRAP_S', 'TEXTURE_WRAP_T']) gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.CLAMP_TO_EDGE);
    for (const name of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER']) gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.LINEAR);
  }

  /** Takes another run. */
  setRun(animation) {
    const gl = this.gl;
    for (const buffer of this.buffers ?? []) gl.deleteBuffer(buffer);
    this.run = animation;
    this.positions = this.buffer(gl.ARRAY_BUFFER, animation.positions);
    this.values = this.buffer(gl.ARRAY_BUFFER, new Float32Array(animation.nodes * animation.times.length));
    this.triangles = this.buffer(gl.ELEMENT_ARRAY_BUFFER, trianglesOf(animation.facets));
    const sides = animation.bodies.map((body) => sidesOf(animation, body));
    this.sides = this.elements(sides.map((side) => side.all));
    this.outlines = this.elements(sides.map((side) => side.sharp));
    this.segments = this.buffer(gl.ELEMENT_ARRAY_BUFFER, animation.segments);
    this.points = this.buffer(gl.ELEMENT_ARRAY_BUFFER, animation.points);
    this.buffers = [this.positions, this.values, this.triangles, this.sides.buffer, this.outlines.buffer, this.segments, this.points];
    this.show.hidden.clear();
    this.setField(this.show.field);
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

  /** Colours by the field of that number; -1 by bodies. */
  setField(number) {
    this.show.field = number < this.run.fields.length ? number : -1;
    if (this.show.field < 0) return;
    const values = valuesOf(this.run.fields[this.show.field]).map((value) => (Number.isNaN(value) ? NONE : value));
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.values);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, values, this.gl.STATIC_DRAW);
  }

  /** Looks at all that moves, from the same side. */
  home() {
    this.camera.show(this.run.corner, this.run.edges, this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1));
    this.atHome = JSON.stringify(this.camera);
  }

  /** Whether the camera is where it was put, and not where somebody has moved it. */
  isHome() {
    return this.atHome === JSON.stringify(this.camera);
  }

  /** Frame before the time and the part of the way to the next one. */
  moment() {
    const times = this.run.times;
    let frame = 0;
    for (let low = 0, high = times.length - 1; low <= high;) {
      const middle = (low + high) >> 1;
      if (times[middle] <= this.time) [frame, low] = [middle, middle + 1];
      else high = middle - 1;
    }
    if (frame + 1 >= times.length) return { frame, next: frame, part: 0 };
    const part = (this.time - times[frame]) / (times[frame + 1] - times[frame]);
    return { frame, next: frame + 1, part: Math.min(Math.max(part, 0), 1) };
  }

  /** Where a node is. */
  place(node) {
    const { frame, next, part } = this.moment();
    return mixed(placeOf(this.run, frame + 1, node), placeOf(this.run, next + 1, node), part);
  }

  /** Value of a field at a node. */
  value(field, node) {
    const { frame, next, part } = this.moment();
    const values = valuesOf(field);
    const [a, b] = [values[frame * this.run.nodes + node], values[next * this.run.nodes + node]];
    if (field.largest === null) return part < 0.5 ? a : b;
    return a + part * (b - a);
  }

  /** Values at the two ends of the colour bar. */
  range() {
    const field = this.run.fields[this.show.field];
    if (!field) return [0, 1];
    let [low, high] = this.show.range === 'fixed' ? this.show.fixed : field.range;
    if (this.show.range === 'frame') {
      const { frame } = this.moment();
      [low, high] = [Infinity, -Infinity];
      for (const value of valuesOf(field).subarray(frame * this.run.nodes, (frame + 1) * this.run.nodes)) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    // A constant is in the middle of the colours.
    const around = low < high ? 0 : (Math.abs(low) || 1) * 1e-6;
    return [low - around, low < high ? high : low + around];
  }

  /** The clip plane: what lies beyond `normal . x = offset` is left out. */
  clip() {
    const { clip } = this.show;
    if (!clip) return [0, 0, 0, 1];
    const sign = clip.flipped ? -1 : 1;
    const normal = [0, 0, 0];
    normal[clip.axis] = sign;
    return [...normal, sign * (this.run.corner[clip.axis] + clip.part * this.run.edges[clip.axis])];
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

  /** Binds positions of two rows and values of two frames. */
  bind(rows, frames) {
    const gl = this.gl;
    const [before, after, value0, value1] = this.attributes;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
    [before, after].forEach((attribute, k) => {
      gl.enableVertexAttribArray(attribute);
      gl.vertexAttribPointer(attribute, 3, gl.UNSIGNED_SHORT, true, 6, rows[k] * this.run.nodes * 6);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.values);
    [value0, value1].forEach((attribute, k) => {
      gl.enableVertexAttribArray(attribute);
      gl.vertexAttribPointer(attribute, 1, gl.FLOAT, false, 4, frames[k] * this.run.nodes * 4);
    });
  }

  draw() {
    const { gl, at, run, show } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.program);
    const { view, projection } = this.matrices();
    gl.uniformMatrix4fv(at.view, false, view);
    gl.uniformMatrix4fv(at.projection, false, projection);
    gl.uniform3fv(at.corner, run.corner);
    gl.uniform3fv(at.edges, run.edges);
    gl.uniform4fv(at.clip, this.clip());
    gl.uniform2fv(at.range, this.range());
    const { frame, next, part } = this.moment();
    gl.uniform1f(at.part, part);
    this.bind([frame + 1, next + 1], [frame, next]);
    const shown = run.bodies.map((body, k) => [body, k]).filter(([, k]) => !show.hidden.has(k));
    for (const [body, k] of shown) this.drawSurface(body, k);
    for (const [body, k] of shown) this.drawLines(body, k, ratio);
    if (show.outline) {
      gl.uniform1f(at.part, 0);
      this.bind([0, 0], [0, 0]);
      for (const [, k] of shown) {
        this.drawSides(this.sides, k, [0.25, 0.35, 0.55, 0.15]);
        this.drawSides(this.outlines, k, [0.25, 0.35, 0.55, 0.8]);
      }
    }
  }

  /** Sets what the fragment shader does. */
  paint(colour, { byField = false, isLit = false, isRound = false, shift = [0, 0] } = {}) {
    const { gl, at } = this;
    gl.uniform4fv(at.colour, colour);
    gl.uniform1i(at.byField, byField ? 1 : 0);
    gl.uniform1i(at.isLit, isLit ? 1 : 0);
    gl.uniform1i(at.isRound, isRound ? 1 : 0);
    gl.uniform2fv(at.shift, shift);
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
  drawLines(body, k, ratio) {
    const { gl, at, canvas } = this;
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
    gl.uniform1f(at.pointSize, 12 * ratio);
    this.paint(colour, { byField, isRound: true });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.points);
    gl.drawElements(gl.POINTS, body.points[1], gl.UNSIGNED_INT, 4 * body.points[0]);
  }

  /** Body and node that are seen at a place of the picture (pixels of the page); nothing where there is none. */
  pick(x, y) {
    const { run, camera } = this;
    const places = Array.from({ length: run.nodes }, (_, node) => this.place(node));
    const { right, up, eye } = camera.axes();
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const { projection } = this.matrices();
    const from = add(camera.target, scaled(eye, camera.distance));
    const side = add(scaled(right, ((2 * x) / width - 1) / projection[0]), scaled(up, (1 - (2 * y) / height) / projection[5]));
    const along = subtract(side, eye);
    const [nx, ny, nz, offset] = this.clip();
    let best = { distance: Infinity };
    run.bodies.forEach((body, k) => {
      if (this.show.hidden.has(k)) return;
      for (let f = body.facets[0]; f < body.facets[0] + body.facets[1]; f++) {
        const nodes = run.facets.subarray(4 * f, 4 * f + 4);
        const [a, b, c, d] = Array.from(nodes, (node) => places[node]);
        const distance = hit(from, along, a, b, c) ?? hit(from, along, a, c, d);
        if (distance === null || distance >= best.distance) continue;
        const place = add(from, scaled(along, distance));
        if (dot([nx, ny, nz], place) > offset) continue;
        const far = (node) => size(subtract(places[node], place));
        best = { distance, body: k, node: nodes.reduce((near, node) => (far(node) < far(near) ? node : near)) };
      }
      const ends = run.segments.subarray(2 * body.segments[0], 2 * (body.segments[0] + body.segments[1]));
      for (const node of [...ends, ...run.points.subarray(body.points[0], body.points[0] + body.points[1])]) {
        const seen = this.project(places[node]);
        const distance = dot(subtract(from, places[node]), eye);
        if (seen && Math.hypot(seen[0] - x, seen[1] - y) < 9 && distance < best.distance) best = { distance, body: k, node };
      }
    });
    return best.node === undefined ? null : { body: best.body, node: best.node };
  }
}

/** Whether WebGL is drawn by the processor, for which smooth edges double the cost of a frame. */
function isSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const more = gl.getParameter(gl.RENDERER) === 'WebKit WebGL' && gl.getExtension('WEBGL_debug_renderer_info');
  const name = gl.getParameter(more ? more.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  return /swiftshader|llvmpipe|software/i.test(name);
}

function programOf(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

/** Two triangles a facet; the second one of a triangle is empty. */
function trianglesOf(facets) {
  const out = new Uint32Array((facets.length / 4) * 6);
  for (let f = 0; f < facets.length / 4; f++) {
    const [a, b, c, d] = facets.subarray(4 * f, 4 * f + 4);
    out.set([a, b, c, a, c, d], 6 * f);
  }
  return out;
}

/** Sides of a body's facets that are edges of elements, each once: all of them, and those with one facet only or with an angle above 30 degrees in the reference configuration. */
function sidesOf(run, body) {
  const normals = new Map();
  for (let f = body.facets[0]; f < body.facets[0] + body.facets[1]; f++) {
    const nodes = run.facets.subarray(4 * f, 4 * f + 4);
    const [a, b, c, d] = Array.from(nodes, (node) => placeOf(run, 0, node));
    const normal = cross(subtract(c, a), subtract(d, b));
    for (let k = 0; k < 4; k++) {
      const [p, q] = [nodes[k], nodes[(k + 1) % 4]];
      if (p === q || !((run.sides[f] >> k) & 1)) continue;
      const key = p < q ? p * run.nodes + q : q * run.nodes + p;
      const found = normals.get(key);
      if (found) found.push(normal);
      else normals.set(key, [normal]);
    }
  }
  const isSharp = ([a, b]) => !b || dot(a, b) < Math.cos(Math.PI / 6) * size(a) * size(b);
  const ends = (key) => [Math.floor(key / run.nodes), key % run.nodes];
  const segments = Array.from(run.segments.subarray(2 * body.segments[0], 2 * (body.segments[0] + body.segments[1])));
  const sharp = [...normals].filter(([, found]) => isSharp(found)).flatMap(([key]) => ends(key));
  return { all: [...normals.keys()].flatMap(ends), sharp: sharp.concat(segments) };
}
