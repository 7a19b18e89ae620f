'use strict';
// Fields: numbers by which bodies are coloured, each made of an array of the frames. `fields.rs` says which there are and what they are called.

/** Share of the values that are not zero beyond which a contact traction may be one of a rim, and how far beyond the value there. */
const RIM = { share: 0.05, factor: 2 };
/** Arrays that are a force over an area, which is next to nothing where a rim just touches. */
const TRACTIONS = ['contact_pressure', 'contact_multiplier', 'friction_traction'];

/** An array whose components can be read at a place of their streams; NaN where there is no value. */
function readable(array) {
  const reader = ({ codes, largest }) => (k) => {
    const code = codes[k];
    if (code === 0) return NaN;
    const signed = code - 2048;
    if (largest === null) return signed;
    const root = signed / 2047;
    return largest * root * Math.abs(root);
  };
  const isWhole = array.components.length === 1 && array.components[0].largest === null;
  return { ...array, isWhole, read: array.components.map(reader) };
}

/** The fields with their arrays, those of the displacement first: it is no array of the payload but what moves the nodes. */
function fieldsOf(animation, length) {
  const moved = (axis) => (k) => (animation.displacement[3 * k + axis] * animation.largest[axis]) / 32767;
  const displacement = { name: 'displacement', label: 'displacement', isWhole: false, read: [0, 1, 2].map(moved) };
  const made = animation.fields.map((field) => ({ ...field, array: animation.arrays[field.array] }));
  const own = ['', ' x', ' y', ' z'].map((end, k) => (
    { label: `displacement${end}`, unit: length, array: displacement, part: k ? { kind: 'component', index: k - 1 } : { kind: 'size' } }));
  animation.arrays.unshift(displacement);
  return [...own, ...made];
}

/** Value of a field at a place of the streams. */
function valueAt({ array: { read }, part: { kind, index } }, k) {
  if (kind === 'component') return read[index](k);
  if (kind === 'size') return read.length === 1 ? read[0](k) : Math.hypot(...read.map((component) => component(k)));
  const row = read.map((component) => component(k));
  if (kind === 'determinant') return determinant(row);
  if (kind === 'pressure') return -(row[0] + row[1] + row[2]) / 3;
  if (kind === 'von_mises') return Math.sqrt(1.5 * deviator(row));
  if (kind === 'equivalent') return Math.sqrt(deviator(row) / 1.5);
  return principal(row)[index];
}

function determinant([a, b, c, d, e, f, g, h, i]) {
  return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
}

/** The square `S:S` of the deviator of the symmetric tensor `xx yy zz xy yz xz`. */
function deviator([xx, yy, zz, xy, yz, xz]) {
  const mean = (xx + yy + zz) / 3;
  const square = (value) => value * value;
  return square(xx - mean) + square(yy - mean) + square(zz - mean) + 2 * (xy * xy + yz * yz + xz * xz);
}

/** Principal values, the largest first, as `fields.rs` finds them. */
function principal([xx, yy, zz, xy, yz, xz]) {
  const mean = (xx + yy + zz) / 3;
  const p = Math.sqrt(deviator([xx, yy, zz, xy, yz, xz]) / 6);
  if (p === 0) return [mean, mean, mean];
  const [a, b, c, d, e, f] = [xx - mean, yy - mean, zz - mean, xy, yz, xz].map((entry) => entry / p);
  const det = a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f);
  const phi = Math.acos(Math.min(Math.max(det / 2, -1), 1)) / 3;
  const [largest, smallest] = [phi, phi + (2 * Math.PI) / 3].map((angle) => mean + 2 * p * Math.cos(angle));
  return [largest, 3 * mean - largest - smallest, smallest];
}

/** Values of a field, frame after frame; NaN where there is none. They are made when they are first asked for. */
function valuesOf(field, animation) {
  if (!field.values) {
    field.values = new Float32Array(animation.nodes * animation.times.length);
    for (let k = 0; k < field.values.length; k++) field.values[k] = valueAt(field, k);
  }
  return field.values;
}

/** Smallest and largest of numbers, without those that are none. */
function endsOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : [0, 0];
}

/** Smallest and largest value of a field in the run. */
function rangeOf(field, animation) {
  field.range ??= endsOf(valuesOf(field, animation));
  return field.range;
}

/** The range without what rims have: the upper end of a contact traction is at most twice the value that a twentieth of its positive values exceeds. */
function typicalRange(field, animation) {
  if (!field.typical) {
    const [low, high] = rangeOf(field, animation);
    const acting = TRACTIONS.includes(field.array.name) ? valuesOf(field, animation).filter((value) => value > 0).sort() : [];
    const most = acting.length ? RIM.factor * acting[Math.floor((1 - RIM.share) * (acting.length - 1))] : Infinity;
    field.typical = [low, Math.min(high, most)];
  }
  return field.typical;
}
