"""What a Rerun recording holds, read back from its file."""

import dataclasses
import math
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from recordings import centres, read, record, rerun_command
from rerun.chunk import RrdReader

import gapath
from gapath.errors import InputError
from gapath.events import Evolved, RunFinished, RunStarted, TrialFinished, TrialStarted
from gapath.grid import GridMap
from gapath.history.evolution import Evolution
from gapath.problem import Answer, PlanStatus, Problem
from gapath.recorders.rerun import Recorder

CONF = Path(gapath.__file__).parent.parent / "conf" / "recorder" / "rerun.yaml"


@pytest.fixture(autouse=True)
def strict():
    rr.set_strict_mode(True)  # errors are only warnings otherwise
    yield
    rr.set_strict_mode(False)


def evolution(seed, epochs, genes=10, genotype="control_points"):
    rng = np.random.default_rng(seed)
    best = np.sort(rng.integers(0, 15, epochs))[::-1] * 1e5 + rng.integers(0, 200, epochs) / 2
    return Evolution(
        best=best,
        mean=best * 2 + 1,
        chromosomes=rng.integers(-20, 60, (epochs, genes)).astype(np.int32),
        way_points=rng.integers(-20, 60, (epochs, 5, 2)).astype(np.int32),
        genotype=genotype,
    )


def run_of(evolutions, trials=1, status=PlanStatus.FOUND, source="reconstructed", **changes):
    """Make the events of a run whose every trial consists of these evolutions."""
    weights = np.full((20, 40), 0.5)
    weights[5:10, 10:20] = 1
    weights[12, 3] = 0
    grid = GridMap("kg18_test3", weights, source=source)
    path = np.array([[x, 2] for x in range(40)], dtype=np.int32)
    run = RunStarted(
        experiment="table1",
        method="ga3",
        task="plan",
        problem=Problem(grid, (0, 2), (39, 2)),
        seed=7,
        trials=trials,
        settings={"planner.population": 100},
        versions={"gapath": "0.1.0"},
        optimal_path=path,
        optimal_cost=20.0,
    )
    yield dataclasses.replace(run, **changes)
    step = 0
    for trial in range(trials):
        yield TrialStarted(step, trial, 7)
        began = step
        for call, one in enumerate(evolutions):
            yield Evolved(step, trial, call, one)
            step += len(one.best)
        found = path if status is PlanStatus.FOUND else path[:0]
        answer = Answer(status, found, 21.5, 0, 0.0, step - began, 3000, 17)
        yield TrialFinished(step, trial, answer)
        step += not evolutions
    yield RunFinished(step, trials, trials if status is PlanStatus.FOUND else 0)


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def line_by_definition(way_points):
    """Rasterise with exact fractions: field i is floor(a + i d / n + 1/2)."""
    fields = [tuple(int(v) for v in way_points[0])]
    for a, b in zip(way_points[:-1].tolist(), way_points[1:].tolist(), strict=True):
        n = max(abs(b[0] - a[0]), abs(b[1] - a[1]))
        for i in range(1, n + 1):
            fields.append(
                tuple(
                    math.floor(a[k] + Fraction(i * (b[k] - a[k]), n) + Fraction(1, 2))
                    for k in range(2)
                )
            )
    return fields


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 2**32), lengths=st.lists(st.integers(1, 12), min_size=1, max_size=3))
def test_every_epoch_reads_back(tmp_path, seed, lengths):
    evolutions = [evolution(seed + i, epochs) for i, epochs in enumerate(lengths)]
    events = list(run_of(evolutions))
    assert record(tmp_path, events) == ["trial-0.rrd"]
    found = read(tmp_path / "trial-0.rrd")
    grid = events[0].problem.map
    rows = [
        (e.best[i], e.mean[i], e.chromosomes[i], e.way_points[i])
        for e in evolutions
        for i in range(len(e.best))
    ]

    def column(entity, component):
        values = found[entity, component]
        assert [epoch for epoch, _ in values] == list(range(1, len(rows) + 1))
        return [value for _, value in values]

    lines = [line_by_definition(way_points) for *_, way_points in rows]
    blocked = [
        sum(
            not (0 <= x < grid.cols and 0 <= y < grid.rows) or grid.weights[y, x] == 1
            for x, y in line
        )
        for line in lines
    ]
    controls = [centres(zip(row[2][::2], row[2][1::2], strict=True)) for row in rows]
    assert column("/map/best/path", "LineStrips2D:strips") == [[centres(v)] for v in lines]
    assert column("/map/best/control_polygon", "LineStrips2D:strips") == [[v] for v in controls]
    assert column("/map/best/control_points", "Points2D:positions") == controls
    assert column("/map/best/way_points", "Points2D:positions") == [centres(row[3]) for row in rows]
    assert column("/obstacles/best", "Scalars:scalars") == [[v] for v in blocked]
    for entity, k in (("/fitness/best", 0), ("/fitness/mean", 1)):
        drawn = 10 ** np.array(column(entity, "Scalars:scalars"))[:, 0]
        np.testing.assert_allclose(drawn, [row[k] for row in rows], rtol=1e-12)
    assert found["/map/final_path", "LineStrips2D:strips"] == [
        (len(rows), [centres(events[-2].answer.path)])
    ]


