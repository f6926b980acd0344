import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from gapath.pipelines.page import figures
from gapath.pipelines.reading.collect import Collected, read_trials
from gapath.running.naming import Method
from gapath.store.records import (
    CONFIG,
    MANIFEST,
    TRIALS,
    FileEntry,
    Manifest,
    RunRecord,
    find_runs,
)
from gapath.store.runfolder import LOCK, RunFolder
from gapath.store.settings import nested, read_settings
from gapath.store.status import STATUS, RunState, Status
from gapath.task import find_task, results

from .synthetic import (
    MAPS,
    NOTHING,
    PLANNERS,
    drive_settings,
    make_drives,
    make_map,
    make_trials,
    plan_settings,
    write_drive_log,
    write_log,
)

DATE = "2026-01-01T12:00:00"


def shown_by(artist):
    """What there is to be seen of a part of a figure."""
    look = artist.get_label(), artist.get_visible(), artist.get_alpha()
    match artist:
        case Line2D():
            line = artist.get_color(), artist.get_linestyle(), artist.get_marker()
            return look, line, artist.get_xydata().tobytes()
        case Text():
            return look, artist.get_text(), artist.get_position(), artist.get_color()
        case Patch():
            return look, artist.get_facecolor(), artist.get_path().vertices.tobytes()
        case Collection():
            drawn = artist.get_offsets(), artist.get_facecolors(), artist.get_edgecolors()
            paths = [path.vertices.tobytes() for path in artist.get_paths()]
            return look, [np.asarray(each).tobytes() for each in drawn], paths
        case AxesImage():
            return look, artist.get_extent(), np.ma.filled(artist.get_array(), 0).tobytes()
    return ()


def shown_in(canvas):
    """What there is to be seen in a figure, but for ticks and where its panels lie."""
    for panel in canvas.axes:
        yield panel.get_xlim(), panel.get_ylim(), panel.get_xlabel(), panel.get_ylabel()
        yield panel.get_xscale(), panel.get_yscale()
    parts = [part for each in (canvas, *canvas.axes) for part in each.get_children()]
    legends = [part for part in parts if isinstance(part, Legend)]
    parts += [part for each in legends for part in (*each.get_texts(), *each.legend_handles)]
    yield from map(shown_by, parts)


@pytest.fixture
def undrawn(request, monkeypatch):
    """Do not draw figures, which takes most of the time: their files are a hash of what they show.

    Tests that are marked "drawn" draw them, in a module whose others do not.
    """
    if request.node.get_closest_marker("drawn"):
        return

    def save(canvas, file, *, format, **_):
        shown = hashlib.sha256(repr(list(shown_in(canvas))).encode())
        svg = f'<svg xmlns="http://www.w3.org/2000/svg"><style></style>{shown.hexdigest()}</svg>'
        file.write(svg.encode() if format == "svg" else b"\x89PNG" + shown.digest())

    monkeypatch.setattr(figures, "_raise_powers", lambda canvas: None)
    monkeypatch.setattr(Figure, "savefig", save)


def colours_of_lines(module, case, monkeypatch):
    """The colours of lines on maps that a module draws, and of those in the legends beside them."""
    canvases = []
    monkeypatch.setattr(module, "render", lambda canvas: canvases.append(canvas) or (b"", b""))
    module.section(*case)
    on_maps = [line for canvas in canvases for axes in canvas.axes for line in axes.lines]
    handles = [each for canvas in canvases for box in canvas.legends for each in box.legend_handles]
    in_legends = [each for each in handles if isinstance(each, Line2D)]
    return [{to_hex(line.get_color()) for line in lines} for lines in (on_maps, in_legends)]


def collect(folder: Path) -> Collected:
    """Read the trials of all runs below a folder."""
    return read_trials(find_runs(folder))


def manifest_of(method: Method, task: str, place: tuple[str, str], **known: Any) -> Manifest:
    """Make a manifest without files, of a run in the folder <experiment>/<key>."""
    experiment, key = place
    values = {
        "map": "kg18_test1", "map_instance": 0, "map_digest": "0", "start": "(0, 0)",
        "target": "(9, 9)", "map_inputs": {}, "method_inputs": {}, "late_inputs": {},
        "seed": 0, "trials": 1, **known,
    }  # fmt: skip
    tried = (experiment, values["map"], values["map_instance"], method.name, values["seed"])
    return Manifest(
        key=key, setting=" ".join(map(str, tried)), experiment=experiment, task=task,
        method=method.name, preset=method.preset, changes=dict(method.changes),
        command=f"gapath experiment={experiment}", versions={"gapath": "0"}, files={}, **values,
    )  # fmt: skip


def sign(folder: Path, manifest: Manifest | None = None, **changes: Any) -> None:
    """Write a manifest, by default the one that is there, for the files as they are now."""
    own = (MANIFEST, STATUS, LOCK)
    run = RunFolder(folder)
    entries = {
        path.name: FileEntry(run.sha256(path.name), path.stat().st_size)
        for path in sorted(folder.iterdir())
        if path.name not in own
    }
    replace(manifest or Manifest.read(folder), files=entries, **changes).write(run)


