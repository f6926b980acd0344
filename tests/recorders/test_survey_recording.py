"""What a planner made of the map before it searched: once in a log, and in every recording."""

import numpy as np
import pytest
import rerun as rr
from log_events import plain
from recordings import centres, read
from visibility_strategies import ga, make, map_of

from gapath.commands import log as log_cli
from gapath.errors import InputError
from gapath.events import Evolved, RunStarted, Surveyed, TrialFinished, TrialStarted
from gapath.kernels.rng import stream
from gapath.planners.inflated import Planner as Inflated
from gapath.problem import PlanStatus, Problem
from gapath.recorders import mcap, rerun
from gapath.recorders.mcap.cdr import record
from gapath.recorders.mcap.messages import event
from gapath.running.config import Run
from gapath.running.experiment import execute
from gapath.running.naming import Method
from gapath.tasks.plan import Task as PlanTask


@pytest.fixture(autouse=True)
def strict():
    rr.set_strict_mode(True)  # errors are only warnings otherwise
    yield
    rr.set_strict_mode(False)


def two_blocks():
    """A map whose sides are no multiples of a block's."""
    picture = np.zeros((41, 63), dtype=np.bool_)
    picture[14:18, 20:24] = picture[20:25, 38:42] = True
    return Problem(map_of(picture), (3, 12), (60, 25))


def run(planner, folder, trials=2, recorded=(0, 1), problem=None):
    problem = problem or two_blocks()
    recorders = [mcap.Recorder(step_s=0.1), rerun.Recorder(trials=list(recorded))]
    settings = {"task": "plan", "planner.kind": "visibility_ga"}
    method = Method("visibility_ga")
    described = Run(
        "survey", method, problem, PlanTask(planner), recorders, 7, trials, settings,
        str(folder), False,
    )  # fmt: skip
    return execute(described, "test", progress=False).folder


PLANNERS = {
    "ga": ga(robot_radius=2, keypoints="corners", population=100),
    "resized": ga(robot_radius=4, resize=True, keypoints="corners", genes=4, population=200),
    "exact": make("visibility_astar", robot_radius=2, keypoints="corners"),
}


@pytest.mark.parametrize("name", PLANNERS)
def test_a_log_has_it_once_bit_for_bit(name, tmp_path):
    planner = PLANNERS[name]
    events = list(mcap.read_events(run(planner, tmp_path, trials=3) / "run.mcap"))
    kinds = [type(event) for event in events]
    assert kinds.count(Surveyed) == 1 and kinds.count(TrialFinished) == 3
    assert kinds[:3] == [RunStarted, TrialStarted, Surveyed]
    assert kinds[3] is (TrialFinished if name == "exact" else Evolved)
    survey = planner.plan(two_blocks(), stream(7, 2)).survey()  # any trial's is the same
    assert plain(events[2]) == plain(Surveyed(0, 0, survey))
    assert survey.obstacles.any() and len(survey.edges) > 3
    assert (survey.block > 1) == (name == "resized")


@pytest.mark.parametrize("name", PLANNERS)
def test_every_trials_recording_shows_it(name, tmp_path):
    planner = PLANNERS[name]
    folder = run(planner, tmp_path)
    graph, problem = planner.plan(two_blocks(), stream(0)).survey(), two_blocks()
    for trial in (0, 1):
        found = read(folder / f"trial-{trial}.rrd")
        shows_the_graph(found, graph, problem)


