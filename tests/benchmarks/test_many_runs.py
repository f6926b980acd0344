"""A folder of very many runs holds whole runs, whose manifests say what their trials come to."""

import pytest

from benchmarks.many_runs import many_runs
from benchmarks.measure import spent
from gapath.pipelines.reading.collect import read_trials
from gapath.store.records import find_runs


def test_runs_that_are_made_up_are_whole_and_tell_what_their_trials_come_to():
    with many_runs(runs=45, trials=4) as outputs:
        runs = find_runs(outputs)
        collected = read_trials(runs)
    assert not outputs.exists()
    assert len(runs) == len({run.folder.name for run in runs}) == 45
    assert not any(run.fault for run in runs) and collected.skipped == []
    assert {run.known.seed for run in runs} == {0, 1}
    assert all(run.settings["seed"] == run.known.seed for run in runs)
    trials = collected.trials["plan"].groupby("key", observed=True)
    came = {run.folder.name: run.known.results for run in runs}
    for key, rows in trials:
        assert sorted(rows["trial"]) == [0, 1, 2, 3]
        assert came[key].succeeded == rows["feasible"].sum()
        assert came[key].sums["evaluations"] == rows["evaluations"].sum()
        assert came[key].sums["length"] == pytest.approx(rows["length"].sum(), rel=1e-12)


def test_a_process_is_charged_with_what_it_spends_itself():
    hold = ["python3", "-c", "held = bytearray(200_000_000); sum(range(3_000_000))"]
    little, much = spent(["true"]), spent(hold)
    assert little.peak_bytes < 60e6 < 200e6 < much.peak_bytes < 300e6
    assert little.cpu_s < much.cpu_s
