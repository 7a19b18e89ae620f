"""Results of a run."""

import csv
import html
import json
import pathlib
import warnings
from collections.abc import Mapping, Sequence

import numpy as np

from . import _native
from ._errors import OutputError, StossWarning


class Table(Mapping):
    """Columns by name, arrays (rows,): a dict of arrays. :meth:`to_pandas` makes a DataFrame of it."""

    def __init__(self, columns):
        self._columns = columns

    def __getitem__(self, name):
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"there is no column {name!r}; columns are {', '.join(self._columns)}") from None

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(self._columns)

    def vector(self, name):
        """The columns ``name.x``, ``name.y``, ``name.z`` as an array (rows, 3)."""
        return np.column_stack([self[f"{name}.{axis}"] for axis in "xyz"])

    def to_pandas(self):
        """A pandas DataFrame (needs pandas)."""
        import pandas

        return pandas.DataFrame(dict(self._columns))

    def _repr_html_(self):
        try:
            return self.to_pandas()._repr_html_()
        except ImportError:
            return f"<pre>{html.escape(repr(self))}</pre>"

    def __repr__(self):
        rows = len(next(iter(self._columns.values()), ()))
        return f"<Table: {rows} rows; columns {', '.join(self._columns)}>"


def _number(text):
    try:
        return float(text)
    except ValueError:
        return None


