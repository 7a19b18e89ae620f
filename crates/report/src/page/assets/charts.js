'use strict';
// Charts over the time of the run or over another column: lines, an axis on each side, a cursor at the time that the animation shows.

const COLOURS = ['#2f6db3', '#c8553d', '#4f9a5b', '#8a5aa8', '#b8860b', '#3f8f93', '#94565a', '#6b7280'];
/** Colour of a run of several: cases of a sweep, and runs that are many, go through the colour map. */
function runColour(run, count) {
  if (count <= COLOURS.length && !document.getElementById('sweep')) return COLOURS[run % COLOURS.length];
  return `rgb(${mapColour(count > 1 ? 0.4 + (0.6 * run) / (count - 1) : 1).join(' ')})`;
}

/** Dashes that tell the columns of compared runs apart, and how the legend shows them. */
const DASHES = { '': 'solid', '6,3': 'dashed', '2,2': 'dotted', '8,3,2,3': 'double', '1,3': 'dotted' };
const MARGIN = { left: 62, right: 10, top: 8, bottom: 20 };

/** A number with four digits, short. */
function text(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return '-';
  if (value === 0) return '0';
  const magnitude = Math.abs(value);
  if (magnitude >= 1e5 || magnitude < 1e-3) return value.toExponential(3).replace(/\.?0+e/, 'e').replace('e+', 'e');
  return String(Number(value.toPrecision(4)));
}

/** Round numbers between two ends, about so many. */
function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((n) => n * power >= raw) ?? 10);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) out.push(k * step);
  return out;
}

/** Last place in an ascending list with an entry not above the value; -1 before the first. */
function placeIn(list, value) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/**
 * A chart.
 *
 * `unit`: that of the time. `least`: length that the vertical axis has at least, so that round-off looks like what it is.
 * `series`: lists of `{ name, x, y, colour, dash }`, gaps where `y` is null. `marks`: `{ x, text, colour }`, short lines at the bottom whose text is shown
 * when the pointer is near. `over`: what the horizontal axis has, if not the time; a series may then say by `times` when each point was, and the cursor follows the time all the same.
 * Lines with `hasDots` show their points. `seek(time)` is called for a click. A drag shows a part of the axis, a double click all of it.
 */
class Chart {
  constructor(parent, { title, series, isLog = false, marks = [], least = 0, unit = '', over = null }, seek) {
    Object.assign(this, { title, series, isLog, marks, least, unit, over, seek, hidden: new Set(), span: null });
    this.box = element('figure', { className: 'chart' });
    this.legend = element('figcaption', {}, [element('b', { textContent: isLog ? `${title} (log)` : title })]);
    this.canvas = element('canvas');
    this.cursor = element('div', { className: 'cursor' });
    this.selection = element('div', { className: 'selection' });
    const plot = element('div', { className: 'plot' }, [this.canvas, this.selection, this.cursor]);
    this.labels = [...new Set(series.map(({ name }) => name))].map((name) => this.label(name));
    this.legend.append(...this.labels.map((label) => label.button));
    this.note = element('span', { className: 'note' });
    const save = element('button', { type: 'button', className: 'csv', textContent: 'CSV', title: 'save the numbers of this chart' });
    save.onclick = () => download(`${fileName(this.title)}.csv`, new Blob([csvOf(this)], { type: 'text/csv' }));
    this.legend.append(save, this.note);
    this.box.append(this.legend, plot);
    parent.append(this.box);
    this.listen(plot);
  }

  /** A button with the value of each series of that name: runs that are compared share it. */
  label(name) {
    const series = this.series.filter((line) => line.name === name);
    const swatch = element('i');
    swatch.style.borderTop = `2px ${DASHES[series[0].dash?.join() ?? ''] ?? 'solid'} ${series.length > 1 ? '#5b6472' : series[0].colour}`;
    const values = series.map(({ colour }) => element('output', { hidden: series.length > COLOURS.length, style: series.length > 1 ? `color: ${colour}` : '' }));
    const button = element('button', { type: 'button', title: 'show or hide' }, [swatch, name, ...values]);
    button.onclick = () => {
      if (!this.hidden.delete(name)) this.hidden.add(name);
      button.classList.toggle('off', this.hidden.has(name));
      this.draw();
    };
    return { button, series, values };
  }

