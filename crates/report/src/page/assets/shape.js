'use strict';
// Places of nodes, and what is drawn between them.

/** Position of a node in the reference configuration. */
function referenceOf(animation, node) {
  return [0, 1, 2].map((a) => animation.corner[a] + (animation.reference[3 * node + a] / 65535) * animation.edges[a]);
}

/** Displacement of a node in a frame. */
function movedOf(animation, frame, node) {
  const k = 3 * (frame * animation.nodes + node);
  return [0, 1, 2].map((a) => (animation.displacement[k + a] / 32767) * animation.largest[a]);
}

/** The box `[low, high]` of all positions of the run with displacements times a factor. */
function boxOf(animation, factor) {
  const { nodes, reference, displacement, corner, edges, largest } = animation;
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  const take = (axis, place) => {
    if (place < low[axis]) low[axis] = place;
    if (place > high[axis]) high[axis] = place;
  };
  for (let k = 0; k < displacement.length; k++) {
    const axis = k % 3;
    const place = corner[axis] + (reference[k % (3 * nodes)] / 65535) * edges[axis];
    take(axis, place);
    take(axis, place + (factor * largest[axis] * displacement[k]) / 32767);
  }
  return [low, high];
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

/** Nodes on the surface of a body, on its lines and its points, each once. */
function outerNodes(animation, body) {
  const part = (list, [first, count], stride) => list.subarray(stride * first, stride * (first + count));
  const { facets, segments, points } = animation;
  return Uint32Array.from(new Set([...part(facets, body.facets, 4), ...part(segments, body.segments, 2), ...part(points, body.points, 1)]));
}

/** All nodes of a body, each once. */
function nodesOf(animation, body) {
  const [first, count] = body.elements;
  return Uint32Array.from(new Set([...outerNodes(animation, body), ...animation.elements.subarray(8 * first, 8 * (first + count))]));
}

/** Sides of a body's facets that are edges of elements, each once: all of them, and those with one facet only or with an angle above 30 degrees in the reference configuration. */
function sidesOf(run, body) {
  const normals = new Map();
  for (let f = body.facets[0]; f < body.facets[0] + body.facets[1]; f++) {
    const nodes = run.facets.subarray(4 * f, 4 * f + 4);
    const [a, b, c, d] = Array.from(nodes, (node) => referenceOf(run, node));
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
