'use strict';
// No part of the page of a run, as `selftest.js`: what is shown of the model is compared with what is known by itself.

/** Components, and what is made of tensors, by their identities; the range; the smallest and the largest value. */
function tryFields(app) {
  const { must, done, use } = tester(app);
  const { viewer, run: { animation } } = app;
  const near = (a, b, scale) => Math.abs(a - b) <= 1e-5 * scale;
  const [first, last] = app.ends();
  app.setTime(0.5 * (first + last));
  for (const array of animation.arrays) {
    const of = (kind) => animation.fields.filter((field) => field.array === array && field.part.kind === kind);
    const values = (fields, k) => fields.map((field) => valueAt(field, k));
    for (let k = 0; k < animation.nodes * animation.times.length; k += 7) {
      const parts = values(of('component'), k);
      if (!parts.length || parts.some(Number.isNaN)) continue;
      const scale = Math.hypot(...parts) + 1e-30;
      if (array.read.length === 3 && of('size').length) must(`length of ${array.label}`, near(valueAt(of('size')[0], k), Math.hypot(...parts), scale));
      if (array.read.length !== 6) continue;
      const [a, b, c] = values(of('principal'), k);
      const [xx, yy, zz, xy, yz, xz] = parts;
      const squares = xx * xx + yy * yy + zz * zz + 2 * (xy * xy + yz * yz + xz * xz);
      const third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
      must(`order of principal values of ${array.label}`, a >= b - 1e-9 * scale && b >= c - 1e-9 * scale);
      must(`trace of ${array.label}`, near(a + b + c, xx + yy + zz, scale));
      must(`squares of ${array.label}`, near(a * a + b * b + c * c, squares, scale * scale));
      must(`determinant of ${array.label}`, near(a * b * c, third, scale ** 3));
      const apart = ((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 2;
      for (const value of values(of('von_mises'), k)) must('von Mises stress of principal stresses', near(value, Math.sqrt(apart), scale));
      for (const value of values(of('equivalent'), k)) must('equivalent strain of principal strains', near(value, (2 / 3) * Math.sqrt(apart), scale));
      for (const value of values(of('pressure'), k)) must('pressure of principal stresses', near(value, -(a + b + c) / 3, scale));
    }
  }
  for (const field of animation.fields.filter(({ array }) => TRACTIONS.includes(array.name))) {
    const acting = valuesOf(field, animation).filter((value) => value > 0);
    const [, most] = typicalRange(field, animation);
    if (most < rangeOf(field, animation)[1]) done.push('rims are left out');
    must('the typical range has nearly all contact', acting.filter((value) => value > most).length <= RIM.share * acting.length + 1);
  }
  for (let k = 0; k < animation.fields.length; k++) {
    use('field', 'change', String(k));
    const found = viewer.extremes();
    const all = [...viewer.shownNodes()].map((node) => viewer.value(animation.fields[k], node)).filter((value) => !Number.isNaN(value));
    const [low, high] = endsOf(all);
    if (found) must('smallest and largest value', near(found[0].value, low, Math.abs(high - low) + 1e-30) && near(found[1].value, high, Math.abs(high - low) + 1e-30));
  }
  use('field', 'change', '0');
  const over = () => byId('overlay').toDataURL();
  app.draw();
  const before = over();
  use('extremes', 'change', true);
  app.draw();
  const marked = viewer.extremes();
  const isSeen = marked && marked.every(({ node }) => viewer.project(viewer.place(node)));
  if (isSeen) must('min, max are marked', over() !== before && app.overlay.taken.length === (marked[0].node === marked[1].node ? 1 : 2));
  use('extremes', 'change', false);
  return [...new Set(done)];
}

/** Deformation, arrows, copies, fit, and what is saved. */
function tryPicture(app) {
  const { must, done, use, changes, pixels, differing } = tester(app);
  const { viewer, run: { animation } } = app;
  const [first, last] = app.ends();
  app.setTime(last);
  const node = [...viewer.shownNodes()].reduce((a, b) => (size(viewer.moved(b)) > size(viewer.moved(a)) ? b : a));
  const isAt = (factor) => {
    const wanted = add(referenceOf(animation, node), scaled(viewer.moved(node), factor));
    const places = viewer.places().subarray(3 * node, 3 * node + 3);
    return [viewer.place(node), places].every((place) => size(subtract(place, wanted)) <= 1e-6 * viewer.extent());
  };
  for (const [value, factor] of [['0', 0], ['5', 5], ['10', 10]]) {
    changes(`deformation ${value}`, () => use('enlarge', 'change', value));
    must(`deformation ${value} of a node`, isAt(factor));
  }
  use('own', 'input', '-3');
  changes('own deformation', () => use('enlarge', 'change', 'own'));
  must('own deformation of a node', isAt(-3));
  use('enlarge', 'change', 'auto');
  const factor = viewer.show.enlarged;
  const [low, high] = boxOf(animation, 0);
  const [, largest] = rangeOf(animation.fields[0], animation);
  must('automatic deformation', factor === 1 || (factor * largest <= 0.1001 * size(subtract(high, low)) && factor * largest > 0.039 * size(subtract(high, low))));
  use('enlarge', 'change', '1');
  app.controls.arrows.forEach(({ label }, k) => {
    const count = arrowsAt(viewer, app.controls.arrows[k], viewer.extent()).length;
    if (count) changes(`arrows of ${label}`, () => use('arrows', 'change', String(k)), () => use('arrows', 'change', ''));
  });
  const volume = viewer.extent();
  changes('mirror', () => byId('mirror-x').click());
  must('two copies are larger than one', viewer.copies.length === 2 && viewer.extent() > volume);
  const [copy] = viewer.copies.slice(1);
  const place = viewer.place(node);
  const plane = Number(byId('mirror-at-x').value);
  must('a mirrored node', size(subtract(placed(copy, place), [2 * plane - place[0], place[1], place[2]])) < 1e-6 * volume);
  byId('mirror-x').click();
  changes('sectors', () => use('sectors', 'change', '4'));
  const [x, y, z] = place;
  must('a node in the second of four sectors', viewer.copies.length === 4 && size(subtract(placed(viewer.copies[1], place), [-y, x, z])) < 1e-6 * viewer.extent());
  byId('views').querySelectorAll('button')[3].click();
  app.draw();
  const inCopy = animation.facets.length === 0 || [...viewer.shownNodes()].some((wanted) => {
    const [px, py] = viewer.project(placed(viewer.copies[2], viewer.place(wanted)));
    return pickIn(viewer, px, py)?.node === wanted;
  });
  must('a node can be picked in a copy', inCopy);
  const all = pixels();
  const { copies } = viewer;
  for (const lacking of [1, 2, 3]) {
    viewer.copies = copies.filter((_, k) => k !== lacking);
    must('every copy is drawn', differing(all, pixels()) > 0);
  }
  viewer.copies = copies;
  use('sectors', 'change', '1');
  viewer.camera.zoom(3);
  byId('fit').click();
  const seen = [...viewer.shownNodes()].map((shown) => viewer.project(viewer.place(shown)));
  const spans = [0, 1].map((k) => endsOf(seen.map((pair) => pair[k])));
  const sizes = [viewer.canvas.clientWidth, viewer.canvas.clientHeight];
  must('all is in the picture', spans.every(([from, to], k) => from >= 0 && to <= sizes[k]));
  must('what is shown fills the picture', spans.some(([from, to], k) => to - from > 0.55 * sizes[k]));
  byId('views').querySelector('button').click();
  const saved = pictureOf(app);
  const inked = (canvas) => {
    const copied = element('canvas', { width: canvas.width, height: canvas.height }).getContext('2d', { willReadFrequently: true });
    copied.drawImage(canvas, 0, 0);
    const { data } = copied.getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, k) => k % 4 === 0 && data[k + 3] > 0 && value < 250).length;
  };
  must('the saved picture has the bodies and what is over them', saved.width === viewer.canvas.width && inked(saved) > inked(byId('overlay')) + 3000 && inked(byId('overlay')) > 500);
  app.setTime(first);
  return done;
}

