'use strict';
// Unpacks what the page carries of a run. `payload.rs` and `coding.rs` write it and say how it is made.

/** A run: the header with its arrays in place of their positions in the file. */
async function unpack(base64) {
  const packed = bytesOf(base64);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const run = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  const at = (place) => bytes.subarray(4 + length + place.start, 4 + length + place.start + place.bytes);
  const animation = run.animation;
  if (animation) {
    for (const name of ['facets', 'sides', 'segments', 'points', 'numbers']) {
      animation[name] = new Uint32Array(at(animation[name]).slice().buffer);
    }
    animation.positions = interleaved(decode(at(animation.positions), 3 * animation.nodes), animation.nodes);
    for (const field of animation.fields) field.codes = decode(at(field.stream), animation.nodes);
    animation.fields.unshift({ ...displacement(animation), unit: unitOf(run, 'length') });
  }
  return run;
}

/** The unit of what a number measures, if the run has units. */
function unitOf(run, dimension) {
  return run.run?.units?.labels?.[dimension];
}

/** A name with its unit behind it, if there is one. */
function withUnit(name, unit) {
  return unit ? `${name} [${unit}]` : name;
}

/** A unit behind a number. */
function after(unit) {
  return unit ? ` ${unit}` : '';
}

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

/** Codes of a stream: low bytes, high bytes; folded second differences between rows of this length. */
function decode(bytes, row) {
  const count = bytes.length / 2;
  const codes = new Uint16Array(count);
  for (let k = 0; k < count; k++) {
    const folded = bytes[k] | (bytes[count + k] << 8);
    const difference = (folded >> 1) ^ -(folded & 1);
    const last = k < row ? 0 : codes[k - row];
    const earlier = k < 2 * row ? last : codes[k - 2 * row];
    codes[k] = difference + 2 * last - earlier;
  }
  return codes;
}

/** From all x, all y, all z of a row to x y z of each node. */
function interleaved(codes, nodes) {
  const out = new Uint16Array(codes.length);
  for (let start = 0; start < codes.length; start += 3 * nodes) {
    for (let node = 0; node < nodes; node++) {
      for (let axis = 0; axis < 3; axis++) out[start + 3 * node + axis] = codes[start + axis * nodes + node];
    }
  }
  return out;
}

/** Position of a node in a row of positions: row 0 is the reference configuration, row k + 1 frame k. */
function placeOf(animation, row, node) {
  const k = 3 * (row * animation.nodes + node);
  return [0, 1, 2].map((a) => animation.corner[a] + (animation.positions[k + a] / 65535) * animation.edges[a]);
}

/** The size of the displacement as a field, from the positions. */
function displacement(animation) {
  const { nodes, positions, edges } = animation;
  const frames = animation.times.length;
  const values = new Float32Array(nodes * frames);
  let largest = 0;
  for (let k = 0; k < values.length; k++) {
    const node = k % nodes;
    let square = 0;
    for (let a = 0; a < 3; a++) {
      const move = ((positions[3 * (nodes + k) + a] - positions[3 * node + a]) / 65535) * edges[a];
      square += move * move;
    }
    values[k] = Math.sqrt(square);
    largest = Math.max(largest, values[k]);
  }
  return { label: 'displacement', largest, range: [0, largest], values };
}

/** Values of a field, frame after frame; NaN where there is none. They are made when they are first asked for. */
function valuesOf(field) {
  if (!field.values) {
    const value = (code) => {
      if (code === 0) return NaN;
      const signed = code - 2048;
      if (field.largest === null) return signed;
      const root = signed / 2047;
      return field.largest * root * Math.abs(root);
    };
    field.values = Float32Array.from(field.codes, value);
  }
  return field.values;
}
