"""Scenes by methods, meshes of arrays, results."""

import numpy as np
import pytest
import stoss
from conftest import flying


def cube(n=2):
    """Hexahedra of a unit cube with arrays alone."""
    x = np.linspace(0.0, 1.0, n + 1)
    points = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    node = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    corner = lambda i, j, k: node[i : n + i, j : n + j, k : n + k].ravel()  # noqa: E731
    order = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    return points, np.stack([corner(*at) for at in order], axis=1)


def pressed(mesh):
    """A cube that is pressed by a prescribed motion, held by planes of symmetry."""
    scene = stoss.Scene("Pressed", kind="quasi-static").time(end=1.0, step=0.5)
    scene.body("cube", mesh=mesh, material={"law": "neo-hooke", "young": 1000.0, "poisson": 0.0})
    for side, component in [("left", "x"), ("front", "y"), ("bottom", "z")]:
        scene.prescribe(set=f"cube.{side}", components=[component], fixed=True)
    scene.prescribe(set="cube.top", components=["z"], displacement={"table": [[0.0, 0.0], [1.0, -0.2]]})
    return scene.probe("force", set="cube.top", quantity="reaction")


def sides(points):
    return {"left": points[:, 0] == 0, "front": points[:, 1] == 0, "bottom": points[:, 2] == 0, "top": points[:, 2] == 1}


def force(stretch):
    # Neo-Hooke without lateral contraction at small strains: mu (s - 1/s) + lambda ln(s) / s with lambda = 0 holds only as long as lateral
    # stretches are one, which lambda = 0 gives: P = mu (s - 1/s).
    return 500.0 * (stretch - 1.0 / stretch)


def test_a_mesh_of_arrays():
    points, cells = cube()
    mesh = stoss.Mesh(points, {"hexahedron": cells}, sets=sides(points))
    run = stoss.run(pressed(mesh))
    assert run.probes["force.z"][-1] == pytest.approx(force(0.8), rel=1e-9)
    assert run.bodies == ["cube"]


def test_meshes_of_meshio_and_pyvista():
    meshio, pyvista = pytest.importorskip("meshio"), pytest.importorskip("pyvista")
    points, cells = cube()
    masks = {name: np.flatnonzero(mask) for name, mask in sides(points).items()}
    for mesh in (
        meshio.Mesh(points, [("hexahedron", cells), ("line", [[0, 1]])], point_sets=masks),
        stoss.Mesh.of(pyvista.UnstructuredGrid({12: cells}, points), sets=masks),
    ):
        assert stoss.run(pressed(mesh)).probes["force.z"][-1] == pytest.approx(force(0.8), rel=1e-9)


def test_bad_meshes_are_named():
    points, cells = cube()
    with pytest.raises(stoss.SceneError, match="node 99 does not exist"):
        stoss.check(pressed(stoss.Mesh(points, {"hexahedron": np.where(cells == 0, 99, cells)})))
    with pytest.raises(stoss.SceneError, match="8 nodes, and the array has 4 columns"):
        stoss.check(pressed(stoss.Mesh(points, {12: cells[:, :4]})))
    with pytest.raises(ValueError, match="shape"):
        stoss.Mesh(points[:, :2], {12: cells})
    with pytest.raises(ValueError, match="no solid element"):
        stoss.Mesh(points, {"triangle": cells[:, :3]})
    with pytest.raises(stoss.SceneError, match="top"):
        stoss.check(pressed(stoss.Mesh(points, {12: cells})))


def test_a_rigid_surface_of_triangles():
    # Two triangles as a floor, on which the cube lies.
    floor = stoss.Surface([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    points, cells = cube()
    scene = stoss.Scene("On a floor", kind="quasi-static").time(end=1.0, step=1.0)
    scene.body("cube", mesh=stoss.Mesh(points, {12: cells}, sets=sides(points)), material={"law": "neo-hooke", "young": 1e3, "poisson": 0.0})
    scene.rigid("floor", surface=floor)
    scene.prescribe(rigid="floor", fixed=True)
    scene.prescribe(set="cube.top", components=["x", "y"], fixed=True)
    scene.prescribe(set="cube.top", components=["z"], displacement={"table": [[0, 0], [1, -0.1]]})
    scene.contact(method="nts", slave="cube.bottom", master="floor.all")
    with stoss.steps(scene) as steps:
        for step in steps:
            pass
    assert step.contact_forces[step.bodies["cube"], 2].sum() == pytest.approx(-force(0.9), rel=1e-9)
    assert step.contact["active"] == 9


def test_a_scene_reads_back(scenes):
    scene = stoss.Scene.read(scenes / "ball-plate.toml")
    assert scene["body"][0]["name"] == "ball" and scene["time"]["step"] == 0.01
    assert stoss.check(scene).splitlines()[1:8] == stoss.check(scenes / "ball-plate.toml").splitlines()[1:8]
    with pytest.raises(AttributeError, match="its tables are beam, body"):
        scene.bodies()


def test_toml_of_all_values():
    from stoss._native import toml_to_json
    import json
    import math

    value = {"a": 1, "b": True, "c": 'x"\n\x7fä', "d": 1e-300, "e": [1, [2.5]], "f": {"g h": np.float64(0.1)}, "n": None, "i": np.int32(3)}
    from stoss._toml import dumps

    back = json.loads(toml_to_json(dumps({"t": value, "l": [{"x": 1}, {"x": 2}]})))
    assert back == {"t": {"a": 1, "b": True, "c": 'x"\n\x7fä', "d": 1e-300, "e": [1, [2.5]], "f": {"g h": 0.1}, "i": 3}, "l": [{"x": 1}, {"x": 2}]}
    assert "inf" in dumps({"t": {"x": math.inf}})


def test_frames_page_and_tables(tmp_path):
    scene = flying()
    scene["probe"] = [{"name": "block", "body": "block", "quantity": "linear_momentum"}, {"name": "heat", "body": "block", "quantity": "kinetic_energy"}]
    run = stoss.run(scene, out="out")
    frames = run.frames
    assert len(frames) == 11 and frames.times[-1] == pytest.approx(0.1) and frames.at(0.052).time == pytest.approx(0.05)
    frame = frames[-1]
    assert frame.points.shape == (27, 3) and frame["displacement"].shape == (27, 3) and frame["cauchy_stress"].shape == (27, 6)
    assert list(frame.cell_types) == [12] * 8 and frame.cells.shape == (72,) and frame["body"].shape == (8,)
    with pytest.raises(IndexError, match="there are 11"):
        frames[11]
    assert len(frames[2:5]) == 3
    assert run.probes.vector("block").shape == (11, 3) and run.probes["heat"].shape == (11,)
    page = run.report()
    assert page.path.is_file() and page._repr_html_().startswith("<iframe")
    assert run.judge().startswith("sound")
    with pytest.raises(stoss.OutputError, match="contact"):
        run.contact  # noqa: B018
    with pytest.raises(stoss.OutputError, match="no such folder"):
        stoss.Run("nowhere")


def test_frames_for_pyvista():
    pytest.importorskip("pyvista")
    grid = stoss.run(flying()).frames[-1].to_pyvista()
    assert grid.n_cells == 8 and grid.n_points == 27 and "von_mises" in grid.point_data
    assert grid.compute_cell_sizes()["Volume"].sum() == pytest.approx(1.0, rel=0.05)


def test_tables_for_pandas():
    pandas = pytest.importorskip("pandas")
    assert isinstance(stoss.run(flying()).balance.to_pandas(), pandas.DataFrame)
