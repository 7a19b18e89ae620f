import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture
def scenes():
    return ROOT / "scenes"


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path, monkeypatch):
    """Results without a folder of their own go into the current one."""
    monkeypatch.chdir(tmp_path)


def flying(end=0.1, **load):
    """A block that flies, as a dict."""
    scene = {
        "scene": {"title": "A block in flight", "kind": "dynamic"},
        "time": {"end": end, "step": 0.01, "integrator": {"scheme": "energy-momentum"}},
        "body": [
            {
                "name": "block",
                "mesh": {"generator": "block", "size": [1.0, 1.0, 1.0], "divisions": [2, 2, 2]},
                "material": {"law": "neo-hooke", "young": 2250.0, "poisson": 0.3},
                "density": 1.0,
                "angular_velocity": [1.0, 2.0, 10.0],
            }
        ],
    }
    if load:
        scene["load"] = [load]
    return scene
