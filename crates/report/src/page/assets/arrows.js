'use strict';
// Arrows at nodes: vectors that the frames have, and the contact pressure along the normal of the surface.

/** Longest arrow, in parts of the size of what is shown. */
const LONGEST = 0.22;
/** An arrow of length one along the first axis: a shaft of two triangles and a head. */
const SHAPE = [[0, -0.02], [0.72, -0.02], [0.72, 0.02], [0, -0.02], [0.72, 0.02], [0, 0.02], [0.72, -0.09], [1, 0], [0.72, 0.09]];
/** Arrows that are drawn at most; beyond, nodes are left out evenly. */
const MANY = 4000;

/** What can be shown by arrows: `{ label, unit, array }`, vectors and contact pressures. */
function arrowsOf(animation) {
  const of = (array) => animation.fields.find((field) => field.array === array);
  const isVector = ({ read, name }) => read.length === 3 && name !== 'principal_stresses';
  const shown = animation.arrays.filter((array) => isVector(array) || array.name === 'contact_pressure');
  return shown.map((array) => ({ label: array.label, unit: of(array).unit, array }));
}

/** The size that the longest arrow shows: that of the run, without what rims have. */
function longestOf(animation, { array }) {
  const field = animation.fields.find((found) => found.array === array && found.part.kind === 'size');
  return typicalRange(field, animation)[1];
}

/** Sums of the facets' normals at each node, of any length, pointing out of the body. */
function normalsAt(run, places, shown) {
  const normals = new Float32Array(3 * run.nodes);
  for (const { facets: [first, count] } of shown) {
    for (let f = first; f < first + count; f++) {
      const [a, b, c, d] = run.facets.subarray(4 * f, 4 * f + 4);
      const along = (p, q, k) => places[3 * q + k] - places[3 * p + k];
      for (let k = 0; k < 3; k++) {
        const [i, j] = [(k + 1) % 3, (k + 2) % 3];
        const normal = along(a, c, i) * along(b, d, j) - along(a, c, j) * along(b, d, i);
        for (const node of [a, b, c]) normals[3 * node + k] += normal;
        if (d !== c) normals[3 * d + k] += normal;
      }
    }
  }
  return normals;
}

/** Tails and ways (six numbers an arrow) of what is shown at this moment, in a space of this size. */
function arrowsAt(viewer, kind, extent) {
  const { run } = viewer;
  const { frame, next, part } = viewer.moment();
  const shown = run.bodies.filter((_, k) => !viewer.show.hidden.has(k));
  const places = viewer.places();
  const isNormal = kind.array.read.length === 1;
  const normals = isNormal ? normalsAt(run, places, shown) : null;
  const longest = longestOf(run, kind);
  const factor = longest > 0 ? (LONGEST * extent) / longest : 0;
  const now = (read, node) => {
    const [a, b] = [read(frame * run.nodes + node), read(next * run.nodes + node)];
    return a + part * (b - a);
  };
  const nodes = shown.map((body) => viewer.outer[run.bodies.indexOf(body)]);
  const every = Math.ceil(nodes.reduce((sum, list) => sum + list.length, 0) / MANY);
  const out = [];
  for (const list of nodes) {
    for (let n = 0; n < list.length; n += every) {
      const node = list[n];
      const tail = places.subarray(3 * node, 3 * node + 3);
      if (isNormal) {
        const pressure = Math.min(now(kind.array.read[0], node), longest);
        const normal = normals.subarray(3 * node, 3 * node + 3);
        const length = (factor * pressure) / Math.max(size(normal), 1e-300);
        // The tip is on the surface: a pressure acts on it from outside.
        if (pressure > 0) out.push(...[0, 1, 2].map((k) => tail[k] + length * normal[k]), ...[0, 1, 2].map((k) => -length * normal[k]));
      } else {
        const way = kind.array.read.map((read) => factor * now(read, node));
        if (size(way) > 1e-3 * LONGEST * extent) out.push(...tail, ...way);
      }
    }
  }
  return Float32Array.from(out);
}
