'use strict';
// A chart of any column of the tables over any other, such as a force over a displacement.

class ColumnChart {
  constructor(panels) {
    this.panels = panels;
    const panel = panels.tab('Columns');
    [this.across, this.up] = ['across', 'up'].map((name) => element('select', { id: `column-${name}`, onchange: () => this.draw() }));
    for (const list of [this.across, this.up]) list.append(...this.groups());
    const swap = element('button', { type: 'button', textContent: 'swap', title: 'exchange the axes' });
    swap.onclick = () => {
      [this.across.value, this.up.value] = [this.up.value, this.across.value];
      this.draw();
    };
    panel.append(element('div', { className: 'choice' }, [element('label', {}, [this.up]), ' over ', element('label', {}, [this.across]), swap]));
    this.begin();
    this.draw();
  }

  /** Columns of all runs, by tables. */
  groups() {
    const tables = new Map();
    for (const { tables: found } of this.panels.runs) {
      for (const { name, names } of found) tables.set(name, new Set([...(tables.get(name) ?? []), ...names]));
    }
    const option = (table) => (name) => element('option', { value: `${table}/${name}`, textContent: name });
    return [...tables].map(([table, names]) => element('optgroup', { label: table }, [...names].map(option(table))));
  }

  /** At first the last columns of the probes, or the energies. */
  begin() {
    const options = [...this.across.options].map(({ value }) => value);
    const of = (table) => options.filter((value) => value.startsWith(`${table}/`) && !/[/](step|time|dt)$/.test(value));
    const [found] = ['probes', 'contact', 'balance'].map(of).filter((list) => list.length);
    if (found) [this.across.value, this.up.value] = [found[0], found[found.length - 1]];
  }

  draw() {
    const several = this.panels.runs.length > 1;
    const series = this.panels.runs.map((run, r) => {
      const points = joinedColumns(run, this.across.value, this.up.value);
      return points && { name: several ? run.name : words(this.up.value), ...points, colour: several ? runColour(r, this.panels.runs.length) : COLOURS[0] };
    }).filter(Boolean);
    const unit = (value) => this.panels.runs.map((run) => unitOfColumn(run, value)).find(Boolean);
    const over = withUnit(words(this.across.value), unit(this.across.value));
    const title = `${withUnit(words(this.up.value), unit(this.up.value))} over ${over}`;
    this.panels.replace('Columns', series.length ? [{ title, over, series }] : []);
  }
}

const words = (column) => column.slice(column.indexOf('/') + 1);

function columnOf(run, value) {
  const table = run.tables.find(({ name }) => value.startsWith(`${name}/`));
  const values = table && column(table, words(value));
  return values && { table, values };
}

function unitOfColumn(run, value) {
  const table = columnOf(run, value)?.table;
  return table?.units?.[table.names.indexOf(words(value))];
}

/** Two columns of a run at the times that both tables have: `{ x, y, times }`; nothing if there are none. */
function joinedColumns(run, across, up) {
  const [a, b] = [columnOf(run, across), columnOf(run, up)];
  const [ta, tb] = [a, b].map((found) => found && column(found.table, 'time'));
  if (!ta || !tb) return null;
  const out = { x: [], y: [], times: [] };
  ta.forEach((time, k) => {
    const other = a.table === b.table ? k : placeIn(tb, time * (1 + 1e-9));
    if (other < 0 || Math.abs(tb[other] - time) > 1e-9 * Math.abs(time)) return;
    out.times.push(time);
    out.x.push(a.values[k]);
    out.y.push(b.values[other]);
  });
  return out.times.length ? out : null;
}
