'use strict';
// Mirrored and turned copies of what was computed, for models of a half, a quarter or a sector. A copy is a 4 x 4 matrix, column after column.

const IDENTITY = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);

/** The reflection at a plane across an axis. */
function mirror(axis, place) {
  const out = IDENTITY.slice();
  out[5 * axis] = -1;
  out[12 + axis] = 2 * place;
  return out;
}

/** The rotation by an angle (radians) about an axis through the origin. */
function turned(axis, angle) {
  const out = IDENTITY.slice();
  const [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
  out[5 * a] = out[5 * b] = Math.cos(angle);
  out[4 * a + b] = Math.sin(angle);
  out[4 * b + a] = -Math.sin(angle);
  return out;
}

/** All copies with the original first: `mirrors` has the place of the plane across each axis or null, `count` sectors fill the circle about an axis. */
function copiesOf({ mirrors, count, axis }) {
  let copies = [IDENTITY];
  mirrors.forEach((place, k) => {
    if (place !== null) copies = copies.concat(copies.map((copy) => product(mirror(k, place), copy)));
  });
  const sectors = Array.from({ length: Math.max(1, count) }, (_, k) => turned(axis, (2 * Math.PI * k) / count));
  return sectors.flatMap((sector, k) => (k ? copies.map((copy) => product(sector, copy)) : copies));
}

/** A place, and a direction, in a copy. */
const placed = (m, a) => [0, 1, 2].map((k) => m[k] * a[0] + m[4 + k] * a[1] + m[8 + k] * a[2] + m[12 + k]);
/** A direction of the space in that of the original. */
const drawnBack = (m, a) => [0, 1, 2].map((k) => m[4 * k] * a[0] + m[4 * k + 1] * a[1] + m[4 * k + 2] * a[2]);

/** The plane `normal . x = offset` of the space, as the original of a copy sees it. */
function planeBack(m, [x, y, z, offset]) {
  return [...drawnBack(m, [x, y, z]), offset - (m[12] * x + m[13] * y + m[14] * z)];
}

/** The box around the copies of a box `[low, high]`. */
function boxOfCopies(copies, [low, high]) {
  const corners = copies.flatMap((copy) => Array.from({ length: 8 }, (_, k) => placed(copy, low.map((value, axis) => ((k >> axis) & 1 ? high[axis] : value)))));
  return [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => pick(...corners.map((corner) => corner[axis]))));
}
