import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError
from gapath.events import TrialFinished
from gapath.pipelines.kg18 import figure_convergence, figure_evaluations, figure_paths
from gapath.pipelines.page.figures import GRID, INK, PAPER, looks, looks_of
from gapath.problem import PlanStatus
from gapath.store.records import find_runs

from .conftest import collect, colours_of_lines


@pytest.fixture(scope="module")
def case(outputs):
    frame = collect(outputs).trials["plan"]
    runs = [run for run in find_runs(outputs) if run.folder.parent.name == "table1"]
    return frame[frame["experiment"] == "table1"], runs


@given(st.lists(st.lists(st.floats(0, 1e6), min_size=1, max_size=8), min_size=1, max_size=8))
def test_by_epoch_keeps_the_last_value_of_a_trial_that_ended(curves):
    quartiles = figure_convergence.by_epoch(np.array(curve) for curve in curves)
    longest = max(map(len, curves))
    assert quartiles.shape == (3, longest)
    for epoch in range(longest):
        values = [curve[min(epoch, len(curve) - 1)] for curve in curves]
        assert list(quartiles[:, epoch]) == list(np.quantile(values, (0.25, 0.5, 0.75)))


def test_an_example_is_of_the_first_trials_that_found_a_path(outputs):
    from gapath.recorders.mcap import FILE, read_events

    for run in find_runs(outputs):
        if run.folder.parent.name != "table1":
            continue
        found = [
            event.answer.path
            for event in read_events(run.folder / FILE)
            if isinstance(event, TrialFinished) and event.answer.status is PlanStatus.FOUND
        ]
        example = figure_paths.read_found(read_events(run.folder / FILE))
        assert len(example.paths) == min(3, len(found))
        for path, expected in zip(example.paths, found, strict=False):
            assert np.array_equal(path, expected)


def test_a_log_that_does_not_begin_with_its_run_is_refused():
    with pytest.raises(InputError, match="RunStarted"):
        figure_paths.read_found(iter([]))


@pytest.mark.parametrize("module", [figure_evaluations, figure_convergence, figure_paths])
def test_figures_are_the_same_bytes_each_time_and_say_what_they_show(case, module):
    first, second = module.section(*case), module.section(*case)
    assert len(first.figures) == (4 if module is figure_paths else 1)
    for a, b in zip(first.figures, second.figures, strict=True):
        assert (a.svg, a.png) == (b.svg, b.png)
        assert a.svg.startswith(b"<?xml")
        assert a.png.startswith(b"\x89PNG")
        assert b"<dc:date>" not in a.svg
        assert a.caption
        assert "Map" in a.alt


def test_maps_are_marked_as_reconstructed(case):
    for figure in figure_paths.section(*case).figures:
        assert "(reconstructed)" in figure.caption


def test_without_logs_or_epochs_there_is_no_figure(case):
    frame, runs = case
    exact = frame[frame["planner"] == "dijkstra"]
    for module in (figure_evaluations, figure_convergence, figure_paths):
        section = module.section(exact, runs)
        assert section is None or not section.figures
    section = figure_convergence.section(frame, [])
    assert section is None or not section.figures


def test_a_planner_looks_the_same_in_all_figures_of_an_experiment():
    names = ["dijkstra", "ga3", "ga1", "astar", "ga2"]
    assert looks(names) == looks(reversed(names))
    assert len({look.color for look in looks(names).values()}) == 5
    assert list(looks(names))[:3] == ["ga1", "ga2", "ga3"]


def test_whatever_is_drawn_on_a_map_shows_on_every_page():
    assert not {look.color for look in looks_of("abcdefghij").values()} & {INK, PAPER, GRID}


def test_a_line_on_a_map_is_that_of_the_legend_on_every_page(case, monkeypatch):
    on_maps, in_legends = colours_of_lines(figure_paths, case, monkeypatch)
    assert on_maps == in_legends
    assert not on_maps & {INK, PAPER, GRID}  # the page has its own
