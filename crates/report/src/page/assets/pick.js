'use strict';
// Which node is seen at a place of the picture.

/** Distance along a ray to a triangle; nothing if it is missed (Moeller and Trumbore, J. Graphics Tools 2, 1997, 21). */
function hit(from, along, a, b, c) {
  const [u, v] = [subtract(b, a), subtract(c, a)];
  const p = cross(along, v);
  const volume = dot(u, p);
  if (volume === 0) return null;
  const t = subtract(from, a);
  const first = dot(t, p) / volume;
  const q = cross(t, u);
  const second = dot(along, q) / volume;
  if (first < 0 || second < 0 || first + second > 1) return null;
  const distance = dot(v, q) / volume;
  return distance > 0 ? distance : null;
}

/** Body and node that a viewer shows at a place of its picture (pixels of the page), in the original or a copy; nothing where there is none. */
function pickIn(viewer, x, y) {
  const { camera } = viewer;
  const { right, up, eye } = camera.axes();
  const [width, height] = [viewer.canvas.clientWidth, viewer.canvas.clientHeight];
  const { projection } = viewer.matrices();
  const from = add(camera.target, scaled(eye, camera.distance));
  const side = add(scaled(right, ((2 * x) / width - 1) / projection[0]), scaled(up, (1 - (2 * y) / height) / projection[5]));
  const ray = { from, along: subtract(side, eye), eye, x, y };
  const found = viewer.copies.map((copy) => pickInCopy(viewer, copy, ray)).reduce((a, b) => (b.distance < a.distance ? b : a));
  return found.node === undefined ? null : { body: found.body, node: found.node };
}

function pickInCopy(viewer, copy, { from, along, eye, x, y }) {
  const { run } = viewer;
  const places = viewer.places();
  const at = (node) => placed(copy, [places[3 * node], places[3 * node + 1], places[3 * node + 2]]);
  const [nx, ny, nz, offset] = viewer.clip();
  let best = { distance: Infinity };
  run.bodies.forEach((body, k) => {
    if (viewer.show.hidden.has(k)) return;
    for (let f = body.facets[0]; f < body.facets[0] + body.facets[1]; f++) {
      const nodes = run.facets.subarray(4 * f, 4 * f + 4);
      const corners = Array.from(nodes, at);
      const [a, b, c, d] = corners;
      const distance = hit(from, along, a, b, c) ?? hit(from, along, a, c, d);
      if (distance === null || distance >= best.distance) continue;
      const place = add(from, scaled(along, distance));
      if (dot([nx, ny, nz], place) > offset) continue;
      const far = (corner) => size(subtract(corners[corner], place));
      const near = [0, 1, 2, 3].reduce((one, other) => (far(other) < far(one) ? other : one));
      best = { distance, body: k, node: nodes[near] };
    }
    const ends = run.segments.subarray(2 * body.segments[0], 2 * (body.segments[0] + body.segments[1]));
    for (const node of [...ends, ...run.points.subarray(body.points[0], body.points[0] + body.points[1])]) {
      const place = at(node);
      const seen = viewer.project(place);
      const distance = dot(subtract(from, place), eye);
      if (seen && Math.hypot(seen[0] - x, seen[1] - y) < 9 && distance < best.distance) best = { distance, body: k, node };
    }
  });
  return best;
}
