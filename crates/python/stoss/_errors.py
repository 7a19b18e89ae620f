"""Exceptions: the messages of the program, with place and remedy."""

from typing import NamedTuple


class Problem(NamedTuple):
    """One problem of a scene."""

    file: str
    line: int
    column: int
    key: str
    value: str
    message: str
    remedy: str

    def __str__(self):
        key = f"{self.key} = {self.value}: " if self.value else f"{self.key}: " if self.key else ""
        return f"{self.file}:{self.line}:{self.column}: {key}{self.message}; {self.remedy}"


# Options of the program that messages name as a remedy, and what they are called here.
_WORDS = [
    ("--until ", "until="),
    ("with --out", "with out="),
    ("--out", "out="),
    ("with --force", "with overwrite=True"),
    ("without --resume", "without resume=True"),
    ("--resume", "resume=True"),
]


class StossError(Exception):
    """All errors of Stoss."""

    def __init__(self, message):
        for option, argument in _WORDS:
            message = message.replace(option, argument)
        super().__init__(message)


class SceneError(StossError, ValueError):
    """A scene is wrong. ``problems`` has all that was found at once (:class:`Problem`)."""

    def __init__(self, message, problems=()):
        super().__init__(message)
        self.problems = list(problems)


class OptionError(StossError, ValueError):
    """An argument does not fit the scene."""


class ResumeError(StossError, ValueError):
    """A folder cannot be resumed with this scene."""


class OutputError(StossError, OSError):
    """A file cannot be read or written."""


class SimulationError(StossError, RuntimeError):
    """A step failed at every size. All steps before it are in the folder ``out``.

    ``last_step``, ``last_time``: the last good state; ``verdict``: what the watch found up to there; ``diagnosis``: why, and what to try
    (text, or None).
    """

    def __init__(self, message, last_step=None, last_time=None, verdict=None, out=None, diagnosis=None):
        super().__init__(message if diagnosis is None else f"{message}\n{diagnosis}")
        self.last_step = last_step
        self.last_time = last_time
        self.verdict = verdict
        self.out = out
        self.diagnosis = diagnosis


class Interrupted(KeyboardInterrupt):
    """Ctrl-C has ended a run after a step. Its folder can be resumed: ``stoss.run(scene, out=..., resume=True)``; ``run`` has its results."""

    def __init__(self, message, run):
        super().__init__(message)
        self.run = run


class StossWarning(UserWarning):
    """What is no error but needs attention."""
