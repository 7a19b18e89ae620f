'use strict';
// The programs of the graphics card: bodies, the cut of a plane and arrows are placed by three of them and coloured by one.

/** What all of them begin with. */
const SPACE = `#version 300 es
uniform mat4 view, projection, copy;
out vec3 world, seen;
out float value, known;
`;

/** Bodies: the displacements of two frames are mixed and enlarged. */
const BODY = `${SPACE}
in vec3 reference, before, after;
in float value0, value1;
uniform float part, pointSize, enlarged;
uniform vec3 corner, edges, largest;
uniform vec2 shift;
void main() {
  vec3 moved = largest * mix(before, after, part);
  world = (copy * vec4(corner + edges * reference + enlarged * moved, 1.0)).xyz;
  vec4 place = view * vec4(world, 1.0);
  seen = place.xyz;
  known = float(abs(value0) < 1e37 && abs(value1) < 1e37);
  value = known > 0.5 ? mix(value0, value1, part) : 0.0;
  gl_Position = projection * place;
  gl_Position.xy += shift * gl_Position.w;
  gl_PointSize = pointSize;
}`;

/** Vertices with a place and a value. */
const FREE = `${SPACE}
in vec4 vertex;
uniform float pointSize;
void main() {
  world = (copy * vec4(vertex.xyz, 1.0)).xyz;
  vec4 place = view * vec4(world, 1.0);
  seen = place.xyz;
  known = float(abs(vertex.w) < 1e37);
  value = known > 0.5 ? vertex.w : 0.0;
  gl_Position = projection * place;
  gl_PointSize = pointSize;
}`;

/** Arrows that face the eye: \`corner\` is along and across the arrow in parts of its length. */
const ARROW = `${SPACE}
in vec2 corner;
in vec3 tail, way;
void main() {
  world = (copy * vec4(tail, 1.0)).xyz;
  vec3 start = (view * vec4(world, 1.0)).xyz;
  vec3 along = (view * copy * vec4(way, 0.0)).xyz;
  vec3 side = cross(along, start);
  side *= length(along) / max(length(side), 1e-30);
  seen = start + corner.x * along + corner.y * side;
  value = known = 0.0;
  gl_Position = projection * vec4(seen, 1.0);
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
/** No number, for the graphics card. */
const NONE = 1e38;

/** Colour of the map at a part between 0 and 1, as three numbers up to 255. */
function mapColour(part) {
  const place = Math.min(Math.max(part, 0), 1) * (STOPS.length - 1);
  const low = Math.min(Math.floor(place), STOPS.length - 2);
  return mixed(STOPS[low], STOPS[low + 1], place - low).map(Math.round);
}

/** Makes the texture of the colour map the present one. */
function makeMap(gl) {
  const texels = new Uint8Array(4 * 256);
  for (let k = 0; k < 256; k++) texels.set([...mapColour(k / 255), 255], 4 * k);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  for (const name of ['TEXTURE_WRAP_S', 'TEXTURE_WRAP_T']) gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.CLAMP_TO_EDGE);
  for (const name of ['TEXTURE_MIN_FILTER', 'TEXTURE_MAG_FILTER']) gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.LINEAR);
}

/** A program with the places of its uniforms (`at`) and of its attributes (`takes`). */
function programOf(gl, vertex) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const names = (count, active) => Array.from({ length: gl.getProgramParameter(program, count) }, (_, k) => active(k).name);
  const uniforms = names(gl.ACTIVE_UNIFORMS, (k) => gl.getActiveUniform(program, k));
  const attributes = names(gl.ACTIVE_ATTRIBUTES, (k) => gl.getActiveAttrib(program, k));
  return {
    program,
    at: Object.fromEntries(uniforms.map((name) => [name, gl.getUniformLocation(program, name)])),
    takes: Object.fromEntries(attributes.map((name) => [name, gl.getAttribLocation(program, name)])),
  };
}

/** Whether WebGL is drawn by the processor, for which smooth edges double the cost of a frame. */
function isSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return false;
  const more = gl.getParameter(gl.RENDERER) === 'WebKit WebGL' && gl.getExtension('WEBGL_debug_renderer_info');
  const name = gl.getParameter(more ? more.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  return /swiftshader|llvmpipe|software/i.test(name);
}
