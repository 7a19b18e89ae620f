'use strict';
// What stands beside the animation: charts, verdict, plan, scene, and the differences between runs.

class Panels {
  /** `go({ time, place })` shows a time, and a place if there is one; `choose(run)` shows a run. */
  constructor(runs, go, choose) {
    this.runs = runs;
    this.go = go;
    this.tabs = new Map();
    this.charts = [];
    /** The values of the picked node. */
    this.values = element('div', { className: 'values' });
    this.sweep = sweepOfPage();
    const isSetup = runs.every(({ setup }) => setup);
    if (isSetup) this.tab('Model');
    /** The panel with the plan. */
    this.facts = isSetup ? 'Plan' : 'Run';
    if (this.sweep) {
      for (const chart of sweepCharts(this.sweep)) {
        const made = new Chart(this.tab('Sweep'), chart, (value) => choose(this.nearest(value)));
        this.charts.push(made);
      }
      this.tab('Sweep').append(sweepTable(this.sweep, choose));
    }
    if (runs.length > 1) {
      this.tab('Compare').append(comparison(runs));
      document.getElementById('key').append(...runs.map((run, r) => coloured(element('span', { textContent: run.name }), r)));
    }
    for (const chart of overlaid(runs)) this.chart(this.tab(chart.group), chart);
    if (runs.some(({ tables }) => tables.length)) this.columns = new ColumnChart(this);
    if (!isSetup) this.tab('Verdict');
    this.tab(this.facts);
    this.tab('Scene');
    this.open(this.tabs.keys().next().value);
  }

  /** The panel of that name; it is made when it is first asked for. */
  tab(name) {
    if (!this.tabs.has(name)) {
      const button = element('button', { type: 'button', textContent: name, onclick: () => this.open(name) });
      const panel = element('div', { className: 'panel' });
      document.getElementById('tabs').append(button);
      document.getElementById('panels').append(panel);
      this.tabs.set(name, { button, panel });
    }
    return this.tabs.get(name).panel;
  }

  chart(panel, chart) {
    const made = new Chart(panel, chart, (time) => this.go({ time }));
    if (made.follows()) made.time = this.time;
    this.charts.push(made);
    return made;
  }

  /** Run of the case whose parameter is nearest to a value. */
  nearest(value) {
    const cases = this.sweep.cases.filter(({ run }) => run !== null);
    const away = ({ parameters }) => Math.abs(parameters[0] - value);
    return cases.reduce((a, b) => (away(b) < away(a) ? b : a)).run;
  }

  open(name) {
    for (const [found, { button, panel }] of this.tabs) {
      button.classList.toggle('on', found === name);
      panel.classList.toggle('on', found === name);
    }
    this.opened = name;
    this.redraw();
  }

  /** Charts that can be seen. */
  seen() {
    return this.charts.filter((chart) => chart.canvas.clientWidth > 0);
  }

  redraw() {
    for (const chart of this.seen()) chart.draw();
  }

  setTime(time) {
    this.time = time;
    const follow = this.charts.filter((chart) => chart.follows());
    for (const chart of follow) chart.time = time;
    for (const chart of this.seen().filter((chart) => chart.follows())) chart.setTime(time);
  }

  /** Texts about the run that is shown. */
  setRun(run) {
    const found = this.sweep?.cases.find((sought) => sought.run === this.runs.indexOf(run));
    for (const chart of this.charts.filter((chart) => found && !chart.follows())) {
      [chart.time] = found.parameters;
      if (chart.canvas.clientWidth > 0) chart.setTime(chart.time);
    }
    for (const row of document.querySelectorAll('tr.case')) row.classList.toggle('on', row.firstChild.textContent === String(found?.number));
    if (!run.setup) this.tab('Verdict').replaceChildren(...verdict(run, this.go));
    this.tab(this.facts).replaceChildren(...facts(run));
    const scene = run.run?.scene;
    this.tab('Scene').replaceChildren(scene ? element('pre', { textContent: scene }) : message('The folder has no scene (run.json).'));
  }

  /** Charts of a panel, in the place of those that it had. */
  replace(name, charts) {
    const panel = this.tab(name);
    this.charts = this.charts.filter((found) => {
      const isOld = found.box.parentNode === panel;
      if (isOld) found.box.remove();
      return !isOld;
    });
    for (const chart of charts) this.chart(panel, chart);
    this.redraw();
  }
}

/** Gives an element the colour of a run. */
function coloured(made, run) {
  made.style.color = runColour(run, document.querySelectorAll('script.run').length);
  return made;
}

function message(words) {
  return element('p', { className: 'message', textContent: words });
}

function table(rows) {
  const row = ([name, ...values]) => element('tr', {}, [element('th', { textContent: name }), ...values.map(cell)]);
  return element('table', {}, rows.map(row));
}

function cell(value) {
  return value instanceof Node ? value : element('td', { textContent: typeof value === 'number' ? text(value) : String(value ?? '-') });
}

