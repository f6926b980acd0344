"""Golden results: the same seed gives the same bytes, on every machine and however compiled.

`make reproduce` does the published experiments among them and says of each whether it is equal;
`make golden` accepts today's results; the difference then shows what changed.
"""

import contextlib
import hashlib
import io
import itertools
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from scale import whole

from gapath.api import load_map
from gapath.commands import run as cli
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.grid import GridMap
from gapath.kernels.lines import cuts_corner
from gapath.mapio.generated import CLASSES as GENERATED
from gapath.mapio.reconstructed import CLASSES
from gapath.problem import CornerCutting, Problem
from gapath.recorders import mcap
from gapath.running.config import Run, conf_folder
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.store.settings import flatten
from gapath.task import metrics
from gapath.tasks.plan import Task as PlanTask

GOLDEN = Path(__file__).parent / "golden"

INSTANCES = "map.instance=0,29"
PUBLISHED = {
    "classes": [INSTANCES, "trials=1"],
    "drive_choices": ["map.instance=29"],
    "drive_classes": ["map.instance=29", "trials=1"],
    "drives": ["trials=1"],
    "drives_enclosed": ["trials=1"],
    "field": ["scenario.drawn=2"],
    "field/large/terrain": ["scenario.drawn=2", "map.width=300", "map.height=99"],
    "field/large/uniform": [
        "map.instance=1",
        "scenario.drawn=1",
        "map.width=300",
        "map.height=150",
    ],
    "landscape": [
        "device=cpu",
        "trials=2",
        "planner.population=20,200",
        "planner.mutation_probability=0.1,0.8",
        "planner.control_points=3,8",
    ],
    "m22": ["trials=2"],
    "m22_concave": ["trials=2"],
    "s04_drives": ["trials=1"],
    "s04_sweep": [
        "trials=1",
        "planner.population=50",
        "planner.mutation_probability=0.02",
        "planner.crossover_probability=0.8,0.95",
    ],
    "s04_table1": ["trials=2", "planner.max_epochs=100"],
    "table1": ["trials=2"],
    "table1_million": ["device=cpu", "trials=2"],
    "tune": [
        "trials=1",
        "hydra.sweeper.n_trials=2",
        "search.over=['map.instance=1']",
        "search.unseen=['map.instance=1001']",
    ],
}
"""Every experiment that needs no data from elsewhere, and what makes it small."""

SOME = {
    "classes": ["kg18_test1", "kg18_test4"],
    "drives": ["kg18_map1", "kg18_map4"],
    "field": ["field_rooms", "field_noise"],
    "field/large/uniform": ["field_rooms", "field_noise"],
    "m22": ["m22_scene01", "m22_scene08"],
    "s04_sweep": ["s04_sp01", "s04_sp08"],
    "s04_table1": ["s04_sp01", "s04_sp08"],
    "table1": ["kg18_test1", "kg18_test4"],
}
"""Maps that are enough day by day, where an experiment has more; `make reproduce` does all."""

MEMETIC = [
    (map_class, planner)
    for planner in ("memetic_quick", "memetic_quality")
    for map_class in (*CLASSES, "field_noise", "field_terrain")
]


def run(folder, map_name, planner, trials=2, **values):
    grid = room() if map_name == "room" else load_map(map_name)
    settings = yaml_values("planner", planner) | values
    problem = Problem(grid, grid.start, grid.target)
    made = build("planner", settings, "planner")
    recorders = [mcap.Recorder(step_s=0.1)]
    return execute(
        Run(
            "golden",
            Method(planner),
            problem,
            PlanTask(made),
            recorders,
            7,
            trials,
            flatten({"task": "plan", "planner": settings}),
            str(folder),
            False,
        ),
        "test",
        progress=False,
    )


def room():
    """A small map with two discs in the way."""
    y, x = np.mgrid[:40, :60]
    discs = ((x - 18) ** 2 + (y - 15) ** 2 <= 16) | ((x - 42) ** 2 + (y - 26) ** 2 <= 16)
    return GridMap("room", np.where(discs, 1.0, 0.5), (3, 20), (57, 21))


