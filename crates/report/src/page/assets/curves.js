'use strict';
// Which charts the tables of a run make.

/** Sums of a balance that belong into one chart; the rest of the columns of a table makes charts by the names. */
const BALANCE = [
  ['Linear momentum', ['lx', 'ly', 'lz']],
  ['Angular momentum', ['jx', 'jy', 'jz']],
  ['Energy', ['kinetic', 'strain', 'potential', 'contact', 'total']],
  ['Work and losses', ['external_work', 'dissipation', 'closing_loss', 'contact_remainder', 'impact_loss', 'friction_work', 'friction_stored']],
  ['Energy in materials', ['plastic_loss', 'hardening', 'viscous_loss', 'softening_loss']],
];
const CONTACT = [
  ['Contact force', ['contact_force_x', 'contact_force_y', 'contact_force_z']],
  ['Smallest gap', ['min_gap']],
  ['Largest contact pressure', ['max_pressure']],
  ['Contact points', ['active', 'closed', 'released', 'repaired']],
  ['Coverage defect', ['coverage_defect']],
];
const WATCH = [
  ['Deepest penetration (edge lengths)', ['relative_depth']],
  ['Nodes inside, cutting edges, tunnelled nodes', ['nodes_inside', 'cutting_edges', 'tunnelled']],
];

/** What the columns of the table of terms are, by the ends of their names. */
const TERMS = [
  ['stored', 'Stored energy by term'],
  ['supplied', 'Energy supplied since the start, by term'],
  ['dissipated', 'Energy dissipated since the start, by term'],
  ['plastic_loss', 'Energy taken by plastic flow since the start, by body'],
  ['hardening', 'Energy stored by hardening, by body'],
  ['viscous_loss', 'Energy taken by viscous flow since the start, by body'],
  ['softening_loss', 'Energy taken by softening since the start, by body'],
  ['remainder', 'Energy lost since the start, by term (negative: made)'],
];

/** What the columns of a joint are, by the ends of their names. */
const JOINT = { f: ': force', m: ': moment', coordinate: ': angle or displacement', friction: ': friction' };

/** Charts of a run: `{ group, title, lines: [{ name, x, y }], isLog, marks }`. */
function curvesOf(run) {
  const tables = Object.fromEntries(run.tables.map((table) => [table.name, table]));
  const charts = [];
  const put = (group, title, table, names, more = {}) => {
    const x = column(table, 'time');
    const lines = names.map((name) => ({ name: nameOf(name), x, y: column(table, name) }));
    const moving = lines.filter(({ y }) => y && y.some((value) => value !== null && value !== 0));
    const units = names.map((found) => table.units?.[table.names.indexOf(found)]).filter((unit) => unit !== undefined);
    const unit = units.every((other) => other === units[0]) ? units[0] : '';
    if (x?.length && moving.length) charts.push({ group, title: withUnit(title, unit), lines: moving, ...more });
  };
  const { balance, terms, newton, contact, probes, joints, watch } = tables;
  if (balance) {
    for (const [title, names] of BALANCE) put('Balance', title, balance, names, { least: title === 'Angular momentum' ? roundOff(run, balance) : 0 });
    const drift = changes(balance);
    charts.push({ group: 'Balance', title: 'Change since the start', isLog: true, lines: drift });
  }
  if (terms) {
    for (const [end, title] of TERMS) put('Balance', title, terms, terms.names.filter((name) => name.endsWith(`.${end}`)));
  }
  if (contact) {
    for (const [title, names] of CONTACT) put('Contact', title, contact, names);
    charts.push(...byPair(contact));
    for (const [title, names] of together(contact)) put('Contact', title, contact, names);
  }
  if (newton) {
    put('Solver', 'Iterations a step', newton, ['iterations']);
    put('Solver', 'Last residual', newton, ['last residual'], { isLog: true });
  }
  if (balance) charts.push(stepSize(run, balance));
  if (probes) for (const [title, names] of together(probes)) put('Probes', title, probes, names);
  if (joints) {
    for (const [title, names] of together(joints)) put('Joints', title.replace(/[.]([a-z]+)$/, (_, end) => JOINT[end] ?? `.${end}`), joints, names);
  }
  if (watch) for (const [title, names] of WATCH) put('Watch', title, watch, names);
  for (const chart of charts) chart.unit = unitOf(run, 'time');
  // A run that failed in its first step has no line of some.
  return charts.filter(({ lines }) => lines.some(({ x }) => x.length));
}

function column(table, name) {
  return table.values[table.names.indexOf(name)];
}

/** Sums of a pair of surfaces that belong into one chart with those of the other pairs. */
const PAIR = [
  ['Contact force by pair', ['force_x', 'force_y', 'force_z']],
  ['Contact area by pair', ['area']],
  ['Frictional work by pair', ['friction_work']],
];

