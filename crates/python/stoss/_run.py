"""Running scenes: at once, or step by step."""

import os
import pathlib
import signal
import tempfile
import threading
import warnings

import numpy as np

from . import _native
from ._errors import Interrupted, OptionError, StossWarning
from ._progress import Progress
from ._results import Run
from ._scene import file_of, named


class Step:
    """The state of a run after a step (or at its start, with ``number`` 0).

    Arrays are read-only, belong to this step, and keep their values. They are made when they are first asked for: ask before the run goes on. Rows of arrays (n, 3) and
    (n, 6) are the points of the frames; :attr:`bodies` says which are whose.
    """

    def __init__(self, session):
        self._session = session
        self._kept = {}
        self._last = session.last

    @property
    def number(self):
        """Number of the step; 0 is the start."""
        return self._last[0]

    @property
    def time(self):
        """Time at its end."""
        return self._last[1]

    @property
    def dt(self):
        """Its size, a time."""
        return self._last[2]

    @property
    def iterations(self):
        """Linear solutions that it took."""
        return self._last[3]

    @property
    def stage(self):
        """Number of the stage, from 1."""
        return self._last[4]

    def _of(self, name):
        if name not in self._kept:
            if self._session.last[0] != self._last[0]:
                raise OptionError(f"{name} of step {self._last[0]} was not asked for before the run went on: ask for it while it is the present step")
            self._kept[name] = getattr(self._session, name)
        return self._kept[name]

    @property
    def positions(self):
        """Present positions, array (n, 3), lengths."""
        return self._of("positions")

    @property
    def reference(self):
        """Positions at the start, array (n, 3), lengths."""
        return self._of("reference")

    @property
    def displacements(self):
        """Present positions less those at the start, array (n, 3), lengths."""
        if "displacements" not in self._kept:
            array = self.positions - self.reference
            array.flags.writeable = False
            self._kept["displacements"] = array
        return self._kept["displacements"]

    @property
    def velocities(self):
        """Velocities, array (n, 3), length per time."""
        return self._of("velocities")

    @property
    def stresses(self):
        """Cauchy stresses at the nodes, array (n, 6) in the order xx, yy, zz, xy, yz, xz, force per area; nan at points of no solid."""
        return self._of("stresses")

    @property
    def contact_forces(self):
        """Forces of contact on the nodes, array (n, 3)."""
        return self._of("contact_forces")

    @property
    def reactions(self):
        """Forces of prescribed motions on the nodes, array (n, 3)."""
        return self._of("reactions")

    @property
    def balance(self):
        """Energies and momenta by name: ``kinetic``, ``strain``, ``total`` and so on (energies), ``linear_momentum``, ``angular_momentum`` arrays (3,)."""
        return self._of("balance")

    @property
    def contact(self):
        """Contact, all pairs together: ``active``, ``closed``, ``released`` (numbers), ``min_gap`` (length), ``max_pressure``, ``force_on_slave`` (3,). None without contact."""
        return self._of("contact")

    @property
    def probes(self):
        """Values of the scene's probes by name: a number, or an array (k,) of one with components."""
        if "values" not in self._kept:
            values = {}
            for name, columns, row in self._of("probes"):
                values[name] = row[0] if len(columns) == 1 else np.array(row)
            self._kept["values"] = values
        return self._kept["values"]

    @property
    def bodies(self):
        """Slices of the points of each deformable body, by name: ``step.positions[step.bodies["ball"]]``."""
        return {name: slice(first, first + count) for name, first, count in self._of("bodies")}

    def set(self, name, values, until=None):
        """Sets a load or a prescribed motion that the run was started with as ``steered``.

        It goes linearly from its present values to ``values``, which it has at the time ``until`` (at the end of the next step if left out), and stays there. Of a load the values are its
        magnitudes in the order of its table, of a prescribed motion the displacements (lengths) of its components and then, if it rotates, the angle in degrees.
        """
        self._session.lead(name, np.atleast_1d(np.asarray(values, dtype=float)).tolist(), until)

    def get(self, name):
        """The present values of what is steered, array (k,)."""
        return self._session.steered(name)

    def __repr__(self):
        return f"<Step {self.number}: t = {self.time:.6g}>"


def _handler(session):
    """Lets the first Ctrl-C end the run after the present step, a second one at once. What it returns puts the old handler back."""
    if threading.current_thread() is not threading.main_thread():
        return lambda: None
    old = signal.getsignal(signal.SIGINT)
    # Whoever has a handler of their own shall have it called.
    if old is not signal.default_int_handler:
        return lambda: None

    def raised(number, frame):
        if session.is_stopped:
            raise KeyboardInterrupt
        session.stop()

    signal.signal(signal.SIGINT, raised)

    def restore():
        if signal.getsignal(signal.SIGINT) is raised:
            signal.signal(signal.SIGINT, old)

    return restore