def read_table(path):
    """A table with comma-separated values; columns of numbers as float (an empty cell is nan), others as text. A last row that is being written is left out."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    rows = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))
    columns = {}
    for k, name in enumerate(rows[0]):
        words = [row[k] for row in rows[1:]]
        numbers = [float("nan") if word == "" else _number(word) for word in words]
        array = np.array(words) if None in numbers else np.array(numbers, dtype=float)
        if name in ("step", "stage", "iteration", "active") and array.dtype == float and np.isfinite(array).all():
            array = array.astype(np.int64)
        array.flags.writeable = False
        columns[name] = array
    return Table(columns)


class Frame:
    """A stored frame.

    ``time``; ``points``: reference positions (n, 3); ``displacement``: (n, 3) if it is stored; ``cells``: numbers of nodes and nodes, cell after cell (as VTK has
    them); ``cell_types``: VTK's types (m,); ``point_data``, ``cell_data``: arrays by name, (n,) or (n, k). The cell field ``body`` counts the names of
    :attr:`Run.bodies`.
    """

    def __init__(self, parts):
        self.time = parts["time"]
        self.points = parts["points"]
        self.cells = parts["cells"]
        self.cell_types = parts["cell_types"]
        self.point_data = parts["point_data"]
        self.cell_data = parts["cell_data"]

    @property
    def positions(self):
        """Present positions (n, 3), lengths; the reference positions if the frame has no displacement."""
        displacement = self.point_data.get("displacement")
        return self.points if displacement is None else self.points + displacement

    def __getitem__(self, name):
        """An array on points, or else on cells."""
        for data in (self.point_data, self.cell_data):
            if name in data:
                return data[name]
        raise KeyError(f"the frame has no field {name!r}; it has {', '.join([*self.point_data, *self.cell_data])}")

    def to_pyvista(self, deformed=True):
        """A PyVista UnstructuredGrid with all fields (needs pyvista), at the present positions or at those of the start."""
        import pyvista

        grid = pyvista.UnstructuredGrid(np.array(self.cells), np.array(self.cell_types), np.array(self.positions if deformed else self.points))
        for name, values in self.point_data.items():
            grid.point_data[name] = np.array(values)
        for name, values in self.cell_data.items():
            grid.cell_data[name] = np.array(values)
        grid.field_data["time"] = [self.time]
        return grid

    def __repr__(self):
        return f"<Frame: t = {self.time:.6g}, {len(self.points)} points, {len(self.cell_types)} cells, fields {', '.join([*self.point_data, *self.cell_data])}>"


class Frames(Sequence):
    """The frames of a run in the order of time; each is read when it is asked for. ``times``: array (frames,)."""

    def __init__(self, out, _scratch=None):
        self._out = pathlib.Path(out)
        self._scratch = _scratch
        times, self.bodies, notes = _native.frames(self._out)
        self.times = np.array(times)
        self.times.flags.writeable = False
        for note in notes:
            warnings.warn(note, StossWarning, stacklevel=3)

    def __len__(self):
        return len(self.times)

    def __getitem__(self, number):
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        place = number + len(self) if number < 0 else number
        if not 0 <= place < len(self):
            raise IndexError(f"there is no frame {number}: there are {len(self)}")
        return Frame(_native.frame(self._out, place))

    def at(self, time):
        """The frame whose time is nearest."""
        if not len(self):
            raise IndexError("there are no frames")
        return self[int(np.abs(self.times - time).argmin())]

    def __repr__(self):
        return f"<Frames: {len(self)} of {self._out}>"


class Page:
    """The page of a run: ``path`` is its file; a notebook shows it."""

    def __init__(self, path):
        self.path = pathlib.Path(path)

    def _repr_html_(self):
        text = html.escape(self.path.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{text}" style="width:100%;height:760px;border:0"></iframe>'

    def __fspath__(self):
        return str(self.path)

    def __repr__(self):
        return f"<Page: {self.path}>"


class Run:
    """Results of a run: an opened folder.

    >>> run = stoss.Run("ball-plate.out")
    >>> run.probes["force.z"], run.balance["total"], run.frames[-1].positions

    ``out``: the folder; ``summary``: ``summary.json`` as a dict; ``outcome``: ``"completed"``, ``"stopped"``, ``"interrupted"``, ``"failed"`` or ``"running"``;
    ``verdict``: ``"sound"``, ``"doubtful"`` or ``"wrong"``; ``reasons``: what the watch found, in words.
    """

    def __init__(self, out, _scratch=None):
        self.out = pathlib.Path(out)
        # A folder that nobody has named goes with the last object that shows it.
        self._scratch = _scratch
        if not self.out.is_dir():
            raise OutputError(f"{self.out}: there is no such folder of results")

    def _table(self, name, what):
        path = self.out / name
        if not path.is_file():
            raise OutputError(f"{path}: the run has no table of {what}")
        return read_table(path)

    @property
    def summary(self):
        path = self.out / "summary.json"
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise OutputError(f"{path}: no results of a run") from None

    @property
    def outcome(self):
        return self.summary["outcome"]["kind"]

    @property
    def verdict(self):
        return self.summary["verdict"]["level"]

    @property
    def reasons(self):
        return [reason["sentence"] for reason in self.summary["verdict"]["reasons"]]

    @property
    def balance(self):
        """Energy and momenta of each step (``balance.csv``): a dict of arrays (steps + 1,)."""
        return self._table("balance.csv", "balances")

    @property
    def contact(self):
        """Contact in each step (``contact.csv``): a dict of arrays (steps + 1,)."""
        return self._table("contact.csv", "contact")

    @property
    def probes(self):
        """Probes of the scene (``probes.csv``): a dict of arrays (steps + 1,), ``name`` or ``name.x`` and so on, and ``time``."""
        return self._table("probes.csv", "probes: the scene has no [[probe]]")

    def table(self, name):
        """Another table of the folder, for instance ``"newton"`` or ``"joints"``."""
        return self._table(f"{name}.csv", name)

    @property
    def frames(self):
        """The stored frames (:class:`Frames`)."""
        return Frames(self.out, self._scratch)

    @property
    def bodies(self):
        """Names of the bodies, by the number that the cell field ``body`` has."""
        return self.frames.bodies

    @property
    def diagnosis(self):
        """Why the run stopped or came out wrong (``diagnosis.json`` as a dict); None if there is nothing to tell."""
        path = self.out / "diagnosis.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None

    def judge(self):
        """Judges the stored frames and balances again; the verdict in words."""
        return _native.judge(self.out)

    def report(self):
        """Writes the page of the run (``report.html``); in a notebook it is shown."""
        path, notes = _native.write_page(self.out)
        for note in notes:
            warnings.warn(note, StossWarning, stacklevel=2)
        return Page(path)

    def __repr__(self):
        summary = self.summary
        return f"<Run: {summary['title']!r}, {summary['outcome']['kind']} at t = {summary['time']:.6g}, {summary['steps']} steps, {summary['verdict']['level']}, in {self.out}>"