/** The filled cut and the path. */
function tryInside(app) {
  const { must, done, use, changes } = tester(app);
  const { viewer, panels, run: { animation } } = app;
  const solids = animation.bodies.filter(({ elements }) => elements[1]);
  if (!solids.length) return done;
  app.setTime(app.ends()[1]);
  use('field', 'change', '0');
  // Through the middle of the first body.
  const [low, high] = endsOf([...nodesOf(animation, solids[0])].map((node) => viewer.place(node)[2]));
  use('offset', 'input', String((0.5 * (low + high) - viewer.low[2]) / (viewer.high[2] - viewer.low[2])));
  use('clip', 'change', '2');
  must('the plane cuts', cutArea(viewer, [0, 0, 1, 0.5 * (low + high)], solids) > 0);
  // Without the lines in which it cuts faces.
  use('mesh', 'change', false);
  changes('filled cut', () => use('filled', 'change', false), () => use('filled', 'change', true));
  use('mesh', 'change', true);
  use('clip', 'change', '');
  // The areas of all cuts make the volume that the surface encloses.
  for (const axis of [0, 1, 2]) {
    const normal = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
    const count = 200;
    const step = (viewer.high[axis] - viewer.low[axis]) / count;
    const areas = Array.from({ length: count }, (_, k) => cutArea(viewer, [...normal, viewer.low[axis] + (k + 0.5) * step], solids));
    const volume = solids.reduce((sum, body) => sum + enclosed(viewer, body), 0);
    must(`volume of cuts across axis ${axis}`, Math.abs(step * areas.reduce((a, b) => a + b) - volume) < 0.02 * volume);
  }
  panels.open('Path');
  app.path.clear();
  const [body] = solids;
  const nodes = nodesOf(animation, body);
  const far = (a) => nodes.reduce((best, node) => (size(subtract(viewer.place(node), viewer.place(a))) > size(subtract(viewer.place(best), viewer.place(a))) ? node : best));
  const ends = [nodes[0], far(nodes[0])];
  const number = animation.bodies.indexOf(body);
  for (const node of ends) app.pick({ body: number, node });
  app.draw();
  const chart = app.path.chart;
  const profile = chart?.series.find(({ name }) => name === body.name);
  must('a path has its chart', Boolean(profile));
  const [a, b] = ends.map((node) => viewer.value(viewer.field(), node));
  const [, most] = rangeOf(viewer.field(), animation);
  const last = profile.x.length - 1;
  const isNear = (value, wanted) => Math.abs(value - wanted) <= 1e-3 * most;
  must('a path begins and ends with the values of its nodes', isNear(profile.y[0], a) && isNear(profile.y[last], b));
  const length = size(subtract(viewer.place(ends[0]), viewer.place(ends[1])));
  must('a path is as long as its nodes are apart', Math.abs(profile.x[last] - length) < 1e-3 * length);
  const before = JSON.stringify(profile.y);
  app.setTime(0.5 * (app.ends()[0] + app.ends()[1]));
  app.draw();
  must('a path follows the time', app.ends()[0] === app.ends()[1] || JSON.stringify(app.path.chart.series[0]?.y) !== before);
  const inputs = app.path.inputs.flatMap((end) => end.inputs);
  [...viewer.place(ends[0]), ...viewer.place(ends[1])].forEach((value, k) => {
    inputs[k].value = value;
    inputs[k].dispatchEvent(new Event('input'));
  });
  app.draw();
  must('a path between two points', app.path.chart.series.some(({ name, x }) => name === body.name && x.length > 1));
  const lines = csvOf(app.path.chart).trim().split('\n');
  must('a path as a table', lines.length === 1 + Math.max(...app.path.chart.series.map(({ x }) => x.length)) && lines[0].startsWith('distance'));
  app.pick(null);
  return done;
}