class Steps:
    """A run that goes on when it is asked for its next step: an iterator over :class:`Step`, and a context that ends the run when it is left.

    ``start`` is the state at the start (or where it was resumed), ``run`` the results after the end (and up to now before it). Leaving the loop early leaves a folder that can be resumed.
    """

    def __init__(self, scene, overrides, out, until, resume, overwrite, steered, progress):
        self._scratch = None
        if out is None and not isinstance(scene, (str, os.PathLike)):
            self._scratch = tempfile.TemporaryDirectory(prefix="stoss-")
            out = pathlib.Path(self._scratch.name) / "results"
        out = pathlib.Path(out) if out is not None else pathlib.Path(pathlib.Path(scene).stem + ".out")
        path, parameters = file_of(scene, overrides, lambda: out)
        with named(path, self._scratch is not None):
            self._session = _native.Session(path, out, parameters, list(steered), until, resume, overwrite)
        self._warn(4)
        self.start = Step(self._session)
        title, end, _ = self._session.plan
        self._progress = Progress(title, end, progress)
        self._restore = _handler(self._session)
        self._ended = False

    def _warn(self, level):
        for text in self._session.warnings():
            warnings.warn(text, StossWarning, stacklevel=level)

    @property
    def out(self):
        """Folder of the results."""
        return self._session.out

    @property
    def run(self):
        """The results (:class:`stoss.Run`)."""
        return Run(self.out, self._scratch)

    def set(self, name, values, until=None):
        """As :meth:`Step.set`, also before the first step."""
        self.start.set(name, values, until)

    def __iter__(self):
        return self

    def __next__(self):
        if self._ended:
            raise StopIteration
        try:
            went_on = self._session.advance()
        except BaseException:
            self._leave()
            raise
        self._warn(3)
        if not went_on:
            self.close()
            raise StopIteration
        self._progress.show(self._session.last)
        return Step(self._session)

    def _leave(self):
        self._ended = True
        self._restore()
        self._progress.close(self._session.last)

    def close(self):
        """Ends the run after its last step: checkpoint, last frame, summary. Raises :class:`Interrupted` if Ctrl-C was the reason."""
        if self._ended:
            return
        self._leave()
        _, interrupted, _, _ = self._session.finish()
        self._warn(3)
        if interrupted:
            number, time = self._session.last[:2]
            raise Interrupted(f"ended after step {number} at t = {time:.6g}; go on with resume=True and out={str(self.out)!r}", self.run)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if error is None:
            self.close()
        elif not self._ended:
            # The error of the caller's code is what counts.
            self._leave()
            self._session.finish()

    def __del__(self):
        if not getattr(self, "_ended", True):
            try:
                self._leave()
                self._session.finish()
            except Exception:
                pass


def steps(scene, *, overrides=None, out=None, until=None, resume=False, overwrite=False, steered=(), progress=None):
    """Runs a scene step by step: an iterator over :class:`Step` that computes the next step when it is asked for it, without the interpreter's lock.

    Arguments are those of :func:`run`.
    """
    return Steps(scene, overrides, out, until, resume, overwrite, steered, progress)


def run(scene, *, overrides=None, out=None, until=None, resume=False, overwrite=False, steered=(), controller=None, progress=None):
    """Runs a scene; returns its results (:class:`stoss.Run`).

    scene: path of a scene file, dict or :class:`stoss.Scene`.
    overrides: values of parameters of the scene by name (numbers, or texts with expressions), and of keys like ``"time.step"``, ``"body[0].density"`` or ``"body.ball.density"``.
    out: folder of the results. Of a file its name with ``.out`` in the current directory; of a dict a temporary folder, which goes with the Run.
    until: stop after the first step that reaches this time.
    resume: continue from the checkpoint in ``out``.
    overwrite: start even if files in ``out`` would be replaced that Stoss did not write.
    steered: names of loads and prescribed motions that :meth:`Step.set` sets.
    controller: called with the :class:`Step` at the start and after each step; it may set what is steered.
    progress: True or False; if left out there is a bar in a terminal and in a notebook.

    Raises :class:`SceneError`, :class:`SimulationError`, :class:`OutputError`; after Ctrl-C :class:`Interrupted`, and the folder can be resumed.
    """
    with steps(
        scene, overrides=overrides, out=out, until=until, resume=resume, overwrite=overwrite, steered=steered, progress=progress
    ) as run:
        if controller is not None:
            controller(run.start)
        for step in run:
            if controller is not None:
                controller(step)
    return run.run
