"""The benchmarks compare like with like: rivals must give identical results."""

import csv
import sys
from importlib import import_module

import naive_row_column
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from row_column_strategies import as_rows
from strategies import planner, problems

from benchmarks import __main__
from benchmarks.measure import MAPS, SETTINGS, interleave, make_planner, make_problem, quartiles
from benchmarks.questions import exact
from benchmarks.questions.kg18 import drives, ga_run, logging, sweep, threads
from benchmarks.questions.m22 import visibility, visibility_agreement, visibility_growth
from benchmarks.questions.s04 import row_column
from benchmarks.rivals import textbook, visibility_library
from gapath.kernels.rng import stream
from gapath.problem import CornerCutting, Problem


def check_kernels(problem, ga, seeds):
    streams = np.array([stream(seed) for seed in seeds])
    kernels = ga_run.KERNELS.values()
    ours, other = (ga_run.evolve_with(kernel, ga, problem, streams) for kernel in kernels)
    ga_run.check_identical(ours, other, "textbook")


@pytest.mark.parametrize("map_name", MAPS)
@pytest.mark.parametrize("name", SETTINGS)
def test_the_textbook_kernel_is_identical(map_name, name):
    check_kernels(make_problem(map_name), make_planner(name), range(5))


@settings(max_examples=50)
@given(problems(), st.integers(3, 5), st.booleans(), st.integers(0, 2**64 - 1))
def test_the_textbook_kernel_is_identical_on_random_maps(problem, k, clip_to_map, seed):
    problem = Problem(problem.map, problem.start, problem.target, CornerCutting.ALLOW)
    ga = planner(control_points=k, clip_to_map=clip_to_map, max_epochs=20)
    check_kernels(problem, ga, [seed, 2])


def test_another_result_is_noticed():
    problem, ga = make_problem("kg18_test3"), make_planner("ga1")
    streams = np.array([stream(seed) for seed in range(3)])
    ours = ga_run.evolve_with(ga_run.KERNELS["gapath"], ga, problem, streams)
    streams[2] = stream(3)
    other = ga_run.evolve_with(textbook.evolve, ga, problem, streams)
    with pytest.raises(RuntimeError, match="textbook kernel gives another run 2"):
        ga_run.check_identical(ours, other, "textbook")


def test_runs_are_timed_in_batches():
    times = ga_run.time_batches(make_planner("ga1"), make_problem("kg18_test1"), 2)
    assert list(times) == list(ga_run.KERNELS)
    assert all(len(sample) == 2 and min(sample) > 0 for sample in times.values())


def test_jobs_on_threads_are_the_same_jobs(monkeypatch):
    monkeypatch.setattr(threads, "MAPS", MAPS[:1])
    *rows, machine = threads.measure(quick=True)
    assert [row["runs"] for row in rows] == [30] * 4
    assert all(row["one / two"].median > 0 for row in rows)
    assert machine["runs"] == 20 and machine["what the machine gives"].median > 0
    assert "one / two" not in machine


def test_other_plans_on_two_threads_are_noticed(monkeypatch):
    monkeypatch.setattr(threads, "MAPS", MAPS[:1])
    monkeypatch.setattr(threads, "as_jobs", lambda jobs, number: [number])
    with pytest.raises(RuntimeError, match="fast ones first: two threads plan otherwise"):
        threads.measure(quick=True)


def test_generations_are_timed_for_every_rival(monkeypatch):
    monkeypatch.setattr(row_column, "ENLARGED", (1, 2))
    rows = row_column.measure(quick=True)
    assert [row["n"] for row in rows] == [10, 20]
    for row in rows:
        assert row["gapath epochs/s"].lower > 0 and row["gapath / twin"].lower > 0


def test_another_evolution_is_noticed():
    plan = make_planner("sedighi", max_epochs=2).plan(row_column.enlarged(1), stream(0))
    row_column.check_identical(plan, [{"chromosome": plan.evolution.chromosomes[0].tolist()}])
    with pytest.raises(RuntimeError, match="the twin's epochs are others"):
        row_column.check_identical(plan, [{"chromosome": [0] * 22}])


def test_without_deap_the_reason_is_stated(monkeypatch):
    monkeypatch.setattr(row_column, "ENLARGED", (1,))
    monkeypatch.setattr(row_column, "find_spec", lambda name: None)
    (row,) = row_column.measure(quick=True)
    assert row["DEAP epochs/s"] == "skipped: the bench extra is not installed"
    assert "gapath / DEAP" not in row and "gapath / twin" in row


@pytest.fixture
def deap():
    pytest.importorskip("deap", reason="the bench extra is not installed")
    return import_module("benchmarks.rivals.row_column_deap")


def by_the_twin(problem, chromosome):
    points = naive_row_column.corners(chromosome, problem.start, problem.target)
    return naive_row_column.measure(problem.map.weights, naive_row_column.walk(points))


