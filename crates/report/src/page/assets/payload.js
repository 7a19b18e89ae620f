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
    for (const name of ['facets', 'sides', 'segments', 'points', 'elements', 'numbers']) {
      animation[name] = new Uint32Array(at(animation[name]).slice().buffer);
    }
    const vectors = (place) => interleaved(decode(at(place), 3 * animation.nodes), animation.nodes);
    animation.reference = vectors(animation.reference);
    animation.displacement = new Int16Array(vectors(animation.displacement).buffer);
    for (const { components } of animation.arrays) {
      for (const component of components) component.codes = decode(at(component.stream), animation.nodes);
    }
    animation.arrays = animation.arrays.map(readable);
    animation.fields = fieldsOf(animation, unitOf(run, 'length'));
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
