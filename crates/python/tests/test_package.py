"""The package itself: stubs, documentation, the notebook."""

import ast
import inspect
import pathlib

import pytest
import stoss
from conftest import ROOT

PACKAGE = pathlib.Path(stoss.__file__).parent


def test_stubs_have_what_the_package_has():
    assert (PACKAGE / "py.typed").is_file()
    stubs = ast.parse((PACKAGE / "__init__.pyi").read_text())
    classes = {node.name: node for node in stubs.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stubs.body if isinstance(node, ast.FunctionDef)}
    for name in stoss.__all__:
        item = getattr(stoss, name)
        if not inspect.isclass(item):
            assert name in functions or name.startswith("__"), name
            continue
        stub = classes[name]
        named = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
        named |= {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
        own = {key for key, value in vars(item).items() if not key.startswith("_") and (callable(value) or isinstance(value, (property, classmethod)))}
        # What dict, Mapping, Sequence and exceptions bring is not repeated.
        assert own <= named, (name, own - named)


def test_everything_public_is_documented():
    for name in stoss.__all__:
        item = getattr(stoss, name)
        if inspect.isclass(item):
            assert item.__doc__, name
            for key, value in vars(item).items():
                is_public = not key.startswith("_") and (inspect.isfunction(value) or isinstance(value, property))
                if is_public and key not in ("run", "summary", "outcome", "verdict", "reasons", "warnings"):
                    assert (value.__doc__ or "").strip(), f"{name}.{key}"
        elif callable(item):
            assert item.__doc__, name


def test_the_notebook_runs(tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    path = ROOT / "docs/tutorials/python.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs are not committed"
    # Assertions are in its cells: each job has its formula beside it.
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
