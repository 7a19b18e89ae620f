'use strict';
// A page of a run that goes on loads itself anew, and is then as it was: view, time, field, panel and the rest. At the last frame it goes to the new last one.

const STATE = `stoss ${location.pathname}`;
/** Controls whose values are kept. */
const KEPT = [
  'range', 'low', 'high', 'extremes', 'enlarge', 'own', 'mesh', 'outline', 'arrows', 'clip', 'offset', 'filled', 'sectors', 'about', 'speed',
  ...['x', 'y', 'z'].flatMap((axis) => [`mirror-${axis}`, `mirror-at-${axis}`]),
];

/** What the page shows, to be kept over a reload. */
function stateOf(app) {
  const state = { run: app.run.name, tab: app.panels.opened, scroll: byId('panels').scrollTop };
  if (!app.isAnimated()) return state;
  const { viewer } = app;
  const { azimuth, elevation, target, distance } = viewer.camera;
  const value = (id) => (byId(id).type === 'checkbox' ? byId(id).checked : byId(id).value);
  return {
    ...state,
    camera: { azimuth, elevation, target, distance },
    time: viewer.time,
    isLast: viewer.time >= app.ends()[1],
    isPlaying: app.isPlaying,
    field: byId('field').selectedOptions[0]?.textContent,
    controls: Object.fromEntries(KEPT.map((id) => [id, value(id)])),
    isFlipped: byId('flip').classList.contains('on'),
    hidden: app.run.animation.bodies.filter((_, k) => viewer.show.hidden.has(k)).map(({ name }) => name),
    picked: app.picked,
  };
}

/** Shows what was shown, as far as it is still there. */
function restore(app, state) {
  const run = app.runs.findIndex(({ name }) => name === state.run);
  if (run >= 0 && app.run !== app.runs[run]) app.setRun(run);
  if (app.isAnimated() && state.camera) {
    const { animation } = app.run;
    const set = (id, value) => {
      byId(id)[byId(id).type === 'checkbox' ? 'checked' : 'value'] = value;
    };
    const field = animation.fields.findIndex(({ label }) => label === state.field);
    app.setField(field);
    Object.entries(state.controls).forEach(([id, value]) => set(id, value));
    byId('flip').classList.toggle('on', state.isFlipped);
    app.controls.apply();
    animation.bodies.forEach(({ name }, k) => {
      if (state.hidden.includes(name)) byId('bodies').querySelectorAll('input')[k].click();
    });
    Object.assign(app.viewer.camera, state.camera);
    if (state.picked && state.picked.node < animation.nodes) app.pick(state.picked);
    app.setTime(state.isLast && !state.isPlaying ? app.ends()[1] : state.time);
    if (state.isPlaying) app.play(true);
  }
  if (app.panels.tabs.has(state.tab)) app.panels.open(state.tab);
  byId('panels').scrollTop = state.scroll;
}

/** Takes the state that the page before a reload has left, and plans the next reload if the run goes on. */
function follow(app) {
  let state = null;
  try {
    state = JSON.parse(sessionStorage.getItem(STATE));
    sessionStorage.removeItem(STATE);
  } catch {
    // A browser may refuse to store anything: the page then begins anew each time.
  }
  if (state) restore(app, state);
  const seconds = Number(document.querySelector('meta[name=stoss-reload]')?.content);
  if (!(seconds > 0)) return;
  byId('following').textContent = `the run is running; reloaded every ${text(seconds)} s`;
  let isHeld = false;
  addEventListener('pointerdown', () => { isHeld = true; }, true);
  for (const name of ['pointerup', 'pointercancel']) addEventListener(name, () => { isHeld = false; }, true);
  app.reload = setInterval(() => {
    // Not in the middle of a drag.
    if (isHeld) return;
    try {
      sessionStorage.setItem(STATE, JSON.stringify(stateOf(app)));
    } catch {
      // See above.
    }
    location.reload();
  }, 1000 * seconds);
}