/** Size of the force, area and frictional work of each pair, from the columns `PAIR.force_x` and so on. */
function byPair(contact) {
  const x = column(contact, 'time');
  const pairs = contact.names.filter((name) => name.endsWith('.force_x')).map((name) => name.slice(0, -'.force_x'.length));
  const line = (pair, parts) => {
    const columns = parts.map((part) => column(contact, `${pair}.${part}`)).filter(Boolean);
    const value = (k) => (columns.length > 1 ? Math.hypot(...columns.map((values) => values[k])) : columns[0][k]);
    return columns.length ? { name: pair, x, y: x.map((_, k) => (columns.some((values) => values[k] === null) ? null : value(k))) } : null;
  };
  const charts = PAIR.map(([title, parts]) => ({ group: 'Contact', title, lines: pairs.map((pair) => line(pair, parts)).filter(Boolean) }));
  return charts.filter(({ lines }) => lines.some(({ y }) => y.some((value) => value)));
}

/** The end of the name of a component, of a vector or of a tensor. */
const COMPONENT = /(?:^[lj]|[._]|[.][fm])([xyz]{1,2})$/;

/** Columns of a table that belong into one chart, those that are components of the same; without those of known charts. */
function together(table) {
  const known = ['step', 'time', ...CONTACT.flatMap(([, names]) => names)];
  const groups = new Map();
  const isOfPair = (name) => /[.](area|friction_work)$/.test(name);
  for (const name of table.names.filter((found) => !known.includes(found) && !isOfPair(found))) {
    const stem = name.replace(/[xyz]{1,2}$/, (end) => (COMPONENT.test(name) ? '' : end)).replace(/[._]$/, '');
    groups.set(stem, [...(groups.get(stem) ?? []), name]);
  }
  return groups;
}

/** Name of a line: that of the component, if it is one. */
function nameOf(name) {
  return COMPONENT.exec(name)?.[1] ?? name.replace(/^.*[.]/, '').replaceAll('_', ' ');
}

/** An angular momentum that is nothing beside the linear one at the far side of the picture. */
function roundOff(run, balance) {
  const largest = Math.max(...['lx', 'ly', 'lz'].flatMap((name) => column(balance, name) ?? [0]).map(Math.abs));
  return run.animation ? 1e-9 * largest * size(run.animation.edges) : 0;
}

/** A stair: a step has its size from its beginning on. Logarithmic if sizes are far apart. */
function stepSize(run, balance) {
  const [time, dt] = [column(balance, 'time'), column(balance, 'dt')];
  const x = time.flatMap((end, k) => (k ? [time[k - 1], end] : []));
  const y = dt.flatMap((step, k) => (k ? [step, step] : []));
  const steps = dt.filter((step) => step > 0);
  const isLog = steps.reduce((a, b) => Math.max(a, b), 0) > 20 * steps.reduce((a, b) => Math.min(a, b), Infinity);
  return { group: 'Solver', title: withUnit('Step size', unitOf(run, 'time')), lines: [{ name: 'step', x, y }], isLog, marks: decisions(run) };
}

/** Size of the change of momenta and energy. */
function changes(balance) {
  const x = column(balance, 'time');
  const of = (name, names) => {
    const columns = names.map((found) => column(balance, found)).filter(Boolean);
    return { name, x, y: x.map((_, k) => Math.hypot(...columns.map((values) => values[k] - values[0]))) };
  };
  const lines = [of('linear momentum', ['lx', 'ly', 'lz']), of('angular momentum', ['jx', 'jy', 'jz']), of('total energy', ['total'])];
  return lines.filter(({ y }) => y.some((value) => value > 0));
}

/** Cuts, growths, stages and warnings, with their reasons. */
function decisions(run) {
  const colours = { Cut: '#c8553d', Grow: '#4f9a5b', Shrink: '#e08a3c', Stage: '#2f6db3' };
  return (run.summary?.decisions ?? []).map(({ time, kind, reason, dt }) => ({
    x: time,
    colour: colours[kind] ?? '#b8860b',
    text: `t = ${text(time)}: ${kind.toLowerCase()} at step size ${text(dt)}: ${reason}`,
  }));
}

/** The charts of several runs in one: those of one group and title together. Lines differ by colour in one run, by dashes in several runs, whose colours differ. */
function overlaid(runs) {
  const charts = new Map();
  runs.forEach((run, r) => {
    for (const chart of curvesOf(run)) {
      const key = `${chart.group}/${chart.title}`;
      const found = charts.get(key) ?? { ...chart, series: [], marks: [] };
      chart.lines.forEach((line, k) => {
        const several = runs.length > 1;
        found.series.push({
          ...line,
          colour: several ? runColour(r, runs.length) : COLOURS[k % COLOURS.length],
          dash: several ? Object.keys(DASHES)[k % 5].split(',').filter(Boolean).map(Number) : [],
        });
      });
      found.marks.push(...(chart.marks ?? []));
      charts.set(key, found);
    }
  });
  return [...charts.values()];
}
