"""``gapath-log`` takes a run's key, the beginning of it, its folder or a file in it."""

import pytest

from gapath.commands import log as log_cli
from gapath.commands import run as cli


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Three trials of A* on one map, two seeds: run folders."""
    folder = tmp_path_factory.mktemp("outputs")
    with pytest.MonkeyPatch.context() as patch:
        for seed in (1, 2):
            words = ["map=kg18_test1", "planner=astar", "recorder=mcap", f"seed={seed}"]
            patch.setattr("sys.argv", ["gapath", *words, f"output={folder}"])
            cli.main()
    return folder


def test_a_run_is_named_in_any_way(outputs, capfd, monkeypatch):
    run, other = sorted(outputs.glob("plan/*"))
    first = next(run.name[:i] for i in range(1, 17) if not other.name.startswith(run.name[:i]))
    monkeypatch.chdir(run)
    for given in (
        run.name,
        first,
        f"plan/{run.name}",
        run,
        run / "manifest.json",
        run / "run.mcap",
    ):
        assert log_cli.main(["info", str(given), "--outputs", str(outputs)]) == 0
        assert f"{run / 'run.mcap'}, " in capfd.readouterr().out
    assert log_cli.main(["verify", first, other.name, "--outputs", str(outputs)]) == 0


@pytest.mark.parametrize("command", ["info", "verify", "salvage", "rerun", "view"])
def test_a_run_that_is_not_there_is_one_line(outputs, capfd, command):
    run, _ = sorted(outputs.glob("plan/*"))
    wrong = run.name[:-1] + ("0" if run.name[-1] != "0" else "1")
    assert log_cli.main([command, wrong, "--outputs", str(outputs)]) == 2
    out, errors = capfd.readouterr()
    assert (out, len(errors.splitlines())) == ("", 1)
    assert f"did you mean {run.name}?" in errors


def test_an_ambiguous_beginning_names_the_runs(outputs, capfd):
    runs = sorted(outputs.glob("plan/*"))
    for run in runs:
        (outputs / "more" / f"abc{run.name}").mkdir(parents=True)
        (outputs / "more" / f"abc{run.name}" / "status.json").touch()
    assert log_cli.main(["info", "abc", "--outputs", str(outputs)]) == 2
    errors = capfd.readouterr().err
    assert all(f"more/abc{run.name}" in errors for run in runs)
    assert len(errors.splitlines()) == 1
