"""Text that is held as categories makes no table or figure another one."""

import pandas as pd
import pytest

from gapath.pipelines.reading.collect import read_trials
from gapath.pipelines.reading.of_run import of_run
from gapath.pipelines.report import report as report_module
from gapath.pipelines.report.report import make_report
from gapath.store.records import find_runs

from ..conftest import record_of


def as_text(frame):
    kinds = frame.dtypes.items()
    text = [name for name, kind in kinds if isinstance(kind, pd.CategoricalDtype)]
    assert text or frame.empty
    return frame.astype(dict.fromkeys(text, "str"))


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("which", ["outputs", "drive_outputs"])
def test_every_file_of_a_report_is_the_same(which, request, tmp_path, monkeypatch):
    outputs = request.getfixturevalue(which)
    files, _ = make_report(outputs, tmp_path / "categories")

    def read(runs):
        found = read_trials(runs)
        trials = {task: as_text(frame) for task, frame in found.trials.items()}
        return found._replace(trials=trials)

    monkeypatch.setattr(report_module, "read_trials", read)
    others, _ = make_report(outputs, tmp_path / "text")
    assert [file.name for file in files] == [file.name for file in others]
    for file, other in zip(files, others, strict=True):
        assert file.read_bytes() == other.read_bytes(), file.name


@pytest.mark.parametrize("kind", ["str", "category"])
def test_what_trials_have_from_their_run_is_no_category(kind):
    runs = [record_of("ga1", "b"), record_of("ga2", "a")]
    trials = pd.DataFrame({"key": ["b", "a", "b"]}, index=[5, 6, 7]).astype({"key": kind})
    names = of_run(trials, runs, lambda run: run.known.preset)
    assert names.to_dict() == {5: "ga1", 6: "ga2", 7: "ga1"}
    assert not isinstance(names.dtype, pd.CategoricalDtype)
    assert of_run(trials, runs, lambda run: run.known.preset == "ga1").dtype == bool
    assert len(of_run(trials[:0], runs, lambda run: 1)) == 0


def test_frames_of_runs_hold_categories(outputs):
    frame = read_trials(find_runs(outputs)).trials["plan"]
    assert isinstance(frame["map"].dtype, pd.CategoricalDtype)
