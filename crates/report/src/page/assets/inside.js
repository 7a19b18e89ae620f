'use strict';
// What is inside of bodies: the cut of a plane and the profile along a line. Elements are divided into tetrahedra, in which a field is linear.

/** Tetrahedra about the diagonal of a hexahedron; other elements are hexahedra with corners that coincide, whose flat tetrahedra are left out. */
const TETRAHEDRA = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
const FACES = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
/** Rounding of places, in parts of a tetrahedron. */
const SLIGHTLY = 1e-5;

const isFlat = ([a, b, c, d]) => a === b || a === c || a === d || b === c || b === d || c === d;

/** Numbers that are appended: `x y z value` of each vertex. */
class Vertices {
  constructor() {
    this.data = new Float32Array(4096);
    this.length = 0;
  }

  push(x, y, z, value) {
    if (this.length + 4 > this.data.length) {
      const data = new Float32Array(2 * this.data.length);
      data.set(this.data);
      this.data = data;
    }
    this.data[this.length++] = x;
    this.data[this.length++] = y;
    this.data[this.length++] = z;
    this.data[this.length++] = value;
  }

  /** The numbers so far. */
  all() {
    return this.data.subarray(0, this.length);
  }

  get count() {
    return this.length / 4;
  }
}

/** The cut of a plane through these elements (first and number): triangles, and the lines in which it cuts their faces. */
class Cut {
  constructor(animation, places, values) {
    Object.assign(this, { animation, places, values });
    this.heights = new Float32Array(animation.nodes);
    this.triangles = new Vertices();
    this.lines = new Vertices();
  }

  /** Sets the plane `normal . x = offset`. */
  at([nx, ny, nz, offset]) {
    const { heights, places } = this;
    for (let node = 0; node < heights.length; node++) {
      heights[node] = nx * places[3 * node] + ny * places[3 * node + 1] + nz * places[3 * node + 2] - offset;
    }
  }

  through([first, count]) {
    const { elements } = this.animation;
    for (let e = first; e < first + count; e++) {
      const nodes = elements.subarray(8 * e, 8 * e + 8);
      let [isBelow, isAbove] = [false, false];
      for (const node of nodes) {
        if (this.heights[node] < 0) isBelow = true;
        else isAbove = true;
      }
      if (!isBelow || !isAbove) continue;
      for (const tetrahedron of TETRAHEDRA) this.tetrahedron(tetrahedron.map((k) => nodes[k]));
      for (const face of FACES) this.face(face.map((k) => nodes[k]));
    }
  }

  /** Where the plane cuts the line from a node below to one above. */
  crossing(out, below, above) {
    const { places, values, heights } = this;
    const part = heights[below] / (heights[below] - heights[above]);
    const between = (list, stride, k) => list[stride * below + k] + part * (list[stride * above + k] - list[stride * below + k]);
    const value = between(values, 1, 0);
    out.push(between(places, 3, 0), between(places, 3, 1), between(places, 3, 2), Number.isNaN(value) ? NONE : value);
  }

  tetrahedron(nodes) {
    if (isFlat(nodes)) return;
    const below = nodes.filter((node) => this.heights[node] < 0);
    const above = nodes.filter((node) => !(this.heights[node] < 0));
    if (!below.length || !above.length) return;
    const triangle = (pairs) => pairs.forEach(([a, b]) => this.crossing(this.triangles, a, b));
    if (below.length === 2) {
      const [[a, b], [c, d]] = [below, above];
      triangle([[a, c], [a, d], [b, d]]);
      triangle([[a, c], [b, d], [b, c]]);
    } else triangle(below.flatMap((a) => above.map((b) => [a, b])));
  }

  face(nodes) {
    const isBelow = (node) => this.heights[node] < 0;
    const sides = nodes.map((node, k) => [node, nodes[(k + 1) % 4]]).filter(([a, b]) => isBelow(a) !== isBelow(b));
    if (sides.length === 2) sides.forEach(([a, b]) => this.crossing(this.lines, ...(isBelow(a) ? [a, b] : [b, a])));
  }
}

/**
 * A field along the line between two places through elements (first and number): `{ x, y }` with the distance from the first place and the value,
 * null where the line leaves the body. Between two points the field is linear: nothing is sampled.
 */
function profileOf(animation, places, values, [first, count], from, to) {
  const length = size(subtract(to, from));
  const low = [0, 1, 2].map((k) => Math.min(from[k], to[k]));
  const high = [0, 1, 2].map((k) => Math.max(from[k], to[k]));
  const place = (node) => [places[3 * node], places[3 * node + 1], places[3 * node + 2]];
  const pieces = [];
  for (let e = first; e < first + count; e++) {
    const nodes = animation.elements.subarray(8 * e, 8 * e + 8);
    const corners = Array.from(nodes, place);
    const isFar = [0, 1, 2].some((k) => {
      const along = corners.map((corner) => corner[k]);
      const room = SLIGHTLY * (Math.max(...along) - Math.min(...along));
      return Math.max(...along) + room < low[k] || Math.min(...along) - room > high[k];
    });
    if (isFar) continue;
    for (const tetrahedron of TETRAHEDRA) {
      if (isFlat(tetrahedron.map((k) => nodes[k]))) continue;
      const piece = crossed(tetrahedron.map((k) => corners[k]), tetrahedron.map((k) => values[nodes[k]]), from, to);
      if (piece) pieces.push(piece);
    }
  }
  return joined(pieces, length);
}

/** The part of a line in a tetrahedron: `[start, value, end, value]` in parts of the line; nothing if it misses it. */
function crossed([a, b, c, d], values, from, to) {
  const [u, v, w] = [subtract(b, a), subtract(c, a), subtract(d, a)];
  const volume = dot(u, cross(v, w));
  if (volume === 0) return null;
  const weights = (place) => {
    const x = subtract(place, a);
    const [second, third, fourth] = [dot(x, cross(v, w)), dot(x, cross(w, u)), dot(x, cross(u, v))].map((part) => part / volume);
    return [1 - second - third - fourth, second, third, fourth];
  };
  const [start, end] = [weights(from), weights(to)];
  let [t0, t1] = [0, 1];
  for (let k = 0; k < 4; k++) {
    const slope = end[k] - start[k];
    if (Math.abs(slope) < 1e-12) {
      if (start[k] < -SLIGHTLY) return null;
    } else if (slope > 0) t0 = Math.max(t0, (-SLIGHTLY - start[k]) / slope);
    else t1 = Math.min(t1, (-SLIGHTLY - start[k]) / slope);
  }
  if (!(t0 < t1)) return null;
  const value = (t) => values.reduce((sum, known, k) => sum + known * (start[k] + t * (end[k] - start[k])), 0);
  return [t0, value(t0), t1, value(t1)];
}

/** Pieces of a line one after the other; what lies within an earlier one, as from the elements on both sides of the line, is left out. */
function joined(pieces, length) {
  const [x, y] = [[], []];
  let reached = -Infinity;
  for (const [t0, v0, t1, v1] of pieces.sort((p, q) => p[0] - q[0] || q[2] - p[2])) {
    if (t1 <= reached + SLIGHTLY) continue;
    if (reached > -Infinity && t0 > reached + 10 * SLIGHTLY) {
      x.push(length * reached);
      y.push(null);
    }
    const number = (value) => (Number.isFinite(value) ? value : null);
    x.push(length * t0, length * t1);
    y.push(number(v0), number(v1));
    reached = t1;
  }
  return { x, y };
}