/** Area of a plane in bodies. */
function cutArea(viewer, plane, bodies) {
  const cut = new Cut(viewer.run, viewer.places(), viewer.now());
  cut.at(plane);
  for (const { elements } of bodies) cut.through(elements);
  const vertices = cut.triangles.all();
  const at = (k) => vertices.subarray(4 * k, 4 * k + 3);
  let area = 0;
  for (let k = 0; k < cut.triangles.count; k += 3) area += 0.5 * size(cross(subtract(at(k + 1), at(k)), subtract(at(k + 2), at(k))));
  return area;
}

/** Volume inside of the facets of a body. */
function enclosed(viewer, { facets: [first, count] }) {
  const places = viewer.places();
  const at = (node) => places.subarray(3 * node, 3 * node + 3);
  let volume = 0;
  for (let f = first; f < first + count; f++) {
    const [a, b, c, d] = Array.from(viewer.run.facets.subarray(4 * f, 4 * f + 4), at);
    volume += (dot(a, cross(b, c)) + dot(a, cross(c, d))) / 6;
  }
  return Math.abs(volume);
}

/** Any column over any other: the points are those of the table, and the cursor follows the time. */
function tryColumns(app) {
  const { columns } = app.panels;
  if (!columns) return [];
  const done = [];
  app.panels.open('Columns');
  const [run] = app.runs;
  for (const { name, names, values } of run.tables.filter((table) => table.names.includes('time'))) {
    [columns.across.value, columns.up.value] = [`${name}/${names[names.length - 1]}`, `${name}/time`];
    columns.draw();
    const chart = app.panels.charts.find(({ box }) => box.parentNode === app.panels.tab('Columns'));
    const [series] = chart.series;
    if (JSON.stringify([series.x, series.y]) !== JSON.stringify([values[names.length - 1], values[names.indexOf('time')]])) throw new Error(`test: columns of ${name}`);
    const time = series.times[series.times.length - 1];
    app.panels.setTime(time);
    if (chart.time !== time) throw new Error('test: the cursor of columns follows the time');
    if (csvOf(chart).trim().split('\n').length !== Math.max(...chart.series.map(({ x }) => x.length)) + 1) throw new Error('test: columns as a table');
    done.push(`columns of ${name}`);
  }
  return done;
}

/** Every layer of a scene before its run is shown and taken away; its name stands in the picture unless it is a set. */
function tryLayers(app) {
  const { layers } = app.viewer;
  if (!layers) return [];
  const { must, done, changes } = tester(app);
  app.panels.open('Model');
  const boxes = [...document.querySelectorAll('#layers input')];
  must('a box for each layer', boxes.length === layers.list.length);
  boxes.filter((box) => box.checked).forEach((box) => box.click());
  for (const layer of layers.list) {
    const box = boxes.find((found) => found.parentNode.textContent.startsWith(layer.name) && found.checked === layer.isShown);
    changes(`layer ${layer.name}`, () => box.click(), () => box.click());
  }
  const named = layers.list.find(({ kind }) => kind !== 'set');
  if (!named) return done;
  app.draw();
  const before = byId('overlay').toDataURL();
  named.isShown = true;
  app.draw();
  must('names of layers', byId('overlay').toDataURL() !== before);
  return done;
}