  listen(plot) {
    let start = null;
    const at = (event) => event.clientX - plot.getBoundingClientRect().left;
    plot.onpointerdown = (event) => {
      start = at(event);
      plot.setPointerCapture(event.pointerId);
    };
    plot.onpointermove = (event) => {
      this.tell(this.follows() ? this.timeAt(at(event)) : this.placeAt(at(event)), at(event));
      if (start === null) return;
      const [a, b] = [start, at(event)].sort((p, q) => p - q);
      Object.assign(this.selection.style, { left: `${a}px`, width: `${b - a}px` });
    };
    plot.onpointerup = (event) => {
      const [a, b] = [start ?? at(event), at(event)].sort((p, q) => p - q);
      start = null;
      this.selection.style.width = '0';
      if (b - a < 5) this.seek(this.timeAt(b));
      else this.zoom([this.placeAt(a), this.placeAt(b)]);
    };
    plot.onpointerleave = () => {
      if (this.time !== undefined) this.tell(this.time, null);
    };
    plot.ondblclick = () => this.zoom(null);
  }

  zoom(span) {
    this.span = span;
    this.draw();
  }

  /** Series that are shown. */
  lines() {
    return this.series.filter(({ name }) => !this.hidden.has(name));
  }

  /** Ends of both axes. */
  ends() {
    const limits = ({ x, times }) => (times ? endsOf(x.filter((value) => value !== null)) : [x[0], x[x.length - 1]]);
    let [left, right] = this.span ?? this.series.map(limits).reduce(([a, b], [first, last]) => [Math.min(a, first), Math.max(b, last)], [Infinity, -Infinity]);
    if (this.over && !this.span) {
      // Room for the dots at the ends.
      const room = 0.03 * (right - left) || 1;
      [left, right] = [left - room, right + room];
    }
    let [low, high] = [Infinity, -Infinity];
    for (const { x, y } of this.lines()) {
      for (let k = 0; k < x.length; k++) {
        if (x[k] < left || x[k] > right || y[k] === null || (this.isLog && y[k] <= 0)) continue;
        low = Math.min(low, y[k]);
        high = Math.max(high, y[k]);
      }
    }
    if (low > high) [low, high] = this.isLog ? [1, 10] : [0, 1];
    if (this.isLog) [low, high] = [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high * 1.0001))];
    else {
      // A number that only has round-off is drawn as a straight line.
      const room = Math.max(0.05 * (high - low), 0.5 * (this.least - (high - low)), 1e-12 * Math.max(Math.abs(low), Math.abs(high)), 1e-300);
      [low, high] = [low - room, high + room];
    }
    return { left, right: right > left ? right : left + 1, low, high };
  }

  /** Place on the horizontal axis. */
  placeAt(pixel) {
    const { left, right } = this.ends();
    const width = this.canvas.clientWidth - MARGIN.left - MARGIN.right;
    return Math.min(Math.max(left + ((pixel - MARGIN.left) / width) * (right - left), left), right);
  }

  /** The time of what is drawn there: of the nearest point where the axis has something else. */
  timeAt(pixel) {
    const place = this.placeAt(pixel);
    const line = this.series.find(({ times }) => times);
    if (!line) return place;
    const away = (k) => (line.x[k] === null ? Infinity : Math.abs(line.x[k] - place));
    return line.times.reduce((best, time, k) => (away(k) < away(best.k) ? { time, k } : best), { time: line.times[0], k: 0 }).time;
  }

  /** Whether the cursor follows the time. */
  follows() {
    return !this.over || this.series.some(({ times }) => times);
  }

  draw() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !this.series.length) return;
    Object.assign(this.canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const pen = this.canvas.getContext('2d');
    pen.scale(ratio, ratio);
    const { left, right, low, high } = this.ends();
    const up = this.isLog ? Math.log10 : (value) => value;
    const X = (x) => MARGIN.left + ((x - left) / (right - left)) * (width - MARGIN.left - MARGIN.right);
    const Y = (y) => height - MARGIN.bottom - ((up(y) - up(low)) / (up(high) - up(low))) * (height - MARGIN.top - MARGIN.bottom);
    this.toX = X;
    this.drawAxes(pen, { left, right, low, high, X, Y, width, height });
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, 0, width - MARGIN.left - MARGIN.right, height - MARGIN.bottom + 1);
    pen.clip();
    for (const { x, colour } of this.marks) {
      pen.strokeStyle = colour;
      line(pen, [[X(x), height - MARGIN.bottom], [X(x), height - MARGIN.bottom - 14]]);
    }
    for (const { x, y, colour, dash, hasDots } of this.lines()) {
      pen.strokeStyle = pen.fillStyle = colour;
      pen.lineWidth = 1.4;
      pen.setLineDash(dash ?? []);
      pen.beginPath();
      let isUp = true;
      for (let k = 0; k < x.length; k++) {
        if (x[k] === null || y[k] === null || (this.isLog && y[k] <= 0)) isUp = true;
        else {
          if (isUp) pen.moveTo(X(x[k]), Y(y[k]));
          else pen.lineTo(X(x[k]), Y(y[k]));
          isUp = false;
        }
      }
      pen.stroke();
      for (let k = 0; hasDots && k < x.length; k++) {
        if (y[k] === null || (this.isLog && y[k] <= 0)) continue;
        pen.beginPath();
        pen.arc(X(x[k]), Y(y[k]), 3, 0, 2 * Math.PI);
        pen.fill();
      }
    }
    pen.restore();
    if (this.follows() || this.time !== undefined) this.setTime(this.time ?? left);
  }

  drawAxes(pen, { left, right, low, high, X, Y, width, height }) {
    pen.font = '11px system-ui, sans-serif';
    pen.fillStyle = '#5b6472';
    pen.strokeStyle = '#e6e9ee';
    pen.lineWidth = 1;
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    for (const y of this.isLog ? powers(low, high) : ticks(low, high, 4)) {
      line(pen, [[MARGIN.left, Y(y)], [width - MARGIN.right, Y(y)]]);
      pen.fillText(this.isLog ? `1e${Math.round(Math.log10(y))}` : tickText(y, high - low), MARGIN.left - 6, Y(y));
    }
    pen.textAlign = 'center';
    pen.textBaseline = 'top';
    const times = ticks(left, right, Math.max(2, width / 90));
    for (const x of times) {
      line(pen, [[X(x), height - MARGIN.bottom], [X(x), height - MARGIN.bottom + 4]]);
      const unit = this.unit && x === times[times.length - 1] ? ` ${this.unit}` : '';
      pen.fillText(tickText(x, right - left) + unit, X(x), height - MARGIN.bottom + 6);
    }
  }

  /** Moves the cursor. */
  setTime(time) {
    this.time = time;
    if (!this.toX) return;
    const line = this.series.find(({ times }) => times);
    const x = this.toX(line ? line.x[Math.max(placeIn(line.times, time * (1 + 1e-12)), 0)] : time);
    const isInside = x >= MARGIN.left - 1 && x <= this.canvas.clientWidth - MARGIN.right + 1;
    this.cursor.style.display = isInside ? 'block' : 'none';
    this.cursor.style.transform = `translateX(${x}px)`;
    this.tell(time, null);
  }

  /** Writes the values at a time beside the names, and the mark that is near the pointer. */
  tell(time, pixel) {
    for (const { series, values } of this.labels) {
      series.forEach(({ x, y, times }, k) => {
        const place = placeIn(times ?? x, time * (1 + 1e-12));
        values[k].textContent = place < 0 ? '-' : text(y[place]);
      });
    }
    const near = (mark) => Math.abs(this.toX(mark.x) - pixel);
    const mark = pixel === null || !this.marks.length ? null : this.marks.reduce((a, b) => (near(b) < near(a) ? b : a));
    this.note.textContent = mark && near(mark) < 6 ? mark.text : '';
  }
}

function line(pen, points) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
}

/** Powers of ten, six at most. */
function powers(low, high) {
  const [a, b] = [low, high].map((value) => Math.round(Math.log10(value)));
  const step = Math.max(1, Math.ceil((b - a) / 5));
  const out = [];
  for (let k = a; k <= b; k += step) out.push(10 ** k);
  return out;
}

/** A number on an axis with as many digits as tell it from its neighbours. */
function tickText(value, span) {
  if (Math.abs(value) < 1e-9 * span) return '0';
  const magnitude = Math.abs(value);
  const digits = Math.min(12, Math.max(1, Math.ceil(Math.log10(magnitude / span) + 2)));
  if (magnitude >= 1e5 || magnitude < 1e-3) return value.toExponential(digits - 1).replace(/\.?0+e/, 'e').replace('e+', 'e');
  return String(Number(value.toPrecision(digits)));
}

/** An element with properties and children. */
function element(name, properties = {}, children = []) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}
