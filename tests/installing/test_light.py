"""gapath without any extra plans, sweeps and reads logs; what it lacks one line names."""

import shutil
from functools import partial

import packages
import pytest
from packages import EXTRAS, names_in

SMALL = ("map=kg18_test1", "trials=2", "seed=5", "provenance=false")
WITHOUT = "without recorder rerun needs rerun-sdk: pip install 'gapath[view]'"


@pytest.fixture
def run(light, tmp_path):
    """Run a command of gapath, without any extra, in a folder of its own."""
    return partial(packages.run, light, tmp_path)


@pytest.fixture(scope="module")
def made(light, tmp_path_factory):
    """A folder with a run."""
    folder = tmp_path_factory.mktemp("made")
    code, out, err = packages.run(light, folder, "main", *SMALL, "planner=ga1")
    assert (code, err) == (0, "")
    return folder, out


def test_a_plan_says_what_it_goes_without(made):
    folder, out = made
    (log,) = folder.glob("outputs/plan/*/run.mcap")
    assert WITHOUT in out.splitlines()
    assert not [*log.parent.glob("*.rrd")]
    assert "rerun" not in (log.parent / "config.yaml").read_text()


def test_its_log_is_that_of_a_full_install(made, gapath, tmp_path):
    (log,) = made[0].glob("outputs/plan/*/run.mcap")
    assert gapath(*SMALL, "planner=ga1")[0] == 0
    (full,) = tmp_path.glob("out/plan/*/run.mcap")
    assert (full.parent / "trial-0.rrd").is_file()
    assert log.read_bytes() == full.read_bytes()
    assert log.parent.name != full.parent.name  # by its settings it has no recording


def test_a_log_is_looked_at_and_verified(made, run):
    (log,) = made[0].glob("outputs/plan/*/run.mcap")
    code, out, err = run("log", "info", log)
    assert (code, err, "state:        whole" in out) == (0, "", True)
    code, out, err = run("log", "verify", log)
    assert (code, err) == (0, "")
    assert "reproduced, byte for byte" in out


def test_what_a_kill_left_is_saved(made, run, tmp_path):
    (log,) = made[0].glob("outputs/plan/*/run.mcap")
    (tmp_path / "run.mcap.part").write_bytes(log.read_bytes()[:-100])
    code, out, _ = run("log", "salvage", "run.mcap.part")
    assert (code, "messages saved and read back" in out) == (0, True)


def test_a_sweep_says_once_what_it_goes_without(run, tmp_path):
    words = ("-m", "map=kg18_test1,kg18_test2", "planner=ga1,memetic", "trials=2")
    code, out, err = run("main", *words)
    assert code == 0, err
    assert err.splitlines() == [f"gapath: {WITHOUT}"]
    assert len([*tmp_path.glob("outputs/*/*/run.mcap")]) == 4
    code, out, err = run("main", *words)
    assert (code, err, out.startswith("skipped: 4 of 4 runs are whole")) == (0, "", True)


def test_runs_are_tagged_pruned_packed_and_watched(made, run, tmp_path):
    shutil.copytree(made[0] / "outputs", tmp_path / "outputs")
    (folder,) = tmp_path.glob("outputs/plan/*")
    for words in (
        ("tag", folder.name, "good"),
        ("prune", "outputs"),
        ("archive", "plan", "plan.tar.gz"),
        ("watch", "outputs", "--once"),
    ):
        code, _, err = run("report", *words)
        assert code == 0, err


def test_the_library_plans_and_drives(light, tmp_path):
    code = """
import gapath

grid = gapath.load_map("kg18_map1")
plan = gapath.plan(grid, planner="ga3", seed=7)
print(plan.status.name, gapath.drive(grid, seed=1).outcome.name)
print("picture" if "<img" in plan._repr_html_() else "table", "<table>" in plan._repr_html_())
for ask in (plan.plot, plan.convergence, plan.animate, lambda: gapath.runs("outputs")):
    try:
        ask()
    except gapath.InputError as error:
        print(error)
"""
    done = packages.python(light, tmp_path, code)
    report = ", ".join(sorted(names_in(EXTRAS["report"])))
    assert done.stdout.splitlines() == [
        "FOUND REACHED",
        "table True",
        *["a picture needs matplotlib: pip install 'gapath[report]'"] * 3,
        f"gapath.runs needs {report}: pip install 'gapath[report]'",
    ], done.stderr


VIEW, IMAGE = "rerun-sdk: pip install 'gapath[view]'", "scikit-image: pip install 'gapath[image]'"
REPORT = f"{', '.join(names_in(EXTRAS['report']))}: pip install 'gapath[report]'"
SCENE = "map=m22_scene03"


@pytest.mark.parametrize(
    ("module", "words", "said"),
    [
        ("main", ["recorder=rerun"], f"gapath: recorder rerun needs {VIEW}"),
        ("main", ["recorder=[mcap,rerun]"], f"gapath: recorder rerun needs {VIEW}"),
        ("main", ["recorder.rerun.trials=[1]"], f"gapath: recorder rerun needs {VIEW}"),
        ("main", ["-m", "recorder=none,rerun"], f"gapath: recorder rerun needs {VIEW}"),
        ("main", [SCENE, "planner=visibility_ga"], f"gapath: planner visibility_ga needs {IMAGE}"),
        ("main", [SCENE, "planner=visibility_astar"], f"planner visibility_search needs {IMAGE}"),
        ("main", ["experiment=m22"], f"needs {IMAGE}"),
        ("main", ["experiment=tune"], "hydra-optuna-sweeper: pip install 'gapath[tune]'"),
        ("main", ["-m", "seed=1,2", "hydra/launcher=joblib"],
         "gapath: hydra/launcher=joblib needs hydra-joblib-launcher: pip install 'gapath[joblib]'"),
        ("main", ["-m", "seed=1,2", "hydra/launcher=submitit_slurm"],
         "needs hydra-submitit-launcher: pip install 'gapath[cluster]'"),
        ("main", ["-m", "seed=1,2", "hydra/launcher=ray"],
         "needs hydra-ray-launcher: pip install 'gapath[ray]'"),
        ("log", ["view", "run.mcap"], f"gapath-log: view needs {VIEW}"),
        ("log", ["rerun", "run.mcap", "-o", "new"], f"gapath-log: rerun needs {VIEW}"),
        ("log", ["crate", "plan", "crate"], "crate needs rocrate: pip install 'gapath[crate]'"),
        ("report", ["outputs"], f"gapath-report: a report needs {REPORT}"),
        ("report", ["runs"], f"gapath-report: runs needs {REPORT}"),
        ("report", ["compare"], f"gapath-report: compare needs {REPORT}"),
    ],
)  # fmt: skip
def test_what_an_extra_brings_is_asked_for_before_anything_is_done(
    made, run, tmp_path, module, words, said
):
    (log,) = made[0].glob("outputs/plan/*/run.mcap")
    shutil.copy(log, tmp_path / "run.mcap")
    if "crate" in words:
        shutil.copytree(made[0] / "outputs", tmp_path / "outputs")
    before = sorted(tmp_path.iterdir())
    code, out, err = run(module, *words)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert said in err
    assert sorted(tmp_path.iterdir()) == before