function verdict(run, go) {
  const { verdict: found, watch } = run.summary ?? {};
  const out = run.notes.map(message);
  if (!found) return [...out, message('The folder has no summary (summary.json).')];
  const reason = (finding) => element('button', {
    type: 'button',
    className: `finding ${finding.level}`,
    textContent: `${finding.level}: ${finding.sentence}`,
    onclick: () => go({ time: finding.worst_time ?? finding.time, place: finding.position }),
  });
  const checked = watch ? ` Bodies and elements were checked every ${watch.every === 1 ? 'step' : `${watch.every} steps`}.` : '';
  const words = found.reasons.length ? 'What the watch found. A click shows the time and the place.' : 'The watch found nothing.';
  const { words: end, isWhole } = ending(run.summary);
  const failure = run.summary.outcome?.reason;
  const heading = isWhole ? `Verdict: ${found.level}` : `Verdict ${until(run.summary, unitOf(run, 'time'))}: ${found.level}`;
  return [
    ...out, element('h2', { textContent: `Outcome: ${end}` }), ...(failure ? [element('p', { textContent: failure })] : []),
    element('h2', { textContent: heading }), element('p', { textContent: words + checked }), ...found.reasons.map(reason),
  ];
}

/** How a run ended: the name of its outcome, that in words, and whether it reached its end, so that the verdict is one on all of it. */
function ending(summary) {
  const kind = summary?.outcome?.kind ?? 'unknown';
  const words = { stopped: 'stopped before its end', unknown: 'outcome unknown' }[kind] ?? kind;
  return { kind, words, isWhole: kind === 'completed' };
}

/** The part of a run that its verdict is about. */
function until(summary, unit) {
  return `up to t = ${text(summary.time)}${after(unit)}`;
}

/** Text and classes of the badge of the verdict; of a run that did not reach its end it says to which part it belongs, and has no colour that means that all is well. */
function judgement(summary, unit) {
  const level = summary?.verdict?.level;
  if (!level) return { textContent: 'no verdict', className: 'badge' };
  if (ending(summary).isWhole) return { textContent: level, className: `badge ${level}` };
  return { textContent: `${level} ${until(summary, unit)}`, className: `badge part ${level === 'sound' ? '' : level}`.trim() };
}

function driftOf({ relative, reason }) {
  return relative === null || relative === undefined ? reason ?? '-' : text(relative);
}

/** What a summary says, by name. */
function summaryRows(run) {
  const s = run.summary;
  if (!s) return [];
  const drifts = Object.entries(s.drift ?? {}).map(([name, drift]) => [`drift of ${name.replaceAll('_', ' ')}`, driftOf(drift)]);
  const memory = s.memory?.peak_resident_bytes;
  return [
    ['outcome', ending(s).words + (s.outcome?.reason ? `: ${s.outcome.reason}` : '')], ['verdict', judgement(s, unitOf(run, 'time')).textContent], ['scheme', s.scheme], ['time reached', s.time], ['steps', s.steps],
    ['halved steps', s.cuts], ['iterations a step', s.mean_iterations], ['most iterations', s.max_iterations], ...drifts,
    ['wall seconds', s.wall_seconds], ['CPU seconds', s.cpu_seconds], ['part of contact', s.contact_share],
    ['memory in MB', memory ? memory / 1e6 : '-'], ...Object.entries(s.unknowns ?? {}).map(([name, value]) => [name.replaceAll('_', ' '), value]),
    ['linear solver', s.linear_solver], ['version', s.version],
  ];
}

function facts(run) {
  const out = run.notes.map(message);
  if (run.summary) out.push(element('h2', { textContent: `Summary: ${run.name}` }), table(summaryRows(run)));
  const seconds = Object.entries(run.summary?.seconds ?? {});
  if (seconds.length) out.push(element('h2', { textContent: 'Wall seconds' }), table(seconds.map(([name, { wall }]) => [name, wall])));
  for (const contact of run.summary?.contacts ?? []) {
    const rows = Object.entries(contact).map(([name, value]) => [name.replaceAll('_', ' '), typeof value === 'object' && value ? JSON.stringify(value) : value]);
    out.push(element('h2', { textContent: 'Contact' }), table(rows));
  }
  if (run.run?.plan) out.push(element('h2', { textContent: 'Plan' }), element('pre', { textContent: run.run.plan.join('\n') }));
  const made = run.summary?.decisions ?? [];
  if (made.length) {
    const rows = made.slice(0, 500).map(({ step, kind, reason, time }) => [`t = ${text(time)}`, step, kind, reason]);
    const more = made.length > 500 ? [message(`The first 500 of ${made.length}.`)] : [];
    out.push(element('h2', { textContent: 'Decisions' }), ...more, table(rows));
  }
  return out;
}

/** What differs between runs: summaries, and the last row of each table. */
function comparison(runs) {
  const lists = runs.map((run) => new Map([...summaryRows(run), ...finals(run)]));
  const names = [...new Set(lists.flatMap((list) => [...list.keys()]))];
  const rows = names.map((name) => {
    const values = lists.map((list) => list.get(name) ?? '-');
    const cells = values.map((value) => {
      const made = cell(value);
      made.classList.toggle('differs', value !== values[0]);
      return made;
    });
    return [name, ...cells];
  });
  return table([['', ...runs.map((run) => run.name)], ...rows]);
}

function finals(run) {
  const shown = run.tables.filter(({ name }) => ['balance', 'probes', 'joints'].includes(name));
  return shown.flatMap(({ names, values }) =>
    names.map((name, k) => [`${name} at the end`, values[k][values[k].length - 1] ?? null]).filter(([name]) => !/^(step|time|dt) at/.test(name)));
}
