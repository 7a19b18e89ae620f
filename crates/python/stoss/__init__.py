"""Stoss: deformable bodies that collide at large deformations, and systems of rigid bodies, beams, strings and joints with them.

>>> run = stoss.run("scene.toml", overrides={"speed": 2.0})
>>> print(run.verdict, run.balance["total"][-1])

Step by step, with a controller in Python:

>>> with stoss.steps("scene.toml", steered=["push"]) as steps:
...     for step in steps:
...         step.set("push", -50.0 * step.positions[:, 2].min())

Units are those of the scene: Stoss computes with numbers that fit together. Arrays are read-only and keep their values.
"""

from ._errors import (
    Interrupted,
    OptionError,
    OutputError,
    Problem,
    ResumeError,
    SceneError,
    SimulationError,
    StossError,
    StossWarning,
)
from ._mesh import Mesh, Surface
from ._native import __version__, set_threads
from ._results import Frame, Frames, Page, Run
from ._run import Step, Steps, run, steps
from ._scene import Plan, Scene, check

__all__ = [
    "Frame",
    "Frames",
    "Interrupted",
    "Mesh",
    "OptionError",
    "OutputError",
    "Page",
    "Plan",
    "Problem",
    "ResumeError",
    "Run",
    "Scene",
    "SceneError",
    "SimulationError",
    "Step",
    "Steps",
    "StossError",
    "StossWarning",
    "Surface",
    "__version__",
    "check",
    "run",
    "set_threads",
    "steps",
]