def test_individuals_of_deap_have_the_twins_fitness(deap):
    problem, ga = row_column.enlarged(1), make_planner("sedighi", population=50)
    population = [deap.make_individual(10, ga) for _ in range(50)]
    deap.Rating(problem, ga)(population)
    measures = []
    for individual in population:
        location, direction = map(list, zip(*individual, strict=True))
        chromosome = naive_row_column.Chromosome(
            individual.flag, location, direction[:-1], individual.switch
        )
        measures.append(by_the_twin(problem, chromosome))
    values = [individual.fitness.values[0] for individual in population]
    assert values == naive_row_column.fitness(measures, 1, 2)


def test_deap_succeeds_as_often(deap):
    """Other random numbers, the same algorithm: rates differ by at most three standard errors."""
    problem, trials = make_problem("s04_sp03"), 80
    ga = make_planner("sedighi", population=30, max_epochs=40)
    ours = sum(ga.plan(problem, stream(0, trial)).feasible for trial in range(trials))
    theirs = 0
    for seed in range(trials):
        (row,) = as_rows(deap.evolve(problem, ga, seed))
        (obstacles, _), *_ = by_the_twin(problem, naive_row_column.Chromosome.of(row))
        theirs += obstacles == 0
    rate = (ours + theirs) / (2 * trials)
    assert 0.1 < rate < 0.9
    assert abs(ours - theirs) / trials < 3 * np.sqrt(2 * rate * (1 - rate) / trials)


def is_timed(row):
    return row["gapath"].lower > 0 and (not row.get("rival") or row["rival / gapath"].lower > 0)


@pytest.fixture
def library():
    if why := visibility_library.unavailable():
        pytest.skip(why)


def test_m22s_pieces_are_timed_against_every_rival(library, monkeypatch):
    monkeypatch.setattr(visibility, "MAPS", visibility.MAPS[:1])
    rows = visibility.measure(quick=True)
    assert all(map(is_timed, rows))
    rivals = [row["rival"] for row in rows if row["work"] == "image to path"]
    assert rivals == ["the paper", *visibility.TARGETS]
    parts = [row["gapath"].median for row in rows if row["work"].startswith("...")]
    assert len(parts) == 5 and np.isclose(sum(parts), rows[0]["gapath"].median)
    assert [row["rival"] for row in rows[-3:]] == [*visibility.TARGETS, "XOR of images"]


def test_without_the_library_m22s_rows_say_why(monkeypatch):
    monkeypatch.setattr(visibility, "MAPS", visibility.MAPS[:1])
    monkeypatch.setattr(visibility_library, "find_spec", lambda name: None)
    rows = [row for row in visibility.measure(quick=True) if row.get("rival") in visibility.TARGETS]
    assert len(rows) == 4
    for row in rows:
        assert row["its time"] == "skipped: the bench extra is not installed"
        assert row["gapath"].lower > 0 and "rival / gapath" not in row


def test_lines_that_another_test_finds_free_are_noticed(monkeypatch):
    scene = visibility_agreement.Scene.of(visibility.MAPS[0])
    assert visibility.time_lines(scene, 30, 1)["rival / gapath"].median > 0
    monkeypatch.setattr(visibility, "drawn_and_compared", lambda image, line: True)
    with pytest.raises(RuntimeError, match=r"lines free: \d+ and 30 of 30"):
        visibility.time_lines(scene, 30, 1)


def test_both_target_functions_of_the_library_are_the_same():
    scene = visibility_agreement.Scene.of(visibility.MAPS[0])
    one, other = (make(scene.lengths, scene.penalty) for make in visibility.TARGETS.values())
    chromosomes = np.random.default_rng(0).integers(0, len(scene.lengths), (2000, scene.genes))
    values = [one(chromosome.astype(float)) for chromosome in chromosomes]
    assert values == [other(chromosome.astype(float)) for chromosome in chromosomes]
    assert 0 < values.count(scene.penalty) < len(values)


def test_the_library_here_does_what_was_kept(library, tmp_path):
    visibility_library.export(tmp_path)
    found, kept = visibility_library.reference(tmp_path, 3), visibility_agreement.reference("v69")
    if found["geneticalgorithm2"] != kept["geneticalgorithm2"]:
        pytest.skip(f"geneticalgorithm2 {found['geneticalgorithm2']}, kept were runs of another")
    for name, scene in kept["scenes"].items():
        for key in visibility_agreement.MEASURES:
            assert found["scenes"][name][key] == scene[key][:3]