def summed(folder: Path) -> None:
    """Have the manifest say what was set and what came of it: `make_run` writes older ones."""
    rows = pd.read_parquet(folder / TRIALS)
    known = Manifest.read(folder)
    came = results(find_task(known.task), rows)
    sign(folder, settings=read_settings(folder / CONFIG), results=came)


def write_status(folder: Path, state: str, date: str = DATE, text: str = "") -> None:
    Status(RunState(state), date, date, text).write(RunFolder(folder))


def write_run(
    folder: Path, trials: pd.DataFrame, settings: Mapping[str, Any], manifest: Manifest, date: str
) -> None:
    """Write all of a run folder but its log, which is there already if it has one."""
    trials.to_parquet(folder / TRIALS)
    (folder / CONFIG).write_text(yaml.safe_dump(nested(settings)))
    sign(folder, manifest)
    write_status(folder, "done", date)


def record_of(
    preset: str, key: str, task: str = "plan", changes: Mapping[str, Any] = NOTHING, **known: Any
) -> RunRecord:
    """Make what is known of a run without its folder, its settings as if they had been read."""
    place = ("mine", key)
    manifest = manifest_of(Method(preset, changes), task, place, **known)
    run = RunRecord(Path(*place), Status(RunState.DONE, DATE, DATE), manifest, "")
    make = drive_settings if task == "drive" else plan_settings
    vars(run)["settings"] = make(preset, changes)
    return run


@pytest.fixture(scope="session")
def make_run() -> Callable[..., Path]:
    """Write one synthetic run folder."""

    def make(
        outputs: Path,
        experiment: str,
        map_name: str,
        planner: str,
        *,
        instance: int = 0,
        seed: int = 0,
        n: int = 20,
        log: bool = True,
        date: str = DATE,
        key: str = "",
    ) -> Path:
        grid = make_map(map_name, instance)
        key = (
            key
            or hashlib.sha256(
                f"{experiment} {map_name} {planner} {instance} {seed}".encode()
            ).hexdigest()
        )
        folder = outputs / experiment / key[:16]
        folder.mkdir(parents=True)
        trials = make_trials(grid, planner, experiment, seed, n)
        if log:
            write_log(folder, grid, trials)
        manifest = manifest_of(
            Method(planner), "plan", (experiment, folder.name), map=map_name,
            map_instance=instance, map_digest=grid.digest, seed=seed, trials=n,
        )  # fmt: skip
        write_run(folder, trials, plan_settings(planner), manifest, date)
        return folder

    return make


@pytest.fixture(scope="session")
def make_drive_run() -> Callable[..., Path]:
    """Write one synthetic run folder of drives."""

    def make(
        outputs: Path,
        experiment: str,
        map_name: str,
        preset: str,
        changes: Mapping[str, Any] = NOTHING,
        *,
        instance: int = 0,
        n: int = 12,
        log: bool = False,
    ) -> Path:
        grid = make_map(map_name, instance)
        method = Method(preset, changes)
        key = hashlib.sha256(f"{experiment} {map_name} {method.name} {instance}".encode())
        folder = outputs / experiment / key.hexdigest()[:16]
        folder.mkdir(parents=True)
        drives = make_drives(grid, method.name, experiment, n)
        if log:
            write_drive_log(folder, grid, drives)
        manifest = manifest_of(
            method, "drive", (experiment, folder.name), map=map_name, map_instance=instance,
            map_digest=grid.digest, trials=n,
        )  # fmt: skip
        write_run(folder, drives, drive_settings(preset, changes), manifest, DATE)
        return folder

    return make


@pytest.fixture(scope="session")
def drive_outputs(
    tmp_path_factory: pytest.TempPathFactory, make_drive_run: Callable[..., Path]
) -> Path:
    """Give the run folders of the experiments with drives; read only."""
    folder = tmp_path_factory.mktemp("drives")
    for name in ("kg18_map1", "kg18_map4"):
        for navigator in ("kg18", "kg18_astar", "replan_astar"):
            make_drive_run(folder, "drives", name, navigator, log=True)
            for instance in range(3):
                make_drive_run(folder, "drive_classes", name, navigator, instance=instance)
    varied = {
        "kg18": ({}, {"drive.sensor.range": 8}, {"drive.sensor.range": 10}),
        "kg18_astar": ({},),
    }
    for preset, all_changes in varied.items():
        for changes in all_changes:
            for instance in range(3):
                make_drive_run(
                    folder, "drive_choices", "kg18_map4", preset, changes, instance=instance
                )
    return folder


@pytest.fixture(scope="session")
def outputs(tmp_path_factory: pytest.TempPathFactory, make_run: Callable[..., Path]) -> Path:
    """Give the run folders of both KG18 experiments; read only."""
    folder = tmp_path_factory.mktemp("outputs")
    for name in MAPS:
        for planner in PLANNERS:
            make_run(folder, "table1", name, planner)
            for instance in range(3):
                make_run(folder, "classes", name, planner, instance=instance, n=4, log=False)
    return folder
