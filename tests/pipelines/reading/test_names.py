"""What stands in one row of a table: data decide, a name never does."""

import dataclasses
from pathlib import Path

import pytest

from gapath.pipelines.reading.collect import read_trials
from gapath.pipelines.reading.names import told_apart
from gapath.store.records import find_runs

from ..conftest import record_of

EMPTY = "type octile\nheight 8\nwidth 30\nmap\n" + ("." * 30 + "\n") * 8
WALL = EMPTY.replace("." * 30, "." * 15 + "@" + "." * 14, 7)


def run_of(settings, key="a", **known):
    """Make what is known of a run of a planner of one's own."""
    run = record_of("ga1", key, **known)
    manifest = dataclasses.replace(run.known, preset="my_ga", method="my_ga")
    run = dataclasses.replace(run, manifest=manifest)
    vars(run)["settings"] = {"task": "plan", "map.kind": "file", "seed": 0, **settings}
    return run


def methods(*runs):
    return [run.known.method for run in told_apart(runs)]


def maps(*runs):
    return [run.known.map for run in told_apart(runs)]


def test_settings_tell_methods_of_one_name_apart():
    runs = [run_of({"planner.population": n, "planner.kind": "bspline_ga"}) for n in (20, 150, 20)]
    assert methods(*runs) == [
        "my_ga[population=20]",
        "my_ga[population=150]",
        "my_ga[population=20]",
    ]
    assert told_apart(runs)[0].known.changes == {"planner.population": 20}


def test_what_is_missing_in_one_tells_them_apart():
    assert methods(run_of({"planner.a": 1}), run_of({})) == ["my_ga[a=1]", "my_ga[a=none]"]


def test_lists_are_shown_whole():
    runs = [run_of({"planner.sides[0]": 1}), run_of({"planner.sides[0]": 1, "planner.sides[1]": 2})]
    assert methods(*runs) == ["my_ga[sides=[1]]", "my_ga[sides=[1, 2]]"]


def test_seeds_trials_maps_and_recorders_are_no_other_method():
    others = ({"seed": 1}, {"trials": 9}, {"map.path": "x"}, {"recorder.mcap.kind": "mcap"})
    assert set(methods(*map(run_of, others))) == {"my_ga"}


def test_what_a_file_holds_tells_methods_apart():
    runs = [run_of({}, method_inputs={"a/k.map": digest * 32}) for digest in ("ab", "cd", "ab")]
    assert methods(*runs) == [
        "my_ga[k.map=abababab]",
        "my_ga[k.map=cdcdcdcd]",
        "my_ga[k.map=abababab]",
    ]


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        ({"map_digest": "1"}, {"map_digest": "1"}, ["office", "office"]),
        ({"map_digest": "1", "path": "a/office.map"}, {"map_digest": "2", "path": "b/office.map"},
         ["office[path=a/office.map]", "office[path=b/office.map]"]),
        ({"map_digest": "1", "path": "a/office.map"}, {"map_digest": "1", "path": "b/office.map"},
         ["office", "office"]),
        ({"map_digest": "1"}, {"map_digest": "2"}, ["office[content=1]", "office[content=2]"]),
        ({"start": "(0, 0)"}, {"start": "(1, 0)"},
         ["office[start=(0, 0),target=(9, 9)]", "office[start=(1, 0),target=(9, 9)]"]),
        ({"map_digest": "1", "map_instance": 0}, {"map_digest": "2", "map_instance": 1},
         ["office", "office"]),
    ],
)  # fmt: skip
def test_maps_of_one_name_are_told_apart_by_content_and_ends(first, second, names):
    def run(path="office.map", **known):
        return run_of({"map.path": path}, map="office", **known)

    found = maps(run(**first), run(**second))
    assert found == [name.replace(",target=(9, 9)", "") for name in names]


def test_two_folders_with_a_map_of_one_name_are_two_rows(gapath, tmp_path):
    for name, text in (("a", EMPTY), ("b", WALL)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "office.map").write_text(text)
        run = (f"map.path={tmp_path / name / 'office.map'}", "map.start=[0,0]", "map.target=[29,7]")
        assert gapath("map=file", *run, "planner=ga1", "recorder=none", "trials=3")[0] == 0
    trials = read_trials(find_runs(tmp_path / "out")).trials["plan"]
    assert trials.groupby("map").size().tolist() == [3, 3]
    assert trials["map"].str.contains("office").all()
    assert trials.groupby("map")["map_digest"].nunique().tolist() == [1, 1]