def test_what_no_epoch_changes(tmp_path):
    record(tmp_path, run_of([evolution(1, 3)]))
    found = read(tmp_path / "trial-0.rrd")
    path = centres((x, 2) for x in range(40))
    assert found["/map/optimal_path", "LineStrips2D:strips"] == [path]
    assert found["/map/start", "Points2D:positions"] == [[0.5, 2.5]]
    assert found["/map/target", "Points2D:positions"] == [[39.5, 2.5]]
    grey = np.array(found["/map", "Image:buffer"], dtype=np.uint8).reshape(20, 40)
    assert (grey[7, 15], grey[0, 0], grey[12, 3]) == (255, 64, 0)
    text = found["/text", "TextDocument:text"][0]
    for part in ("ga3 on kg18_test3", "kg18_test3 (reconstructed)", "found", "21.5", "3000",
                 "| seed, trial | 7, 0 |", "population: 100", "gapath 0.1.0"):  # fmt: skip
        assert part in text


def test_only_reconstructed_maps_are_marked(tmp_path):
    record(tmp_path, run_of([evolution(1, 3)], source="movingai"))
    assert "reconstructed" not in read(tmp_path / "trial-0.rrd")["/text", "TextDocument:text"][0]


def test_recordings_of_other_maps_have_a_layout_of_their_own(tmp_path):
    def application(name, trial=0, **changes):
        folder = tmp_path / name
        folder.mkdir()
        record(folder, run_of([evolution(1, 3)], trials=2, **changes), [trial])
        (entry,) = RrdReader(str(folder / f"trial-{trial}.rrd")).recordings()
        return entry.application_id

    first = application("first")
    assert application("trial", trial=1) == first
    assert application("map", source="movingai") != first


def test_planner_without_epochs(tmp_path):
    record(tmp_path, run_of([]))
    found = read(tmp_path / "trial-0.rrd")
    path = centres((x, 2) for x in range(40))
    assert found["/map/final_path", "LineStrips2D:strips"] == [path]
    assert "| expansions | 17 |" in found["/text", "TextDocument:text"][0]
    assert not [entity for entity, _ in found if entity.startswith(("/map/best", "/fitness"))]


def test_nothing_found_and_no_path_at_all(tmp_path):
    empty = np.empty((0, 2), dtype=np.int32)
    record(
        tmp_path,
        run_of([], status=PlanStatus.INFEASIBLE, optimal_path=empty, optimal_cost=math.inf),
    )
    found = read(tmp_path / "trial-0.rrd")
    assert "| optimal cost | none |" in found["/text", "TextDocument:text"][0]
    assert not [e for e, _ in found if e in ("/map/final_path", "/map/optimal_path")]


