'use strict';
// What a page of a sweep has beside the comparison of its cases: the table, and results over the parameter.

/** The sweep of the page, or nothing; `sweep.rs` says what is in it. */
function sweepOfPage() {
  const script = document.getElementById('sweep');
  return script ? JSON.parse(script.textContent) : null;
}

/** Results over the parameter, if there is one: charts as `overlaid` makes them. */
function sweepCharts(sweep) {
  if (sweep.parameters.length !== 1) return [];
  const cases = sweep.cases.filter(({ run, parameters }) => run !== null && parameters[0] !== null).sort((a, b) => a.parameters[0] - b.parameters[0]);
  const x = cases.map(({ parameters }) => parameters[0]);
  const charts = new Map();
  sweep.results.forEach((result, k) => {
    // A case that did not reach its end has no values at the end; what it cost is known.
    const isCost = ['time', 'steps', 'wall_seconds'].includes(result);
    const y = cases.map(({ results, outcome }) => (isCost || outcome === 'completed' ? results[k] : null));
    if (!y.some((value) => value !== null)) return;
    const { title, name } = resultName(result);
    const chart = charts.get(title) ?? { group: 'Sweep', title: `${title} over ${sweep.parameters[0]}`, over: sweep.parameters[0], series: [], marks: [] };
    chart.series.push({ name, x, y, colour: COLOURS[chart.series.length % COLOURS.length], hasDots: true });
    charts.set(title, chart);
  });
  // Beside something larger round-off is not worth a line.
  const largest = (lines) => Math.max(...lines.flatMap(({ y }) => y.map(Math.abs)));
  for (const chart of charts.values()) chart.series = chart.series.filter((line) => !(largest([line]) < 1e-10 * largest(chart.series)));
  // What a run took stands behind what it found.
  const isCost = ({ title }) => /^(time|steps|wall seconds) over/.test(title);
  const all = [...charts.values()];
  const differs = ({ series }) => series.some(({ y }) => y.some((value) => value !== y[0]));
  return [...all.filter((chart) => !isCost(chart)), ...all.filter((chart) => isCost(chart) && differs(chart))];
}

/** Title of the chart and name of the line of a column such as `last.tip.x` or `max.contact.max_pressure`. */
function resultName(result) {
  const [, kind, column] = /^(last|min|max)[.](.*)$/.exec(result) ?? [];
  if (!kind) return { title: result.replaceAll('_', ' '), name: result.replaceAll('_', ' ') };
  const component = COMPONENT.exec(column)?.[1];
  const stem = component ? column.slice(0, -component.length).replace(/[._]$/, '') : column;
  if (kind === 'last') return { title: `${stem} at the end`, name: component ?? nameOf(column) };
  return { title: `extremes of ${stem}`, name: component ? `${kind} ${component}` : kind };
}

/** A row a case; a click shows its run. */
function sweepTable(sweep, choose) {
  const head = ['case', ...sweep.parameters, 'outcome', 'verdict', ...sweep.results.map((name) => name.replaceAll('_', ' ')), 'reason'];
  const rows = sweep.cases.map(({ number, parameters, outcome, verdict, results, reason, run }) => {
    // The verdict on a run that did not reach its end is one on the part up to there.
    const judged = element('td', outcome === 'completed' ? { textContent: verdict || '-' } : { className: 'part', textContent: verdict ? `(${verdict} up to there)` : '-' });
    const cells = [...parameters, element('td', { className: outcome, textContent: outcome }), judged, ...results, element('td', { className: 'reason', textContent: reason })].map(cell);
    const row = element('tr', {}, [element('th', { textContent: number }), ...cells]);
    if (run !== null) {
      row.className = 'case';
      row.onclick = () => choose(run);
      coloured(row.firstChild, run);
    }
    return row;
  });
  const names = element('tr', {}, head.map((name) => element('th', { textContent: name })));
  return element('div', { className: 'wide' }, [element('table', { className: 'sweep' }, [names, ...rows])]);
}