def test_a_yaml_that_was_edited_in_between_is_another_method(gapath, tmp_path):
    folder = tmp_path / "conf" / "planner"
    folder.mkdir(parents=True)
    text = "defaults: [ga1]\npopulation: {}\n"
    for population in (20, 150):
        (folder / "my_ga.yaml").write_text(text.format(population))
        run = ("--config-dir", str(tmp_path / "conf"), "planner=my_ga", "map=kg18_test1")
        assert gapath(*run, "recorder=none", "trials=2")[0] == 0
    trials, _, runs = read_trials(find_runs(tmp_path / "out"))
    names = ["my_ga[population=150]", "my_ga[population=20]"]
    assert sorted(trials["plan"]["planner"].unique()) == names
    assert sorted(run.settings["planner.population"] for run in runs) == [20, 150]


def test_an_edited_file_that_a_method_reads_is_another_run(gapath, tmp_path):
    known = tmp_path / "k.map"
    run = ("task=drive", "map=kg18_map1", "navigator=replan_astar", "recorder=none")
    rows = "type octile\nheight 50\nwidth 100\nmap\n" + ("." * 100 + "\n") * 50
    known.write_text(rows)
    command = (*run, f"drive.known_map={known}")
    assert "skipped" not in gapath(*command)[1]
    assert "skipped" in gapath(*command)[1]
    known.write_text(rows.replace(".", "@", 1))
    assert "skipped" not in gapath(*command)[1]
    runs = find_runs(tmp_path / "out")
    assert len(runs) == 2
    assert all(Path(path).name == "k.map" for run in runs for path in run.known.method_inputs)
    assert len({run.known.method for run in read_trials(runs).runs}) == 2


def test_a_yaml_of_ones_own_is_named_with_what_was_typed(gapath, tmp_path):
    folder = tmp_path / "conf" / "planner"
    folder.mkdir(parents=True)
    (folder / "my_ga.yaml").write_text("defaults: [ga1]\npopulation: 30\n")
    run = ("--config-dir", str(tmp_path / "conf"), "planner=my_ga", "map=kg18_test1")
    code, text, errors = gapath(
        "-m", *run, "planner.population=20,150", "recorder=none", "trials=2"
    )
    assert (code, errors) == (0, "")
    assert "my_ga[population=20]:" in text and "my_ga[population=150]:" in text
    (first, _) = find_runs(tmp_path / "out")
    assert f"--config-dir={tmp_path / 'conf'} planner=my_ga" in first.known.command


def test_one_map_under_several_paths_is_one_setting(gapath, tmp_path):
    """Its trials would be counted as often as there are spellings."""
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "m.map").write_text(WALL)
    ends = ("map.start=[0,0]", "map.target=[29,7]", "planner=ga1", "recorder=none", "trials=3")
    for kind, path in [("movingai", "a/m.map"), ("movingai", "./a/m.map"), ("file", "b/m.map")]:
        assert gapath(f"map={kind}", f"map.path={path}", *ends)[0] == 0
    trials, skipped, _ = read_trials(find_runs(tmp_path / "out"))
    assert len(trials["plan"]) == 3
    assert [entry.reason.endswith("counts, of the same setting") for entry in skipped] == [True] * 2


def test_of_one_setting_and_code_the_run_of_most_trials_counts(gapath, tmp_path):
    for trials in (5, 2):
        assert gapath("map=kg18_test1", "planner=ga1", "recorder=none", f"trials={trials}")[0] == 0
    assert len(read_trials(find_runs(tmp_path / "out")).trials["plan"]) == 5


def test_a_yaml_that_has_a_name_of_gapaths_is_refused(gapath, tmp_path):
    folder = tmp_path / "conf" / "planner"
    folder.mkdir(parents=True)
    (folder / "ga3.yaml").write_text("kind: bspline_ga\n")
    code, _, errors = gapath("--config-dir", str(tmp_path / "conf"), "planner=ga3", "recorder=none")
    assert code == 2 and "another name: gapath has its own ga3" in errors
    assert len(errors.splitlines()) == 1


@pytest.mark.parametrize("content", [b"population: [80", b"defaults: ga3", b"\xff\xfe"])
def test_a_yaml_that_cannot_be_read_is_one_line(content, gapath, tmp_path):
    folder = tmp_path / "conf" / "planner"
    folder.mkdir(parents=True)
    (folder / "mine.yaml").write_bytes(content)
    code, out, errors = gapath("--config-dir", str(tmp_path / "conf"), "planner=mine")
    assert (code, out) == (2, "") and len(errors.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_two_scenarios_of_one_map_are_told_apart():
    """Though each run stands for the same one of its problems."""
    runs = [run_of({"map.scenario": "x.scen"}, key, queries=key * 64) for key in "ab"]
    assert maps(*runs) == ["kg18_test1[problems=aaaaaaaa]", "kg18_test1[problems=bbbbbbbb]"]
    one = run_of({"map.scenario": "x.scen"}, "c")
    assert maps(runs[0], one) == ["kg18_test1[problems=aaaaaaaa]", "kg18_test1[problems=one]"]
