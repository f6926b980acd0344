"""Searches: what a sweeper is told of each setting, once and again, and what is refused."""

import math
import re

import pandas as pd
import pytest
from hydra.core.config_store import ConfigStore

from gapath.commands import run as cli
from gapath.commands.search import OBJECTIVES
from gapath.running.sweep import BUSY, sweep_files, unfinished
from gapath.store.records import find_runs
from gapath.store.runfolder import RunFolder

BASE = ("-m", "hydra/sweeper=optuna", "hydra.sweeper.n_trials=3", "map=kg18_test3", "planner=ga1",
        "recorder=none", "trials=5")  # fmt: skip
HARD = (*BASE, "planner.max_epochs=2", "planner.population=range(40,240,step=40)",
        "search.over=['map.instance=1,2']", "search.unseen=['map.instance=3']")  # fmt: skip
SMALL = (*BASE, "planner.population=4,60", "planner.max_epochs=2")


def values(text):
    """What a search says that its settings came to: population and value, in their order."""
    said = re.findall(r"^setting \d+: planner\.population=(\d+): (\w+) ([\d.inf]+),", text, re.M)
    return [(int(population), name, float(value)) for population, name, value in said]


def rows(outputs, experiment="plan"):
    """Trials of all runs, with the population of each."""
    return pd.concat(
        pd.read_parquet(run.folder / "trials.parquet").assign(
            population=run.settings["planner.population"]
        )
        for run in find_runs(outputs)
        if run.known.experiment == experiment
    )


def slowly(trials, objective):
    """What trials come to, as docs/tuning.md says it."""
    if objective == "success":
        return trials["feasible"].mean()
    if objective == "cost":
        return trials["cost"].mean() if trials["feasible"].all() else math.inf
    spent = {"expected_evaluations": "evaluations", "expected_seconds": "plan_time_s"}[objective]
    found = trials["feasible"].sum()
    return trials[spent].sum() / found if found else math.inf


def done(outputs):
    """What was done when, of every run."""
    return {
        run.folder.name: (run.folder / "status.json").read_bytes() for run in find_runs(outputs)
    }


def test_a_setting_comes_to_what_its_rows_say_and_the_best_is_the_best(gapath, tmp_path):
    for objective, way in OBJECTIVES.items():  # whose runs are the same, and done once
        words = [f"search.objective={objective}", f"hydra.sweeper.direction={way}"]
        code, text, errors = gapath(*HARD, *words)
        assert (code, errors) == (0, "")
        tried, trials = values(text), rows(tmp_path / "out")
        assert len(tried) == 3
        for population, name, value in tried:
            mine = trials[trials["population"] == population]
            assert (name, len(mine)) == (objective, 2 * 5)
            assert value == pytest.approx(slowly(mine, objective), rel=1e-5)
        every = [value for _, _, value in tried]
        best = (min if way == "minimize" else max)(every)
        if math.isinf(best):
            assert text.endswith(f"best of 3: none, as none came to {objective}\n")
            continue
        population = tried[every.index(best)][0]
        assert f"best of 3: planner.population={population}: {objective} {best:.6g}\n" in text
        unseen = rows(tmp_path / "out", "plan_unseen").groupby("population")
        for what, number in (("before", 40), ("tuned", population)):
            (value,) = re.findall(rf"unseen, {what}: \w+ ([\d.inf]+), ", text)
            mine = unseen.get_group(number)
            assert float(value) == pytest.approx(slowly(mine, objective), rel=1e-5)
        assert text.endswith("--by method --where \"experiment = 'plan_unseen'\"\n")
    assert sweep_files(tmp_path / "out") == []


def test_a_search_that_is_cut_short_goes_on_and_does_nothing_again(gapath, tmp_path, monkeypatch):
    out, other = tmp_path / "out", tmp_path / "other"
    whole = gapath(*HARD, output=other)[1].replace(str(other), str(out))
    calls, execute = [], cli.execute

    def until_the_fourth(*given, **named):
        calls.append(given)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return execute(*given, **named)

    monkeypatch.setattr(cli, "execute", until_the_fourth)
    with pytest.raises(KeyboardInterrupt):
        gapath(*HARD)
    first = done(out)
    assert len(first) == 3
    (left,) = unfinished(out)
    assert (left.jobs, left.alive) == (3 * 2 + 2, False)
    monkeypatch.setattr(cli, "execute", execute)
    code, text, errors = gapath(*HARD)
    assert (code, errors, text[-len(whole) :]) == (0, "", whole)
    second = done(out)
    assert {key: second[key] for key in first} == first
    assert second.keys() == done(other).keys()
    assert gapath(*HARD) == (0, whole, "")
    assert done(out) == second


