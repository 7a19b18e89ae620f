"""Meshes of arrays, of meshio and of PyVista."""

import numpy as np

from . import _native

# Names of cells (meshio's, and those of scenes) and VTK's types.
_SOLIDS = {
    "tetra": 10, "tet4": 10,
    "hexahedron": 12, "hex8": 12,
    "wedge": 13, "wedge6": 13,
    "tetra10": 24, "tet10": 24,
    "hexahedron20": 25, "hex20": 25,
    "wedge15": 26,
    "hexahedron27": 29, "hex27": 29,
}  # fmt: skip
_VTK = set(_SOLIDS.values())
_TRIANGLE, _QUAD = 5, 9
_NAMES = {"triangle": _TRIANGLE, "quad": _QUAD, **_SOLIDS}


def _type(name, place):
    if isinstance(name, str):
        if name not in _NAMES:
            raise TypeError(f"{place}: {name!r} is no cell that Stoss knows: give one of {', '.join(sorted(_NAMES))}")
        return _NAMES[name]
    return int(name)


def _blocks(cells):
    """Pairs of VTK's type and nodes (m, k), of a dict or of a list of pairs or of meshio's blocks."""
    pairs = cells.items() if isinstance(cells, dict) else cells
    blocks = []
    for number, pair in enumerate(pairs):
        name, nodes = (pair.type, pair.data) if hasattr(pair, "data") and hasattr(pair, "type") else pair
        nodes = np.asarray(nodes, dtype=np.int64)
        if nodes.ndim != 2:
            raise ValueError(f"cells[{number}]: an array of shape (cells, nodes) is needed, and this has {nodes.ndim} dimensions")
        blocks.append((_type(name, f"cells[{number}]"), nodes))
    return blocks


def _numbers(members, place):
    members = np.asarray(members)
    return np.flatnonzero(members) if members.dtype == bool else members.astype(np.int64).ravel()


class Mesh:
    """A mesh of solid elements, for ``mesh`` of a body.

    ``points``: array (n, 3), lengths. ``cells``: dict or pairs of a name (``"hexahedron"``, ``"tetra10"``, ...) or VTK's type, and an array (m, k) of
    numbers of points in VTK's order. ``sets``: nodes by name, as numbers or as a mask (n,); where the nodes of a set are those of facets of the boundary it is a
    surface, so that contact and pressure may act on it. ``cell_sets``: cells by name, counted through all blocks.
    """

    def __init__(self, points, cells, sets=None, cell_sets=None):
        self.points = np.ascontiguousarray(points, dtype=float)
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise ValueError(f"points: an array of shape (n, 3) is needed, and this has the shape {self.points.shape}")
        self.cells = [(kind, nodes) for kind, nodes in _blocks(cells) if kind in _VTK]
        if not self.cells:
            raise ValueError("cells: there is no solid element among them: give hexahedra, tetrahedra or wedges")
        self.sets = {name: _numbers(nodes, name) for name, nodes in (sets or {}).items()}
        self.cell_sets = {name: _numbers(numbers, name) for name, numbers in (cell_sets or {}).items()}

    @classmethod
    def of(cls, mesh, sets=None):
        """Of a mesh of meshio (``points``, ``cells``, ``point_sets``) or of PyVista (``points``, ``cells_dict``); ``sets`` are added to its own. Cells without a volume are left out."""
        if isinstance(mesh, cls):
            return mesh if not sets else cls(mesh.points, mesh.cells, {**mesh.sets, **sets}, mesh.cell_sets)
        if not hasattr(mesh, "points"):
            raise TypeError(f"a {type(mesh).__name__} is no mesh: it has no points")
        points, own, cell_sets = np.asarray(mesh.points, dtype=float), {}, {}
        if points.ndim == 2 and points.shape[1] == 2:
            points = np.column_stack([points, np.zeros(len(points))])
        # Both meshio and PyVista have a `cells_dict`; PyVista's has VTK's types as keys, and its order is that of the types.
        if hasattr(mesh, "point_sets") and hasattr(mesh, "cells"):
            keep = [i for i, block in enumerate(mesh.cells) if _NAMES.get(block.type) in _VTK]
            blocks = [mesh.cells[i] for i in keep]
            own = {name: _numbers(nodes, name) for name, nodes in (mesh.point_sets or {}).items()}
            starts = np.concatenate([[0], np.cumsum([len(block.data) for block in blocks])]).astype(int)
            for name, members in (getattr(mesh, "cell_sets", None) or {}).items():
                parts = [starts[k] + np.asarray(members[i], dtype=int) for k, i in enumerate(keep) if members[i] is not None]
                cell_sets[name] = np.concatenate([np.empty(0, dtype=int), *parts])
        elif hasattr(mesh, "cells_dict"):
            blocks = [(int(kind), nodes) for kind, nodes in mesh.cells_dict.items() if int(kind) in _VTK]
        else:
            raise TypeError(f"a {type(mesh).__name__} is no mesh that Stoss knows: give one of meshio, a PyVista UnstructuredGrid, or stoss.Mesh(points, cells)")
        if not blocks:
            raise ValueError("the mesh has no solid elements: give hexahedra, tetrahedra or wedges (of a surface: stoss.Surface)")
        return cls(points, blocks, {**own, **(sets or {})}, cell_sets)

    def write(self, path):
        """Writes a VTK file (``.vtu``) with the sets."""
        sets = {name: list(map(int, nodes)) for name, nodes in self.sets.items()}
        cell_sets = {name: list(map(int, numbers)) for name, numbers in self.cell_sets.items()}
        _native.write_mesh(path, self.points, self.cells, sets, cell_sets)

    def __repr__(self):
        return f"<Mesh: {len(self.points)} points, {sum(len(nodes) for _, nodes in self.cells)} cells, sets {sorted(self.sets)}>"


class Surface:
    """A surface of triangles for ``surface`` of a rigid body: ``points`` (n, 3), ``triangles`` (m, 3), numbered so that the normal points outward."""

    def __init__(self, points, triangles):
        self.points = np.asarray(points, dtype=float)
        self.triangles = np.asarray(triangles, dtype=np.int64)
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise ValueError(f"points: an array of shape (n, 3) is needed, and this has the shape {self.points.shape}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"triangles: an array of shape (m, 3) is needed, and this has the shape {self.triangles.shape}")

    @classmethod
    def of(cls, mesh):
        """Of a PyVista PolyData (of triangles: ``mesh.triangulate()``) or of the triangles of a mesh of meshio."""
        if isinstance(mesh, cls):
            return mesh
        if hasattr(mesh, "regular_faces"):
            return cls(mesh.points, mesh.regular_faces)
        triangles = [block.data for block in mesh.cells if block.type == "triangle"]
        if not triangles:
            raise ValueError("the mesh has no triangles")
        return cls(mesh.points, np.concatenate(triangles))

    def write(self, path):
        """Writes an STL file."""
        corners = self.points[self.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals / np.where(lengths > 0, lengths, 1)
        lines = ["solid surface"]
        for normal, triangle in zip(normals.tolist(), corners.tolist()):
            lines.append("facet normal {!r} {!r} {!r}\nouter loop".format(*normal))
            lines += ["vertex {!r} {!r} {!r}".format(*corner) for corner in triangle]
            lines.append("endloop\nendfacet")
        lines.append("endsolid surface\n")
        with open(path, "w", encoding="ascii") as file:
            file.write("\n".join(lines))


def is_mesh(value):
    """Whether a value in a scene stands for a mesh file."""
    return isinstance(value, (Mesh, Surface)) or (hasattr(value, "points") and (hasattr(value, "cells") or hasattr(value, "regular_faces")))
