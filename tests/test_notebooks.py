"""The notebooks of examples/ and the pages of the library run, and show what they say."""

import json
import os
import re
import runpy
import shlex
import sys
import tempfile
import warnings
from pathlib import Path

import nbformat
import numpy as np
import pytest
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from matplotlib import pyplot
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from test_docs import ROOT, blocks, commands

import gapath
from gapath.commands import run as cli

NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
TIMEOUT = 120
"""Seconds a cell may take on a busy machine."""

SHOWS = {"plan": 5, "sweep": 3, "drive": 5}
"""How many cells of each show a picture."""

SAYS = {
    "plan": ["above the optimum", "gapath.GridMap", "gapath.Plan"],
    "sweep": ["200 of 200 found", "kg18_test2", "planner.population", "gapath.Run"],
    "drive": ["gapath.Drive", "True", "reached", "'Stepped'", "for who sees twice as far"],
}
"""What stands in the outputs of each."""


@pytest.fixture
def sockets():
    """A folder for sockets, whose path must be short."""
    with tempfile.TemporaryDirectory(prefix="gapath-") as folder:
        yield Path(folder)


@pytest.fixture
def execute(tmp_path, monkeypatch, sockets):
    """Execute a notebook in an empty folder; nothing that is installed elsewhere has a part."""
    kernel = tmp_path / "kernels" / "python3"
    kernel.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": command, "display_name": "this", "language": "python"}
    (kernel / "kernel.json").write_text(json.dumps(spec))
    for name in ("JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    work = tmp_path / "work"
    work.mkdir()

    def run(notebook):
        specs = KernelSpecManager(kernel_dirs=[str(kernel.parent)], ensure_native_kernel=False)
        manager = AsyncKernelManager(kernel_name="python3", kernel_spec_manager=specs)
        manager.transport, manager.ip = "ipc", str(sockets / "kernel")
        resources = {"metadata": {"path": str(work)}}
        client = NotebookClient(notebook, km=manager, timeout=TIMEOUT, resources=resources)
        return client.execute()

    return run


def outputs(cell):
    """Kind and content of everything that a cell puts out."""
    for output in cell.get("outputs", []):
        yield from output.get("data", {}).items()
        if output.output_type == "stream":
            yield output.name, output.text


def shows_a_picture(cell):
    return any(
        kind == "image/png" or (kind == "text/html" and "data:image/png;base64," in content)
        for kind, content in outputs(cell)
    )


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_what_it_says(path, execute):
    notebook = execute(nbformat.read(path, as_version=4))
    assert sum(map(shows_a_picture, notebook.cells)) == SHOWS[path.stem]
    everything = [each for cell in notebook.cells for each in outputs(cell)]
    text = "\n".join(content for kind, content in everything if kind != "image/png")
    assert [words for words in SAYS[path.stem] if words not in text] == []
    assert [content for kind, content in everything if kind == "stderr"] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_kept_without_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert cells and all(not cell.outputs and cell.execution_count is None for cell in cells)


def test_there_are_three():
    assert [path.stem for path in NOTEBOOKS] == sorted(SHOWS)


def test_a_notebook_that_fails_is_noticed(execute):
    cells = [nbformat.v4.new_code_cell("import gapath\ngapath.load_map('nowhere')")]
    with pytest.raises(CellExecutionError, match="nowhere"):
        execute(nbformat.v4.new_notebook(cells=cells))


def test_the_library_examples_of_the_commands_run(tmp_path, capfd):
    examples = blocks((ROOT / "docs" / "commands.md").read_text("utf-8"), "python")
    assert len(examples) == 2
    for example in examples:
        (tmp_path / "example.py").write_text(example)
        names = runpy.run_path(str(tmp_path / "example.py"))
    assert "a feasible path was found" in capfd.readouterr().out
    assert len(example.splitlines()) == 4, "three lines, and a blank one"
    best = pyplot.gca().lines[0].get_ydata()
    assert best.tolist() == names["plan"].evolution.best.tolist()
    assert (np.argmax(best < 1e5) + 1, len(best)) == (12, 100)  # as the picture's text says
    pyplot.close()


def test_the_page_of_the_library_does_what_it_says(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / "library.md"
    for command in commands(page)[:2]:
        monkeypatch.setattr("sys.argv", shlex.split(command))
        cli.main()
    capfd.readouterr()
    text = page.read_text("utf-8")
    Path("example.py").write_text("\n".join(blocks(text, "python")))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        runpy.run_path("example.py")
    printed = capfd.readouterr().out
    assert printed.startswith("FOUND") and printed.endswith("True\n")
    assert {"path.png", "epochs.gif"} <= {path.name for path in tmp_path.iterdir()}
    for name in set(re.findall(r"gapath\.(\w+)\(", text)) | {"InputError"}:
        assert name in gapath.__all__
    pyplot.close("all")