def log_hash(path):
    """Hash every message; metadata, which names versions, is left out."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            digest.update(f"{schema.name} {channel.topic} {message.log_time} ".encode())
            digest.update(message.data)
    return digest.hexdigest()


def results(folder, map_name, planner, trials=2, **values):
    outcome = run(folder, map_name, planner, trials, **values)
    return {
        **{name: outcome.rows[name].tolist() for name in ("status", "cost", "epochs")},
        "log": log_hash(outcome.folder / "run.mcap"),
    }


def check(ours, experiment, name, update):
    path = GOLDEN / f"{experiment}.json"
    golden = json.loads(path.read_text()) if path.exists() else {}
    if update:
        golden[name] = ours
        path.write_text(json.dumps(golden, indent=1, sort_keys=True) + "\n")
    assert ours == golden[name]


def experiment(name, maps, folder, monkeypatch):
    """Do the runs of an experiment, as the command does; a line for each run, by what varies."""
    words = [f"experiment={name}", "seed=7", "recorder=[mcap]", *PUBLISHED[name]]
    words += [f"map={','.join(maps)}"] if maps else []
    monkeypatch.setattr(sys, "argv", ["gapath", *words, f"output={folder}"])
    with contextlib.redirect_stdout(io.StringIO()):
        cli.main()
    lines = {}
    for manifest in folder.glob("*/*/manifest.json"):
        command = shlex.split(json.loads(manifest.read_text())["command"])[1:]
        varied = " ".join(word.partition("=")[2] for word in command if word not in words)
        lines[varied] = f"{ended(manifest.parent)}; log {log_hash(manifest.parent / 'run.mcap')}"
    return dict(sorted(lines.items()))


def ended(folder):
    """How the trials of a run ended."""
    table = pq.read_table(folder / "trials.parquet")
    end = "outcome" if "outcome" in table.column_names else "status"
    ends = zip(table[end].to_pylist(), table["cost"].to_pylist(), strict=True)
    return ", ".join(f"{status} {cost}" for status, cost in ends)


def test_every_experiment_without_data_from_elsewhere_is_done():
    there = Path(conf_folder()) / "experiment"
    files = (*there.glob("*.yaml"), *there.glob("field/large/*.yaml"))
    assert {path.relative_to(there).with_suffix("").as_posix() for path in files} == set(PUBLISHED)


@pytest.mark.parametrize("name", PUBLISHED)
def test_an_experiment_gives_the_golden_results(name, tmp_path, monkeypatch, update_golden):
    maps = [] if update_golden else whole(SOME.get(name, []), [])
    ours = experiment(name, maps, tmp_path, monkeypatch)
    path = GOLDEN / "experiments" / f"{name.replace('/', '_')}.json"
    if update_golden:
        path.write_text(json.dumps(ours, indent=1) + "\n")
    golden = json.loads(path.read_text())
    if maps:
        golden = {run: line for run, line in golden.items() if run.split()[0] in maps}
    differ = [run for run in golden | ours if ours.get(run) != golden.get(run)]
    print(f"{name}: {len(ours)} runs, {'all equal' if not differ else f'{len(differ)} differ'}")
    for run in differ:
        print(f"  {run}: golden {golden.get(run, 'none')}, now {ours.get(run, 'none')}")
    assert not differ


@pytest.mark.parametrize("map_class", GENERATED)
def test_generated_maps_are_the_golden_ones(map_class, update_golden):
    grids = [load_map(map_class, width=170, height=90, instance=i) for i in (0, 7)]
    ours = [f"{grid.start} {grid.target} {grid.digest}" for grid in grids]
    check(ours, "generated", map_class, update_golden)


@pytest.mark.parametrize(("map_class", "planner"), MEMETIC)
def test_memetic_gives_the_golden_results(map_class, planner, tmp_path, update_golden):
    ours = results(tmp_path, map_class, planner)
    check(ours, "memetic", f"{map_class} {planner}", update_golden)


def test_two_runs_give_the_same_log_byte_for_byte(tmp_path):
    logs = [
        (run(tmp_path / name, "kg18_test2", "ga2").folder / "run.mcap").read_bytes()
        for name in ("first", "second")
    ]
    assert logs[0] == logs[1]


def test_a_trial_does_not_depend_on_how_many_others_run(tmp_path):
    alone, in_company = (run(tmp_path / str(n), "kg18_test3", "ga2", n).rows for n in (2, 5))
    for name in ("cost", "epochs", *metrics()):
        assert np.array_equal(alone[name], in_company[name][:2], equal_nan=True), name


SMALL = {"population": 80, "max_epochs": 12}
OTHER = {
    "robot_radius": 2,
    "keypoints": "corners",
    "corner_tolerance": 0.5,
    "ga2_profile": "v67",
    "genes": 3,
}


CASES = {
    "kg18": ("kg18_test2", "ga1", 1, {"max_epochs": 20}),
    "m22": ("room", "visibility_ga", 2, SMALL | {"robot_radius": 1}),
    "s04": ("s04_sp06", "sedighi", 1, {"max_epochs": 20, "population": 30}),
    "m22_small": ("room", "visibility_ga_resized", 2, SMALL | OTHER),
}


def small(folder, *names):
    """Results of some cases, and whether steps cut corners."""
    cases = {name: CASES[name] for name in names}
    return [
        *(results(folder / name, *case, **more) for name, (*case, more) in cases.items()),
        corners(),
    ]


def corners():
    """Whether steps between two obstacles, one and none cut a corner, by the rule."""
    table = GridMap("corners", np.array([[0.5, 1.0], [1.0, 0.5], [0.5, 0.5]])).table
    steps = itertools.product(((0, 0, 1, 1), (0, 1, 1, 2), (0, 2, 1, 1)), CornerCutting)
    return [bool(cuts_corner(table, *step, int(rule))) for step, rule in steps]


@pytest.mark.parametrize(
    ("environment", "names"),
    [
        ({"NUMBA_DISABLE_JIT": "1"}, [*CASES]),
        # at once, since compiling takes its time: furthest from what runs here
        ({"NUMBA_CPU_NAME": "generic", "NUMBA_BOUNDSCHECK": "1"}, whole(["kg18"], [*CASES])),
    ],
    ids=["uncompiled", "generic, bounds checked"],
)
def test_results_do_not_depend_on_how_the_kernels_are_compiled(environment, names, tmp_path):
    here = small(tmp_path / "here", *names)
    code = (
        "import json, pathlib, sys, test_golden; "
        "print(json.dumps(test_golden.small(pathlib.Path(sys.argv[1]), *sys.argv[2:])))"
    )
    scale = Path(__file__).parent / "reliability"
    own = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(scale)}
    there = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code, str(tmp_path / "there"), *names],
        env=os.environ | own | environment,
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert there.returncode == 0, there.stderr
    assert json.loads(there.stdout) == here
