'use strict';
// What is saved: the picture as PNG, the numbers of a chart as CSV.

/** Offers a file to the user. */
function download(name, blob) {
  const link = element('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** A title as the name of a file. */
function fileName(title) {
  return title.replace(/[^\w.=+-]+/g, '-').replace(/^-+|-+$/g, '') || 'stoss';
}

/** A field of a table, in quotes where it needs them. */
function csvField(value) {
  const words = value === null || value === undefined || Number.isNaN(value) ? '' : String(value);
  return /[",\n]/.test(words) ? `"${words.replaceAll('"', '""')}"` : words;
}

/** The numbers of a chart: lines with the same horizontal axis share its column, others have one each. */
function csvOf({ title, series, over }) {
  const columns = [];
  const axes = [];
  for (const { name, x, y, times } of series) {
    const found = axes.some((axis) => axis.length === x.length && axis.every((value, k) => value === x[k]));
    if (!found) {
      axes.push(x);
      if (times) columns.push(['time', times]);
      columns.push([over ?? 'time', x]);
    }
    columns.push([series.length > 1 ? name : title, y]);
  }
  const rows = Math.max(...columns.map(([, values]) => values.length));
  const lines = Array.from({ length: rows }, (_, k) => columns.map(([, values]) => csvField(values[k])));
  return [columns.map(([name]) => csvField(name)), ...lines].map((line) => `${line.join(',')}\n`).join('');
}

/** The picture with what is drawn over it, as a canvas. */
function pictureOf(app) {
  app.draw();
  const { canvas } = app.viewer;
  const out = element('canvas', { width: canvas.width, height: canvas.height });
  const pen = out.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  pen.drawImage(byId('overlay'), 0, 0, canvas.width, canvas.height);
  const ratio = canvas.width / Math.max(canvas.clientWidth, 1);
  pen.scale(ratio, ratio);
  pen.font = '12px system-ui, sans-serif';
  pen.textBaseline = 'top';
  pen.fillStyle = '#1f2733';
  pen.fillText(`${byId('title').textContent}, ${byId('now').textContent}`, 12, 10);
  return out;
}