def test_other_genotypes_have_no_control_points(tmp_path):
    record(tmp_path, run_of([evolution(1, 3, genes=7, genotype="row_column")]))
    entities = {entity for entity, _ in read(tmp_path / "trial-0.rrd")}
    assert "/map/best/path" in entities
    assert not [entity for entity in entities if "control" in entity]


def test_fitness_without_logarithm_leaves_a_gap(tmp_path):
    flat = evolution(1, 3)._replace(best=np.array([10.0, 0.0, -1.0]))
    record(tmp_path, run_of([flat]))
    values = [v[0] for _, v in read(tmp_path / "trial-0.rrd")["/fitness/best", "Scalars:scalars"]]
    assert values[0] == 1 and not np.isfinite(values[1:]).any()


def test_the_files_are_verified_and_equal_for_equal_events(tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        (tmp_path / name).mkdir()
        record(tmp_path / name, run_of([evolution(seed, 9)]))
    a, b, c = (tmp_path / name / "trial-0.rrd" for name in "abc")
    verified = rerun_command("rrd", "verify", a, c)
    assert verified.returncode == 0, verified.stderr
    assert rerun_command("rrd", "compare", a, b).returncode == 0
    assert rerun_command("rrd", "compare", a, c).returncode != 0
    assert read(a) == read(b)
    assert "/viewport" in rerun_command("rrd", "print", a).stdout  # the blueprint is inside


def test_a_damaged_file_is_not_verified(tmp_path):
    record(tmp_path, run_of([evolution(1, 9)]))
    cut = tmp_path / "cut.rrd"
    cut.write_bytes((tmp_path / "trial-0.rrd").read_bytes()[:20_000])
    assert rerun_command("rrd", "verify", cut).returncode != 0


def test_chosen_trials_only(tmp_path):
    names = record(tmp_path, run_of([evolution(1, 2)], trials=5), trials=[3, 1])
    assert sorted(names) == files(tmp_path) == ["trial-1.rrd", "trial-3.rrd"]
    found = read(tmp_path / "trial-3.rrd")
    assert [epoch for epoch, _ in found["/fitness/best", "Scalars:scalars"]] == [1, 2]
    assert "| seed, trial | 7, 3 |" in found["/text", "TextDocument:text"][0]


def test_files_are_parts_until_closed(tmp_path):
    recorder = Recorder(trials=[0, 1])
    recorder.open(str(tmp_path))
    for event in list(run_of([evolution(1, 2)], trials=2))[:5]:  # trial 1 is under way
        recorder.record(event)
    recorder.abort()
    assert files(tmp_path) == ["trial-0.rrd.part"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_a_full_disk_is_an_error(tmp_path, monkeypatch):
    new_file = "gapath.store.durable.new_file"
    monkeypatch.setattr(new_file, lambda path: Path("/dev/full").open("wb"))  # noqa: SIM115
    with pytest.raises(InputError, match="No space left"):
        record(tmp_path, run_of([evolution(1, 2)]))


@pytest.mark.parametrize("trials", [[-1], [0, -3], [10**6], [1.0], [True], ["0"], None, 3])
def test_bad_trials(trials):
    with pytest.raises(InputError, match=r"^recorder\.rerun\.trials: got"):
        Recorder(trials=trials)


def test_trials_outside_the_run(tmp_path):
    with pytest.raises(InputError, match=r"recorder\.rerun\.trials: got \[0, 5\], .* 0 to 4"):
        record(tmp_path, run_of([evolution(1, 2)], trials=5), trials=[0, 5])
    assert files(tmp_path) == []


def test_the_settings_are_those_of_the_yaml():
    text = CONF.read_text()
    assert text.startswith("# @package recorder.rerun\n")
    values = yaml.safe_load(text)
    assert values.pop("kind") == "rerun"
    assert Recorder(**values).trials == [0]


def test_long_runs_are_small(tmp_path):
    events = list(run_of([evolution(1, 500)]))
    record(tmp_path, events)
    assert (tmp_path / "trial-0.rrd").stat().st_size < 1_000_000


def test_rerun_is_imported_only_when_a_trial_is_recorded():
    code = "import sys, gapath.recorders.rerun; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0
