"""What the command says of where a run comes from: in the manifest, nowhere else."""

import json
import shutil
from pathlib import Path

import pytest

from gapath.commands import asker
from gapath.store.provenance import origin
from gapath.store.provenance.git import Tree

RUN = ["map=kg18_test1", "planner=astar"]


def manifests(place):
    found = [json.loads(path.read_bytes()) for path in place.rglob("manifest.json")]
    return sorted(found, key=lambda each: each["seed"])


def files(place):
    (folder,) = [path.parent for path in place.rglob("manifest.json")]
    return folder, {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def edited(tmp_path, monkeypatch):
    """A working directory whose repository was edited."""
    monkeypatch.setattr(origin, "_here", lambda: tmp_path)
    monkeypatch.setattr(origin, "_checkout", lambda: None)
    monkeypatch.setattr(origin, "tree_of", lambda top: Tree({"clean": False}, b"a diff"))


def test_a_run_says_where_it_comes_from_and_is_the_same(gapath, tmp_path, edited):
    folders = {}
    for name, words in (("said", ()), ("unsaid", ("provenance=false",))):
        assert gapath(*RUN, "recorder=mcap", *words, f"output={name}", output=None)[0] == 0
        folders[name] = files(tmp_path / name)
    (said, its), (unsaid, others) = folders.values()
    assert said.name == unsaid.name
    assert its["code.diff"] == b"a diff" and "code.diff" not in others
    for name in ("run.mcap", "config.yaml"):
        assert its[name] == others[name]
    told, untold = (json.loads(found["manifest.json"]) for found in (its, others))
    assert "code.diff" in told["files"]
    assert untold["provenance"] == {} and told["command"] == untold["command"]
    sections = ["directory", "gapath", "machine", "asker", "packages", "spent"]
    assert list(told["provenance"]) == sections
    assert told["provenance"]["asker"] == {
        "command": "gapath map=kg18_test1 planner=astar recorder=mcap output=said"
    }
    assert told["provenance"]["spent"]["trials_taken_up"] == 0
    assert "skipped" in gapath(*RUN, "recorder=mcap", "output=said", output=None)[1]
    assert files(tmp_path / "said")[1] == its  # to the byte
    (said / "code.diff").write_bytes(b"b diff")
    assert "skipped" not in gapath(*RUN, "recorder=mcap", "output=said", output=None)[1]


def test_the_jobs_of_a_sweep_say_their_places(gapath, tmp_path):
    assert gapath("-m", *RUN, "seed=3,4,5", "recorder=none")[0] == 0
    found = [each["provenance"]["asker"] for each in manifests(tmp_path)]
    command = f"gapath -m map=kg18_test1 planner=astar seed=3,4,5 recorder=none output={tmp_path}/"
    assert found == [
        {"command": f"{command}out", "job": i, "jobs": 3, "launcher": "basic"} for i in (1, 2, 3)
    ]


def test_a_very_long_command_is_kept_in_part(gapath, tmp_path):
    seeds = ",".join(str(seed) for seed in range(10_000, 10_002))
    name = "a" * 9000
    assert gapath("-m", *RUN, f"seed={seeds}", "recorder=none", f"name={name[:99]}",
                  f"hydra.job.name={name}")[0] == 0  # fmt: skip
    (told, _) = [each["provenance"]["asker"]["command"] for each in manifests(tmp_path)]
    assert len(told) < 4096 and told.endswith(" more)")


def test_a_job_outside_of_its_sweeps_environment_says_what_it_knows(monkeypatch):
    monkeypatch.delenv("GAPATH_SWEEP", raising=False)
    assert asker.asker_of_job(6, "far") == {
        "command": None, "job": 7, "jobs": None, "launcher": "far",
    }  # fmt: skip
    assert asker.edited_meanwhile() is None


def test_code_that_is_edited_while_a_sweep_runs_is_noticed_by_the_next_job(
    gapath, tmp_path, monkeypatch
):
    seen = iter([False, True, True])
    monkeypatch.setattr(asker, "edited", lambda code: next(seen))
    code, text, errors = gapath("-m", *RUN, "seed=1,2,3", "recorder=none")
    assert code == 0 and text.count("1 of 1 found") == 3
    line = "gapath: the code was edited since this sweep began; this job does what was loaded, "
    assert [each[: len(line)] for each in errors.splitlines()] == [line] * 2


def test_a_run_that_goes_on_says_how_many_trials_it_took_up(gapath, tmp_path, failing_after):
    run = [*RUN, "trials=5", "recorder=none"]
    with failing_after(3):
        assert gapath(*run)[0] == 1
    (cut,) = manifests(tmp_path)
    assert cut["provenance"]["machine"] and "spent" not in cut["provenance"]
    code, _, errors = gapath(*run)
    assert code == 0 and "goes on after trial 2" in errors
    (whole,) = manifests(tmp_path)
    assert whole["provenance"]["spent"]["trials_taken_up"] == 3


@pytest.mark.skipif(not shutil.which("git"), reason="git is not installed")
def test_the_repository_of_the_working_directory_is_told(gapath, tmp_path):
    """The real thing: a working directory that is a broken repository does not keep a run."""
    Path(tmp_path, ".git").mkdir()
    code, _, errors = gapath(*RUN, "recorder=none")
    assert (code, errors) == (0, "")
    (told,) = manifests(tmp_path)
    assert told["provenance"]["directory"] == {"told": "git status fails with exit code 128"}
