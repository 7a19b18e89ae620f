'use strict';
// No part of the page of a run: tests add it behind the program. With `#test` behind the address it uses every control of the started
// page, and the title says `ready` or what went wrong.

/** What tests share: `changes` wants that the picture differs after an act, and is the same again after it is taken back. */
function tester(app) {
  const { viewer } = app;
  const done = [];
  const pixels = () => {
    app.draw();
    const { gl } = viewer;
    const out = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, out);
    return out;
  };
  const differing = (a, b) => a.reduce((count, value, k) => count + (value !== b[k] ? 1 : 0), 0);
  const must = (name, holds) => {
    if (!holds) throw new Error(`test: ${name}`);
    done.push(name);
  };
  const use = (id, event, value) => {
    const control = byId(id);
    if (value !== undefined) control[typeof value === 'boolean' ? 'checked' : 'value'] = value;
    control.dispatchEvent(new Event(event));
  };
  const changes = (name, act, undo) => {
    const before = pixels();
    act();
    const after = pixels();
    must(name, differing(before, after) > 0);
    if (!undo) return;
    undo();
    must(`${name}, taken back`, differing(before, pixels()) === 0);
  };
  return { done, pixels, differing, must, use, changes };
}

/** Every control of the picture. */
async function tryControls(app) {
  const { viewer } = app;
  const { done, pixels, differing, must, use, changes } = tester(app);
  const [first, last] = app.ends();
  const middle = 0.5 * (first + last);
  use('scrub', 'input', first);
  must('the picture is not blank', pixels().filter((value, k) => k % 4 < 3 && value < 250).length > 3000);
  changes('scrub', () => use('scrub', 'input', middle), () => use('scrub', 'input', first));
  must('the cursor of charts follows', app.panels.charts.every((chart) => chart.over || chart.time === viewer.time));
  changes('step forth', () => byId('forth').click(), () => byId('back').click());
  use('scrub', 'input', middle);
  const field = byId('field').value;
  const { hidden } = viewer.show;
  viewer.show.hidden = new Set(app.run.animation.bodies.keys());
  const empty = pixels();
  viewer.show.hidden = hidden;
  for (let k = -1; k < app.run.animation.fields.length; k++) {
    use('field', 'change', String(k));
    must(`field ${byId('field').selectedOptions[0].textContent}`, viewer.show.field === k && differing(empty, pixels()) > 3000);
  }
  use('field', 'change', '0');
  changes('another field', () => use('field', 'change', '-1'), () => use('field', 'change', '0'));
  changes('fixed range', () => {
    use('high', 'input', String(0.2 * rangeOf(app.run.animation.fields[0], app.run.animation)[1]));
    use('range', 'input', 'fixed');
  }, () => use('range', 'input', 'run'));
  changes('range of the frame', () => {
    use('scrub', 'input', 0.9 * first + 0.1 * last);
    use('range', 'input', 'frame');
  });
  use('range', 'input', 'run');
  use('scrub', 'input', middle);
  use('field', 'change', field);
  const hasSurface = app.run.animation.facets.length > 0;
  if (hasSurface) changes('mesh', () => use('mesh', 'change', false), () => use('mesh', 'change', true));
  changes('undeformed', () => use('outline', 'change', true), () => use('outline', 'change', false));
  use('offset', 'input', '0.5');
  changes('clip plane', () => use('clip', 'change', '0'));
  changes('place of the plane', () => use('offset', 'input', '0.25'));
  changes('other side', () => byId('flip').click(), () => byId('flip').click());
  use('clip', 'change', '');
  const body = byId('bodies').querySelector('input');
  changes('hide a body', () => body.click(), () => body.click());
  changes('view', () => byId('views').querySelectorAll('button')[3].click());
  byId('views').querySelector('button').click();
  const pointer = (type, x, y, more = {}) => {
    const box = byId('scene').getBoundingClientRect();
    byId('scene').dispatchEvent(new PointerEvent(type, { clientX: box.left + x, clientY: box.top + y, pointerId: 1, ...more }));
  };
  byId('scene').setPointerCapture = () => {};
  const drag = (more) => {
    pointer('pointerdown', 100, 100);
    pointer('pointermove', 130, 120, more);
    pointer('pointerup', 130, 120);
  };
  changes('turn', () => drag({}));
  changes('move', () => drag({ shiftKey: true }));
  changes('zoom', () => byId('scene').dispatchEvent(new WheelEvent('wheel', { deltaY: 200 })));
  byId('views').querySelector('button').click();
  pixels();
  let seen = null;
  for (let node = 0; node < app.run.animation.nodes && !seen; node++) {
    const [x, y] = viewer.project(viewer.place(node));
    const found = pickIn(viewer, x, y);
    if (found?.node === node) seen = [x, y];
  }
  must('a node can be picked', seen !== null);
  pointer('pointerdown', ...seen);
  pointer('pointerup', ...seen);
  app.draw();
  must('its values are shown', byId('picked').textContent.includes('position'));
  const place = app.run.animation.corner;
  changes('go to a finding', () => app.go({ time: first, place }));
  must('time of the finding', viewer.time === first);
  byId('views').querySelector('button').click();
  use('scrub', 'input', first);
  const before = pixels();
  const time = viewer.time;
  byId('play').click();
  // A slow machine draws its first frame late; reading the picture takes time that is not virtual.
  for (let waits = 0; viewer.time === time && waits < 600; waits += 1) {
    await new Promise((resolve) => setTimeout(resolve, 100));
    if (waits > 20) pixels();
  }
  must('playing moves time', viewer.time !== time);
  must('playing changes the picture', differing(before, pixels()) > 0);
  byId('play').click();
  must('pause', !app.isPlaying);
  byId('picture').style.maxHeight = '300px';
  await new Promise((resolve) => setTimeout(resolve, 200));
  must('another size', byId('scene').height === byId('scene').clientHeight && byId('scene').height <= 300);
  byId('picture').style.maxHeight = '';
  // Of runs that are compared the first page has shown that.
  const model = app.runs.length > 1 ? [] : [...tryFields(app), ...tryPicture(app), ...tryInside(app)];
  return [...done, ...model];
}

