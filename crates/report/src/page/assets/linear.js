'use strict';
// Vectors of three numbers and 4 x 4 matrices, column after column as WebGL takes them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const size = (a) => Math.hypot(a[0], a[1], a[2]);
const mixed = (a, b, part) => add(scaled(a, 1 - part), scaled(b, part));

function product(a, b) {
  const out = new Float64Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      for (let k = 0; k < 4; k++) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    }
  }
  return out;
}

/** An eye that goes round a target; z points up. */
class Camera {
  constructor() {
    this.target = [0, 0, 0];
    this.radius = 1;
    this.azimuth = -60;
    this.elevation = 22;
    this.distance = 5;
  }

  /** Shows a box from its corner along its edges in a picture of this width over height. */
  show(corner, edges, aspect) {
    const half = scaled(edges, 0.5);
    this.target = add(corner, half);
    this.radius = Math.max(size(half), 1e-12);
    const { right, up, eye } = this.axes();
    const [wide, high] = this.slopes(aspect).map((slope) => 0.9 * slope);
    this.distance = 1.05 * this.radius;
    for (let k = 0; k < 8; k++) {
      const place = half.map((h, axis) => ((k >> axis) & 1 ? h : -h));
      const away = Math.max(Math.abs(dot(place, right)) / wide, Math.abs(dot(place, up)) / high);
      this.distance = Math.max(this.distance, away + dot(place, eye));
    }
  }

  /** Half of the width and of the height of what is seen at distance 1. */
  slopes(aspect) {
    const high = Math.tan((0.5 * Camera.ANGLE * Math.PI) / 180) * Math.max(1, 1 / aspect);
    return [high * aspect, high];
  }

  /** Unit vectors to the right, up and towards the eye. */
  axes() {
    const [a, e] = [this.azimuth, this.elevation].map((angle) => (angle * Math.PI) / 180);
    const [sa, ca, se, ce] = [Math.sin(a), Math.cos(a), Math.sin(e), Math.cos(e)];
    return { right: [-sa, ca, 0], up: [-se * ca, -se * sa, ce], eye: [ce * ca, ce * sa, se] };
  }

  view() {
    const { right, up, eye } = this.axes();
    const from = add(this.target, scaled(eye, this.distance));
    const rows = [right, up, eye];
    const out = new Float64Array(16);
    for (let row = 0; row < 3; row++) {
      for (let column = 0; column < 3; column++) out[4 * column + row] = rows[row][column];
      out[12 + row] = -dot(rows[row], from);
    }
    out[15] = 1;
    return out;
  }

  projection(aspect) {
    const [wide, high] = this.slopes(aspect);
    const far = this.distance + 20 * this.radius;
    const near = Math.max(this.distance - 4 * this.radius, 0.01 * this.distance);
    const out = new Float64Array(16);
    out[0] = 1 / wide;
    out[5] = 1 / high;
    out[10] = (far + near) / (near - far);
    out[11] = -1;
    out[14] = (2 * far * near) / (near - far);
    return out;
  }

  /** Turns by degrees. */
  turn(azimuth, elevation) {
    this.azimuth = (this.azimuth + azimuth) % 360;
    this.elevation = Math.min(90, Math.max(-90, this.elevation + elevation));
  }

  /** Moves the target by parts of the picture's height. */
  pan(x, y) {
    const { right, up } = this.axes();
    const height = 2 * this.distance * Math.tan((0.5 * Camera.ANGLE * Math.PI) / 180);
    this.target = add(this.target, add(scaled(right, -x * height), scaled(up, y * height)));
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 1e-3 * this.radius), 100 * this.radius);
  }
}
/** Degrees of the picture's shorter side. */
Camera.ANGLE = 30;