def shows_the_graph(found, graph, problem):
    assert found["/map/keypoints", "Points2D:positions"] == centres(graph.points.tolist())
    edges = [centres(pair) for pair in graph.points[graph.edges].tolist()]
    assert found["/map/graph", "LineStrips2D:strips"] == edges
    rows, cols = problem.map.weights.shape
    buffer = np.array(found["/map/grown_obstacles", "Image:buffer"], dtype=np.uint8)
    rim = buffer.reshape(rows, cols, 4)
    y, x = np.mgrid[:rows, :cols]
    grown = graph.obstacles[y // graph.block, x // graph.block] & ~problem.map.obstacles
    assert ((rim[..., 3] > 0) == grown).all()
    assert len(np.unique(rim[grown], axis=0)) == 1
    text = found["/text", "TextDocument:text"][0]
    assert "**red**: obstacles grown by the robot's radius, keypoints" in text
    assert "**thin purple**: lines between keypoints" in text


def test_a_recording_of_another_trial_made_from_the_log_shows_it_too(tmp_path, capsys):
    planner = PLANNERS["ga"]
    folder = run(planner, tmp_path, recorded=(1,))
    direct = read(folder / "trial-1.rrd")
    again = tmp_path / "again"
    command = ["rerun", folder / "run.mcap", "--trials", "1", "-o", again]
    assert log_cli.main([str(word) for word in command]) == 0
    assert capsys.readouterr().out == f"{again / 'trial-1.rrd'}\n"
    found = read(again / "trial-1.rrd")
    assert found == direct
    shows_the_graph(found, planner.plan(two_blocks(), stream(0)).survey(), two_blocks())


def test_lengths_are_drawn_as_they_are_costs_by_their_logarithm(tmp_path):
    planner = PLANNERS["ga"]
    best = planner.plan(two_blocks(), stream(7, 0)).evolution.best
    found = read(run(planner, tmp_path) / "trial-0.rrd")
    drawn = [value[0] for _, value in found["/fitness/best", "Scalars:scalars"]]
    assert drawn == best.tolist()
    assert "control" not in "".join(entity for entity, _ in found)


@pytest.mark.parametrize("planner", ["astar", "inflated_astar", "ga1"])
def test_planners_without_a_survey_have_none(planner, tmp_path):
    made = make(planner, **({"robot_radius": 2} if planner == "inflated_astar" else {}))
    assert isinstance(made, Inflated) == (planner == "inflated_astar")
    folder = run(made, tmp_path, recorded=(0,))
    events = list(mcap.read_events(folder / "run.mcap"))
    assert not [event for event in events if isinstance(event, Surveyed)]
    entities = {entity for entity, _ in read(folder / "trial-0.rrd")}
    assert not entities & {"/map/graph", "/map/keypoints", "/map/grown_obstacles"}


def test_a_graph_without_a_way_is_shown(tmp_path):
    """No path in it: one sees why."""
    picture = two_blocks().map.obstacles.copy()
    picture[:-3, 35] = True  # the robot does not fit through, a point does
    problem = Problem(map_of(picture), (3, 12), (60, 25))
    folder = run(PLANNERS["ga"], tmp_path, problem=problem)
    events = list(mcap.read_events(folder / "run.mcap"))
    assert [type(event) for event in events[1:4]] == [TrialStarted, Surveyed, TrialFinished]
    assert events[3].answer.status is PlanStatus.INFEASIBLE
    shows_the_graph(read(folder / "trial-1.rrd"), events[2].graph, problem)
    assert (
        "in the graph that the planner made"
        in read(folder / "trial-1.rrd")["/text", "TextDocument:text"][0]
    )


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0, 100000, 40000, 1, [255], [0, 0], []), "1 bytes"),
        ((0, 1, 8, 0, [255], [0, 0], []), "blocks of 0"),
        ((0, 1, 8, 1, [255], [0, 0, 1, 1], [0, 2]), "2 points"),
        ((0, 1, 8, 1, [255], [0, 0, 1, 1], [-1, 0]), "2 points"),
    ],
)
def test_a_graph_that_cannot_be_is_refused_before_it_is_unpacked(values, message):
    trial, rows, cols, block, picture, points, edges = values
    made = record(
        "/graph", 0, trial, rows, cols, block, np.array(picture, dtype=np.uint8),
        np.array(points, dtype=np.int32), np.array(edges, dtype=np.int32),
    )  # fmt: skip
    with pytest.raises(InputError, match=message):
        event(*made)