/** Milliseconds of a frame with the graphics card's part, which reading a pixel waits for, and of the script in the fastest frame; that with arrows and a filled cut, too. Time that is virtual stands still. */
function frameTime(app) {
  const { use } = tester(app);
  const { gl } = app.viewer;
  const [first, last] = app.ends();
  const pixel = new Uint8Array(4);
  const count = 20;
  const measured = () => {
    let script = Infinity;
    const start = performance.now();
    for (let k = 0; k < count; k++) {
      const before = performance.now();
      app.setTime(first + ((last - first) * (k + 0.5)) / count);
      app.draw();
      script = Math.min(script, performance.now() - before);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return [script, (performance.now() - start) / count];
  };
  const [script, frame] = measured();
  use('arrows', 'change', '0');
  use('clip', 'change', '1');
  use('extremes', 'change', true);
  const [more] = measured();
  use('arrows', 'change', '');
  use('clip', 'change', '');
  use('extremes', 'change', false);
  return { frame, script, more };
}

/** Every panel opens, a chart takes a click, a drag and a double click, and its lines can be hidden. */
function tryPanels(app) {
  const { panels } = app;
  for (const name of panels.tabs.keys()) {
    panels.tabs.get(name).button.click();
    if (!panels.tabs.get(name).panel.textContent) throw new Error(`test: panel ${name} is empty`);
    const [chart] = panels.seen();
    if (!chart) continue;
    const plot = chart.canvas.parentNode;
    plot.setPointerCapture = () => {};
    const box = plot.getBoundingClientRect();
    const pointer = (type, part) => plot.dispatchEvent(new PointerEvent(type, { clientX: box.left + part * box.width, pointerId: 1 }));
    const press = (from, to) => [['pointerdown', from], ['pointermove', to], ['pointerup', to]].forEach(([type, part]) => pointer(type, part));
    press(0.5, 0.5);
    const { left, right } = chart.ends();
    if (chart.follows() && !chart.over && !(chart.time > left && chart.time < right)) throw new Error(`test: click in ${chart.title}`);
    press(0.4, 0.6);
    if (!(chart.ends().right - chart.ends().left < 0.5 * (right - left))) throw new Error(`test: part of ${chart.title}`);
    plot.dispatchEvent(new MouseEvent('dblclick'));
    if (chart.span !== null) throw new Error(`test: all of ${chart.title}`);
    chart.labels[0].button.click();
    if (chart.lines().length !== chart.series.length - chart.labels[0].series.length) throw new Error(`test: a line of ${chart.title}`);
    chart.labels[0].button.click();
  }
  return [...[...panels.tabs.keys()].map((name) => `panel ${name}`), ...panels.charts.map(({ title }) => `chart ${title}`)];
}

async function test(app) {
  const done = [];
  for (let k = 0; k < app.runs.length; k++) {
    byId('run').value = k;
    byId('run').dispatchEvent(new Event('change'));
    if (app.run !== app.runs[k]) throw new Error('test: choice of the run');
    // A scene before its run has one frame, and the controls of the page of a run.
    if (app.run.setup) done.push(...tryLayers(app), ...tryInside(app));
    else if (app.isAnimated()) done.push(...(await tryControls(app)));
  }
  return [...done, ...tryColumns(app), ...tryPanels(app), ...trySweep(app)];
}

/** A case of the sweep is shown by a click into a chart, and by one into the table; the cursor is at its parameter. */
function trySweep(app) {
  const { panels } = app;
  if (!panels.sweep) return [];
  const cases = panels.sweep.cases.filter(({ run }) => run !== null);
  panels.open('Sweep');
  const charts = panels.seen();
  const must = (name, holds) => {
    if (!holds) throw new Error(`test: ${name}`);
  };
  for (const { run, parameters } of cases) {
    charts[0]?.seek(parameters[0]);
    must('a value chooses a run', !charts.length || app.run === app.runs[run]);
    must('the cursor is at the parameter', charts.every((chart) => chart.over && chart.time === parameters[0]));
  }
  document.querySelector('tr.case').click();
  must('a row chooses a run', app.run === app.runs[cases[0].run]);
  return ['sweep'];
}

/** With `#test-reload` a page that loads itself anew must be after it as it was before. */
function tryReload(app) {
  const before = JSON.parse(sessionStorage.getItem('stoss test'));
  if (!before) {
    app.setTime(0.5 * app.ends()[1]);
    Object.assign(app.viewer.camera, { azimuth: 10, elevation: 5, distance: 3, target: [1, 2, 3] });
    app.setField(1);
    byId('bodies').querySelector('input').click();
    for (const [id, value] of [['clip', '1'], ['offset', '0.25'], ['range', 'frame']]) {
      byId(id).value = value;
      byId(id).dispatchEvent(new Event(id === 'clip' ? 'change' : 'input'));
    }
    app.panels.open('Run');
    sessionStorage.setItem('stoss test', JSON.stringify(stateOf(app)));
    return;
  }
  clearInterval(app.reload);
  const after = JSON.stringify(stateOf(app));
  const wanted = JSON.stringify(before);
  const { show } = app.viewer;
  const isShown = show.hidden.has(0) && show.clip.axis === 1 && show.clip.part === 0.25 && show.range === 'frame' && show.field === 1;
  document.title = after === wanted && isShown ? 'ready' : `error ${after} is not ${wanted}`;
}

started
  .then(async (app) => {
    const loaded = `loaded in ${Math.round(performance.now())} ms`;
    if (location.hash === '#test-reload') tryReload(app);
    const asked = /^#test-time=(\d+)$/.exec(location.hash);
    // A picture that is asked for tells the times to who waits for it.
    if (asked) new Image().src = `http://127.0.0.1:${asked[1]}/?${encodeURIComponent(JSON.stringify(frameTime(app)))}`;
    if (location.hash !== '#test') return;
    const done = await test(app);
    document.body.append(element('pre', { id: 'tested', textContent: [loaded, ...done].join('\n') }));
    document.title = 'ready';
  })
  .catch((error) => {
    if (location.hash.startsWith('#test')) document.title = `error ${error.message}`;
  });