def test_a_setting_that_is_refused_or_fails_is_told_and_the_search_goes_on(
    gapath, tmp_path, monkeypatch
):
    words = (*BASE, "planner.population=40,1,60")
    code, text, errors = gapath(*words)
    refused = re.findall(r"planner\.population=1: refused", text)
    assert (code, bool(refused)) == (cli.BAD_INPUT, True)
    assert errors.count("gapath: planner.population: got ") == len(refused)
    assert re.search(r"best of 3: planner\.population=[46]0: expected_evaluations \d", text)

    def fail(run, *given, **named):
        if run.settings["planner.population"] == 60:
            raise RuntimeError("no")
        return execute(run, *given, **named)

    execute = cli.execute
    monkeypatch.setattr(cli, "execute", fail)
    code, text, errors = gapath(*SMALL, output=tmp_path / "failing")
    assert code == cli.FAILED
    assert "planner.population=60: 1 of 1 runs failed" in text
    assert "best of 3: none, as none came to expected_evaluations" in text
    assert set(errors.splitlines()) == {errors.splitlines()[0]}


def test_a_run_that_another_process_does_ends_the_search(gapath, tmp_path):
    gapath(*SMALL)
    run = next(iter(find_runs(tmp_path / "out")))
    with RunFolder(run.folder).lock():
        code, _, errors = gapath(*SMALL, "force=true")
    assert code == BUSY
    assert errors == "gapath: another process does runs of this search; the same command goes on\n"


def test_a_search_is_a_sweep_of_ordinary_runs(gapath, tmp_path):
    gapath(*SMALL)
    before = done(tmp_path / "out")
    words = [word for word in SMALL if not word.startswith("hydra")]
    code, text, _ = gapath(*words)
    assert (code, text.split(",")[0]) == (0, "skipped: 2 of 2 runs are whole")
    assert done(tmp_path / "out") == before
    again = {run.known.command for run in find_runs(tmp_path / "out")}
    assert all("search." not in each and each.endswith(" hydra.mode=RUN") for each in again)


OVER = "search.over=['map.instance=1,2']"


@pytest.mark.parametrize(
    ("words", "right"),
    [
        (["search.objective=speed"], "search.objective: got speed, expected one of expected_eval"),
        (["search.objective=success"], "hydra.sweeper.direction: got minimize, expected maximize"),
        (["hydra.sweeper.direction=maximize"], "hydra.sweeper.direction: got maximize, expected"),
        (["planner.population=40"], "hydra.sweeper.params: got nothing to search, expected a"),
        (["planner.population=range(1,9)"], "planner.population: got 1, expected an integer"),
        (["planner.mixing=interval(0,2)"], "planner.mixing: got 2.0, expected a number in [0, 1]"),
        ([OVER, "search.unseen=['map.instance=3,2']"], "search.unseen: got map.instance=2, expec"),
        (["search.over=['planner.population=40,60']"], "planner.population: got 60 and 40, expec"),
        (["search.over=3"], "search.over: got 3, expected"),
        (["search.color=3"], "search.color: got an unknown name, expected one of objective"),
        (["hydra.sweeper.n_trials=0"], "hydra.sweeper.n_trials: got 0, expected an integer from"),
        (["hydra.sweeper.n_jobs=0"], "hydra.sweeper.n_jobs: got 0, expected an integer from 1"),
        (["hydra.sweeper.storage='sqlite:///a'"], "hydra.sweeper.storage: got sqlite:///a, expe"),
        (["hydra/sweeper=optun"], "hydra/sweeper: got optun, expected one of basic, optuna"),
        (["hydra/sweeper=basic", OVER], "search.over: got no search, expected hydra/sweeper=opt"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_tried(gapath, tmp_path, words, right):
    keys = {word.partition("=")[0] for word in words}
    kept = [word for word in SMALL if word.partition("=")[0] not in keys]
    if "hydra/sweeper=basic" in words:
        kept.remove("hydra.sweeper.n_trials=3")
    code, text, errors = gapath(*kept, *words)
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1), errors
    assert errors.startswith(f"gapath: {right}")
    assert not (tmp_path / "out").exists()


def test_a_search_without_saying_so_is_refused(gapath, tmp_path):
    code, text, errors = gapath("hydra/sweeper=optuna", "search.objective=cost")
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1)
    assert errors.startswith("gapath: hydra/sweeper: got optuna without -m, expected gapath -m")
    assert not (tmp_path / "out").exists()


def test_a_figure_that_a_method_does_not_have_ends_the_search(gapath):
    words = [word for word in BASE if not word.startswith("planner")]
    code, text, errors = gapath(*words, "planner=astar,dijkstra")
    assert (code, text, errors.count("\n")) == (cli.BAD_INPUT, "", 1)
    right = "got expected_evaluations, expected one of expected_seconds, cost, success, which"
    assert errors.startswith(f"gapath: search.objective: {right}")


def test_without_the_package_the_extra_is_told(gapath, monkeypatch):
    monkeypatch.delitem(ConfigStore.instance().repo["hydra"]["sweeper"], "optuna.yaml")
    code, text, errors = gapath("experiment=tune")
    assert (code, text) == (cli.BAD_INPUT, "")
    told = "hydra/sweeper=optuna needs hydra-optuna-sweeper: pip install 'gapath[tune]'"
    assert errors == f"gapath: {told}\n"
