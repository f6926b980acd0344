import pytest

from gapath.errors import InputError
from gapath.events import Outcome, Stepped
from gapath.pipelines.kg18.drives import figure_paths, figure_ratios, figure_times
from gapath.pipelines.page.figures import GRID, INK, PAPER
from gapath.recorders.mcap import FILE, read_events
from gapath.store.records import find_runs

from .conftest import collect, colours_of_lines

FIGURES = (figure_times, figure_paths, figure_ratios)


@pytest.fixture(scope="module")
def case(drive_outputs):
    drives = collect(drive_outputs).trials["drive"]
    runs = [run for run in find_runs(drive_outputs) if run.known.experiment == "drives"]
    return drives[drives["experiment"] == "drives"], runs


def test_trails_are_those_of_the_log(case):
    _, runs = case
    run = next(run for run in runs if run.known.map == "kg18_map4")
    example = figure_paths.read_trails(read_events(run.folder / FILE), {0, 3, 7})
    places: dict[int, list[tuple[int, int]]] = {0: [], 3: [], 7: []}
    for event in read_events(run.folder / FILE):
        if isinstance(event, Stepped) and event.trial in places:
            places[event.trial].append(event.place)
    assert [trail.places.tolist() for trail in example.trails] == [
        [list(place) for place in places[trial]] for trial in (0, 3, 7)
    ]
    for trail in example.trails:
        ends = trail.places[0].tolist(), trail.places[-1].tolist()
        assert (ends[0] != ends[1]) == (trail.outcome is Outcome.REACHED)


def test_a_log_that_does_not_begin_with_its_run_is_refused():
    with pytest.raises(InputError, match="RunStarted"):
        figure_paths.read_trails(iter([]), {0})


def test_a_drive_that_failed_is_drawn_and_said(case):
    trials, runs = case
    easy, hard = figure_paths.section(trials, runs).figures
    assert "KG18 returned, 16 steps." in hard.alt
    assert "returned" not in easy.alt


@pytest.mark.parametrize("module", FIGURES)
def test_figures_are_the_same_bytes_each_time(case, module):
    trials, runs = case
    first, second = module.section(trials, runs), module.section(trials, runs)
    assert len(first.figures) == (2 if module is figure_paths else 1)
    for a, b in zip(first.figures, second.figures, strict=True):
        assert (a.svg, a.png) == (b.svg, b.png)
        assert a.caption
        assert "map 4" in a.alt.lower() or "Drives drawn" in a.alt


def test_histograms_state_their_failures(case):
    trials, runs = case
    (figure,) = figure_times.section(trials, runs).figures
    count = (
        trials.query("map == 'kg18_map4' and navigator == 'kg18'")["outcome"] == "returned"
    ).sum()
    assert f"returned {count}, overran 0 of 12" in figure.alt
    assert "unknown map 4 0 to 140 s" in figure.caption


@pytest.mark.parametrize("module", [figure_times, figure_paths])
def test_without_drives_of_kg18_there_is_no_figure(case, module):
    trials, _ = case
    assert module.section(trials[trials["navigator"] == "dstar_lite"], []) is None


def test_a_line_on_a_map_is_that_of_the_legend_on_every_page(case, monkeypatch):
    on_maps, in_legends = colours_of_lines(figure_paths, case, monkeypatch)
    assert on_maps == in_legends
    assert not on_maps & {INK, PAPER, GRID}  # the page has its own
