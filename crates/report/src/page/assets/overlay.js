'use strict';
// What is drawn over the picture: axes, colour bar, the smallest and the largest value, what is picked.

const INK = '#1f2733';
const FONT = '11px system-ui, sans-serif';
/** Size of the colour bar, its distance from the right side of the picture, and the width of its name. */
const BAR = { width: 14, height: 180, top: 14, right: 84, room: 190 };

class Overlay {
  constructor(app, canvas) {
    Object.assign(this, { app, canvas });
  }

  draw() {
    const { canvas, app } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    this.pen = canvas.getContext('2d');
    Object.assign(this, { width, height, taken: [] });
    this.pen.scale(ratio, ratio);
    this.axes();
    this.bar();
    const { viewer } = app;
    if (viewer.show.arrows) this.arrowScale(viewer.show.arrows);
    if (byId('extremes').checked && viewer.field()) this.extremes();
    viewer.layers?.names(this);
    app.path?.draw(this);
    if (app.picked) this.ring(viewer.place(app.picked.node), '#2f6db3', 6);
    if (app.place) this.ring(app.place, '#c0392b', 12);
  }

  axes() {
    const { pen, height } = this;
    const { right, up } = this.app.viewer.camera.axes();
    pen.font = FONT;
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    ['x', 'y', 'z'].forEach((name, k) => {
      const [x, y] = [44 + 26 * right[k], height - 44 - 26 * up[k]];
      pen.strokeStyle = pen.fillStyle = ['#c8553d', '#4f9a5b', '#2f6db3'][k];
      pen.lineWidth = 1.6;
      line(pen, [[44, height - 44], [x, y]]);
      pen.fillText(name, 44 + 36 * right[k], height - 44 - 36 * up[k]);
    });
  }

  /** The colours and their numbers; beyond the ends of the bar the values that there are. */
  bar() {
    const { viewer, run } = this.app;
    const field = viewer.field();
    if (!field) return;
    const { pen } = this;
    const [low, high] = viewer.range();
    const number = (value) => (Math.abs(value) < 1e-9 * (high - low) ? '0' : text(Number(value.toPrecision(3))));
    const left = this.width - BAR.right;
    const words = wrapped(pen, withUnit(field.label, field.unit), BAR.room - 24);
    const top = BAR.top + 15 * words.length + 4;
    pen.fillStyle = '#ffffffb0';
    const wide = Math.max(BAR.right, ...words.map((part) => pen.measureText(part).width + 14));
    pen.fillRect(this.width - wide - 6, 6, wide, top - 6);
    pen.fillRect(left - 6, top, BAR.right, BAR.height + 10);
    pen.fillStyle = INK;
    pen.textAlign = 'right';
    pen.textBaseline = 'top';
    pen.font = `600 ${FONT}`;
    words.forEach((part, k) => pen.fillText(part, this.width - 14, BAR.top + 15 * k));
    pen.font = FONT;
    for (let k = 0; k < BAR.height; k++) {
      pen.fillStyle = `rgb(${mapColour(1 - k / BAR.height).join(' ')})`;
      pen.fillRect(left, top + k, BAR.width, 1);
    }
    // Of a state only whole numbers have a meaning.
    const states = Math.floor(high) - Math.ceil(low) + 1;
    const parts = field.array.isWhole && states > 1 ? [...Array(states).keys()].map((k) => k / (states - 1)) : [0, 0.25, 0.5, 0.75, 1];
    pen.fillStyle = INK;
    pen.textAlign = 'left';
    pen.textBaseline = 'middle';
    for (const part of parts) pen.fillText(number(high - part * (high - low)), left + BAR.width + 6, top + part * BAR.height);
    const [least, most] = rangeOf(field, run.animation);
    const beyond = [];
    if (most > high * (1 + 1e-6)) beyond.push(`up to ${number(most)} in the run`);
    if (least < low - 1e-6 * Math.abs(low)) beyond.push(`down to ${number(least)} in the run`);
    pen.textAlign = 'right';
    pen.fillStyle = '#5b6472';
    beyond.forEach((words, k) => pen.fillText(words, this.width - 14, top + BAR.height + 16 + 14 * k));
  }

  arrowScale(kind) {
    const { pen } = this;
    const value = text(longestOf(this.app.run.animation, kind));
    pen.font = FONT;
    pen.textAlign = 'left';
    pen.textBaseline = 'middle';
    pen.fillStyle = '#214d8c';
    pen.fillText(`arrows: ${kind.label}, the longest ${value}${after(kind.unit)}`, 84, this.height - 50);
  }

  extremes() {
    const found = this.app.viewer.extremes();
    if (!found) return;
    const [low, high] = found;
    this.mark(high, `max ${text(high.value)}`, '#8e1b45');
    if (low.node !== high.node) this.mark(low, `min ${text(low.value)}`, '#2f6db3');
  }

  /** A cross with words at a node. */
  mark({ node }, words, colour) {
    const seen = this.app.viewer.project(this.app.viewer.place(node));
    if (!seen) return;
    const { pen } = this;
    const [x, y] = seen;
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    line(pen, [[x - 5, y], [x + 5, y]]);
    line(pen, [[x, y - 5], [x, y + 5]]);
    this.words(words, x, y, colour);
  }

  /** Words at a place. */
  label(place, words, colour) {
    const seen = this.app.viewer.project(place);
    if (seen) this.words(words, ...seen, colour);
  }

  /** Words beside a point of the picture, moved down from others that are there. */
  words(words, x, y, colour) {
    const { pen } = this;
    pen.font = `600 ${FONT}`;
    const wide = pen.measureText(words).width + 8;
    const left = Math.max(4, Math.min(x + 9, this.width - wide - 4));
    let top = Math.max(4, Math.min(y - 20, this.height - 22));
    while (this.taken.some((box) => left < box.left + box.wide && box.left < left + wide && Math.abs(top - box.top) < 18)) top += 18;
    this.taken.push({ left, wide, top });
    pen.fillStyle = '#ffffffe0';
    pen.fillRect(left, top, wide, 16);
    pen.fillStyle = colour;
    pen.textAlign = 'left';
    pen.textBaseline = 'middle';
    pen.fillText(words, left + 4, top + 8);
  }

  ring(place, colour, radius) {
    const seen = this.app.viewer.project(place);
    if (!seen) return;
    const { pen } = this;
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.arc(seen[0], seen[1], radius, 0, 2 * Math.PI);
    pen.stroke();
  }
}

/** Words in lines that are not wider than so many pixels. */
function wrapped(pen, words, wide) {
  pen.font = `600 ${FONT}`;
  const lines = [''];
  for (const word of words.split(' ')) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (pen.measureText(longer).width <= wide) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines.filter(Boolean);
}
