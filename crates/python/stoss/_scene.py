"""Scenes: files, dicts, or built by methods."""

import contextlib
import copy
import json
import os
import pathlib
import re
import tempfile

from . import _native, _toml
from ._errors import OutputError, SceneError
from ._mesh import Mesh, Surface, is_mesh

# Folder of a scene that is not a file, in the folder of the results.
_FOLDER = "scene"

# Tables that a scene has once; all others are lists.
_SINGLE = {"scene", "parameters", "sweep", "time", "solver", "gravity", "general_contact", "sets", "output", "watch", "expect"}
_LISTS = {
    "body", "rigid", "beam", "string", "mass", "set", "contact", "tie", "joint", "spring", "prescribe", "load", "support", "event", "stage", "probe",
    "left_out",
}  # fmt: skip


class Scene(dict):
    """A scene as a dict, with a method for each of its tables that adds one and returns the scene:

    >>> scene = stoss.Scene("Drop test", kind="dynamic", units="mm-t-s")
    >>> scene.time(end=1e-3, step=1e-5, integrator={"scheme": "energy-momentum"})
    >>> scene.body("block", mesh={"generator": "block", "size": [10, 10, 10], "divisions": [4, 4, 4]}, material={...})

    Keys are those of the scene's reference (docs/guide/reference.md). Where a scene has a name as its key, it is the first argument. ``mesh`` of a body may be a
    :class:`stoss.Mesh` or a mesh of meshio or PyVista, ``surface`` of a rigid body a :class:`stoss.Surface`. Paths of files are relative to ``folder`` (the current
    directory if left out).
    """

    def __init__(self, title=None, *, folder=None, **header):
        super().__init__()
        self.folder = pathlib.Path(folder or ".")
        if isinstance(title, dict):
            self.update(copy.copy(title))
        elif title is not None or header:
            self["scene"] = {"title": title, **header}

    @classmethod
    def read(cls, path):
        """Of a scene file."""
        path = pathlib.Path(path)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise OutputError(f"cannot read the scene {path}: {error}") from None
        return cls(json.loads(_native.toml_to_json(text)), folder=path.parent)

    def __getattr__(self, table):
        if table in _SINGLE:

            def put(**keys):
                self.setdefault(table, {}).update(keys)
                return self

            return put
        if table in _LISTS:

            def add(name=None, **keys):
                self.setdefault(table, []).append({**({"name": name} if name is not None else {}), **keys})
                return self

            return add
        raise AttributeError(f"a scene has no table {table!r}: its tables are {', '.join(sorted(_SINGLE | _LISTS))}")

    def __dir__(self):
        return sorted(set(super().__dir__()) | _SINGLE | _LISTS)

    def to_toml(self):
        """The text of the scene; it has no meshes of arrays."""
        return _toml.dumps(self)

    def write(self, folder):
        """Writes ``scene.toml`` and the meshes into a folder, which the program can run too; returns the file."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        text = _toml.dumps(_with_files(dict(self), folder, self.folder, ""))
        file = folder / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return file


def _with_files(value, folder, base, place):
    """The value with meshes written into files, and with absolute paths."""
    if is_mesh(value):
        name = re.sub(r"[^A-Za-z0-9]+", "-", place).strip("-")
        surface = isinstance(value, Surface) or hasattr(value, "regular_faces")
        mesh, name = (Surface.of(value), name + ".stl") if surface else (Mesh.of(value), name + ".vtu")
        mesh.write(folder / name)
        return {"file": name}
    if isinstance(value, dict):
        # A mesh of arrays in the place of the path of a file: `{"file": mesh, "scale": 2}`.
        made = {}
        for key, inner in value.items():
            if key == "file" and isinstance(inner, (str, os.PathLike)):
                made[key] = str((pathlib.Path(base) / inner).resolve())
            elif key == "file" and is_mesh(inner):
                made.update(_with_files(inner, folder, base, place))
            else:
                made[key] = _with_files(inner, folder, base, f"{place}.{key}" if place else key)
        return made
    if isinstance(value, (list, tuple)):
        return [_with_files(inner, folder, base, f"{place}[{i}]") for i, inner in enumerate(value)]
    return value


def _put(scene, key, value):
    """Sets a key like ``time.step`` or ``body[0].density``, or ``body.ball.density`` of a table with a name."""
    parts = [part for part in re.split(r"[.\[\]]+", key) if part]
    at, way = scene, ""
    for number, part in enumerate(parts):
        last = number == len(parts) - 1
        if isinstance(at, list):
            if part.isdigit() and int(part) < len(at):
                part = int(part)
            else:
                names = [entry.get("name") for entry in at if isinstance(entry, dict)]
                if part not in names:
                    known = ", ".join(name for name in names if name)
                    raise SceneError(f"overrides[{key!r}]: {way} has no {part!r}; give a number below {len(at)}, or one of: {known}")
                part = names.index(part)
        elif not isinstance(at, dict):
            raise SceneError(f"overrides[{key!r}]: {way} is a value and has no {part!r}")
        if last:
            at[part] = value
        else:
            at = at.setdefault(part, {}) if isinstance(at, dict) else at[part]
        way = f"{way}.{part}" if way else str(part)


def split_overrides(overrides):
    """Parameters as texts, and keys of the scene."""
    parameters, keys = [], {}
    for name, value in (overrides or {}).items():
        if "." in name or "[" in name:
            keys[name] = value
        else:
            parameters.append((name, value if isinstance(value, str) else repr(float(value))))
    return parameters, keys


@contextlib.contextmanager
def named(path, is_scratch):
    """In messages on a scene in a temporary folder its file, which is gone then, is called ``scene``."""
    try:
        yield
    except SceneError as error:
        if is_scratch:
            error.args = (str(error).replace(str(path), "scene"),)
            error.problems = [problem._replace(file="scene") for problem in error.problems]
        raise


def file_of(scene, overrides, folder):
    """The file of a scene and its parameters: the file itself, or one that is written into the folder ``folder()``."""
    parameters, keys = split_overrides(overrides)
    if isinstance(scene, (str, os.PathLike)):
        if not keys:
            return pathlib.Path(scene), parameters
        scene = Scene.read(scene)
    if not isinstance(scene, dict):
        raise TypeError(f"a {type(scene).__name__} is no scene: give the path of a scene file, a dict or a stoss.Scene")
    if not isinstance(scene, Scene):
        scene = Scene(scene)
    if keys:
        folder_of_files, scene = scene.folder, Scene(_copied(scene), folder=scene.folder)
        for key, value in keys.items():
            _put(scene, key, value)
        scene.folder = folder_of_files
    return scene.write(folder() / _FOLDER), parameters


def _copied(value):
    """Dicts and lists are copied, meshes and arrays are not."""
    if isinstance(value, dict):
        return {key: _copied(inner) for key, inner in value.items()}
    return [_copied(inner) for inner in value] if isinstance(value, (list, tuple)) else value


class Plan(str):
    """What a run would use, in lines; ``warnings`` has those of them that need attention."""

    @property
    def warnings(self):
        return [line.strip()[len("warning: ") :] for line in self.splitlines() if line.strip().startswith("warning: ")]

    def __repr__(self):
        return str(self)


def check(scene, overrides=None):
    """Checks a scene without running it; returns the plan of its run (:class:`Plan`).

    Raises :class:`SceneError` with all problems of the scene at once.
    """
    with tempfile.TemporaryDirectory(prefix="stoss-") as folder:
        path, parameters = file_of(scene, overrides, lambda: pathlib.Path(folder))
        is_scratch = pathlib.Path(folder) in path.parents
        with named(path, is_scratch):
            plan = _native.check(path, parameters)
        return Plan(plan.replace(str(path), "scene") if is_scratch else plan)