def test_growing_pictures_are_timed_with_and_without_resizing(monkeypatch):
    monkeypatch.setattr(visibility_growth, "SIZES", ((200, 150), (400, 300)))
    rows = visibility_growth.measure(quick=True)
    assert [(row["picture"], row["obstacles"]) for row in rows] == [
        (size, count) for count in (6, 20) for size in ("200 x 150", "400 x 300")
    ]
    for row in rows:
        assert row["whole"].median > sum(row[stage].median for stage in visibility_growth.STAGES)
        assert row["resize: whole"].median > row["resize: search"].median > 0
        assert row["without search"].median > row["whole / resized"].median > 0
        assert row["resize: scale"] >= 1


def test_quartiles_and_orders():
    assert quartiles([3.0, 1.0, 2.0, 5.0, 4.0]) == (3.0, 2.0, 4.0)
    assert quartiles([7.0]) == (7.0, 7.0, 7.0)
    order = []
    rivals = {name: lambda name=name: order.append(name) or name for name in "ab"}
    times, results = interleave([rivals] * 20)
    assert {"".join(order[i : i + 2]) for i in range(0, 40, 2)} == {"ab", "ba"}
    assert results == [{"a": "a", "b": "b"}] * 19
    assert {name: len(sample) for name, sample in times.items()} == {"a": 19, "b": 19}


def test_the_parts_of_a_sweep_add_up(monkeypatch):
    monkeypatch.setattr(sweep, "MAPS", MAPS[:1])
    rows = sweep.measure(quick=True)
    assert [row["planner"] for row in rows] == [*SETTINGS, "all"]
    for row in rows:
        parts = [row[name] for name in ("planning s", "logging s", "rest s")]
        assert np.isclose(sum(parts), row["one thread s"])
        assert row["one thread s"] > row["planning s"] > 0 and row["total s"] > 0


def test_logged_trials_have_the_epochs_asked_for(tmp_path):
    log = logging.TrialLog("kg18_test3", 8, 12, str(tmp_path))
    assert {trial.plan.epochs for trial in log.trials} <= set(range(8, 13))
    assert log.time() > 0
    assert all("evolution" not in vars(trial.plan) for trial in log.trials)
    log.recorder.close()
    assert (tmp_path / "run.mcap").stat().st_size > 0


def test_a_clocked_drive_is_the_same_drive():
    run = drives.make_drive_run("kg18_map1", "kg18", 1)
    plain = drives.drive_once(run.task, run.problem, 3)
    clocked, outside = drives.drive_clocked(run.task, run.problem, 3)
    assert [frame.place for frame in clocked.frames] == [frame.place for frame in plain.frames]
    assert plain.frames[-1].place == run.problem.target
    assert 0 < outside < 1


def test_every_navigator_takes_the_same_drives():
    rows = drives.time_drives("kg18_map1", 2)
    assert [row["navigator"] for row in rows] == list(drives.NAVIGATORS)
    assert all(row["drives"] == row["reached"] == 2 for row in rows)
    assert all(0 < row["drive ms"].lower <= row["drive ms"].upper for row in rows)
    assert all(row["paper / drive"].median > 0 for row in rows)
    assert ["outside planners" in row for row in rows] == [
        name == "kg18" for name in drives.NAVIGATORS
    ]


def test_a_changed_drive_is_noticed(monkeypatch):
    def another(task, problem, trial):
        return drives.drive_once(task, problem, trial + 1), 0.5

    monkeypatch.setattr(drives, "drive_clocked", another)
    with pytest.raises(RuntimeError, match="kg18_map3: clocks around the planners changed"):
        drives.time_drives("kg18_map3", 1)


def test_drives_are_logged_and_recorded():
    row = drives.time_logs("kg18_map1", 2)
    assert np.isclose(row["driving s"] + row["rest s"], row["total s"])
    assert row["driving s"] > 0 and row["rest s"] > 0 and row["log MB"] > 0
    row = drives.time_recording(1)
    assert row["steps"] == 500
    assert row["recording s"].median > 0 and 0 < row["recording MB"] < 1


def test_the_command_writes_what_it_prints(tmp_path, monkeypatch, capsys):
    output = tmp_path / "bench"
    monkeypatch.setattr(__main__, "QUESTIONS", {"exact": "exact"})
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--output", str(output), "--quick"])
    __main__.main()
    printed = capsys.readouterr()
    with (output / "exact.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(MAPS) * len(exact.PEERS)
    solved = [row for row in rows if not row["solve us"].startswith("skipped")]
    assert all(float(row["solve us q1"]) <= float(row["solve us"]) for row in solved)
    page = (output / "README.md").read_text()
    assert "quick, not to be quoted" in page and "| kg18_test4 | skimage MCP" in page
    assert "1/1 exact" in printed.err
    assert printed.out.endswith(f"{output}: README.md, exact.csv\n")


def test_a_file_is_no_output_folder(tmp_path, monkeypatch, capsys):
    file = tmp_path / "file"
    file.touch()
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--output", str(file)])
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert ended.value.code == 2
    assert f"--output {file}" in capsys.readouterr().err
