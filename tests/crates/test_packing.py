"""Runs into a crate: what is in it, whole or not at all, and nothing of the machine."""

import json
import os
import shutil
from pathlib import Path

import pytest
from runs_for_crates import called, make_runs, resealed, run_with

from gapath.crates import packing
from gapath.crates.plain import without_folders
from gapath.recorders import mcap
from gapath.store.durable import open_regular
from gapath.store.records import Manifest, find_runs


@pytest.fixture
def made(gapath):
    return make_runs(gapath)


def graph_of(crate):
    content = json.loads((Path(crate) / "ro-crate-metadata.json").read_bytes())
    return {entity["@id"]: entity for entity in content["@graph"]}


def files_of(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def values(graph, references):
    found = (graph[each["@id"]] for each in references)
    return {each["name"]: each["value"] for each in found if each["@type"] == "PropertyValue"}


def test_a_run_is_described(made, capfd):
    run = run_with(made, "astar")
    code, out, err = called(capfd, "crate", run, "crate")
    graph = graph_of("crate")
    action = graph[f"#office/{run.name}"]
    assert (code, err) == (0, "")
    assert action["name"] == "astar on office, 2 trials, seed 0"
    assert action["startTime"] < action["endTime"]
    assert (
        graph[action["instrument"]["@id"]]["softwareVersion"]
        == Manifest.read(run).versions["gapath"]
    )
    settings, figures = values(graph, action["object"]), values(graph, action["result"])
    assert (settings["planner.kind"], settings["trials"]) == ("grid_search", 2)
    assert (figures["trials"], figures["succeeded"], figures["cost"]) == (2, 2, 3.5)
    assert values(graph, action["environment"])["numpy"] == Manifest.read(run).versions["numpy"]
    (own,) = (each for each in graph if each.endswith("office.map"))
    assert Path("crate", own).read_bytes() == Path("office.map").read_bytes()
    assert {"@id": own} in action["object"]
    assert f"with {own}" in out


def test_an_experiment_is_all_of_its_whole_runs(made, capfd):
    (run_with(made, "dijkstra") / "status.json").write_text("{}")
    code, out, err = called(capfd, "crate", "office", "crate", "--outputs", "out")
    assert (code, err.count("\n")) == (0, 1)
    assert f"left out office/{run_with(made, 'dijkstra').name}" in err
    assert out.startswith("crate: 1 run, ")
    assert (
        len([each for each in graph_of("crate").values() if each["@type"] == "CreateAction"]) == 1
    )


def test_a_crate_is_a_folder_of_runs(made, capfd):
    assert called(capfd, "crate", made, "crate")[0] == 0
    assert [run.fault for run in find_runs(Path("crate"))] == ["", ""]
    for run in find_runs(Path("crate")):
        assert run.known.results == Manifest.read(made / run.folder.name).results
        for name in run.known.files:
            assert (run.folder / name).read_bytes() == (made / run.folder.name / name).read_bytes()


def test_the_same_runs_give_the_same_bytes_wherever_they_lie(made, capfd):
    called(capfd, "crate", made, "one")
    shutil.move("out", "elsewhere")
    called(capfd, "crate", "elsewhere/office", "deep/in/two")
    assert files_of(Path("one")) == files_of(Path("deep/in/two"))


def test_no_folder_of_the_machine_is_in_it(made, tmp_path, capfd):
    """The map was named by a relative path; manifests know it by its whole one."""
    run = run_with(made, "astar")
    known = Manifest.read(run)
    inputs = {str(tmp_path / path): sha for path, sha in known.map_inputs.items()}
    resealed(run, map_inputs=inputs, command=f"gapath --config-dir={tmp_path}/conf map=office")
    assert called(capfd, "crate", run, "crate")[0] == 0
    for data in files_of(Path("crate")).values():
        assert os.fsencode(tmp_path) not in data
    assert (
        Manifest.read(Path("crate/office") / run.name).command
        == "gapath --config-dir=conf map=office"
    )


def test_a_folder_that_was_typed_is_told(gapath, tmp_path, capfd):
    made = make_runs(gapath)
    code, _, err = gapath(
        "name=typed", "map=file", f"map.path={tmp_path}/office.map", "map.start=[0,0]",
        "map.target=[5,3]", "planner=astar", "recorder=mcap",
    )  # fmt: skip
    assert code == 0, err
    code, out, _ = called(capfd, "crate", made.parent / "typed", "crate")
    assert f"say map.path: {tmp_path}/office.map, as it was typed" in out
    assert os.fsencode(tmp_path) not in Path("crate/ro-crate-metadata.json").read_bytes()


@pytest.mark.parametrize("gone", [True, False])
def test_a_map_that_is_gone_or_changed_is_not_in_it_and_told(made, capfd, gone):
    if gone:
        Path("office.map").unlink()
    else:
        Path("office.map").write_text("another one")
    code, out, _ = called(capfd, "crate", run_with(made, "astar"), "crate")
    assert code == 0
    assert "without office.map, which is gone or has changed; its map is in the log" in out
    assert not list(Path("crate").rglob("office.map"))
    told = [each for each in graph_of("crate").values() if each.get("name") == "office.map"]
    assert [each["@type"] for each in told] == ["CreativeWork"]
    assert called(capfd, "repeat", "crate")[0] == 0


def test_a_run_without_a_log_is_told(made, capfd):
    run = run_with(made, "astar")
    (run / mcap.FILE).unlink()
    resealed(run)
    assert "has no log, so nobody can repeat it" in called(capfd, "crate", run, "crate")[1]


BAD = {
    "nothing of that name": (["crate", "nowhere", "crate"], "outputs: got no"),
    "no name": (["crate", "", "crate", "--outputs", "nowhere"], "nowhere: got no such folder"),
    "all experiments": (["crate", "out", "crate"], "out: got no run"),
    "a folder that has something": (["crate", "out/office", "full"], "full: got something"),
    "a file": (["crate", "out/office", "office.map"], "office.map: got something"),
    "a licence that is no address": (
        ["crate", "out/office", "crate", "--licence", "MIT"], "--licence: got MIT"),
    "an organization without an address": (
        ["crate", "out/office", "crate", "--organization", "Us", "us"], "--organization: got us"),
}  # fmt: skip


@pytest.mark.parametrize("arguments, told", BAD.values(), ids=BAD)
def test_what_cannot_be_packed_is_one_line(made, capfd, arguments, told):
    Path("full").mkdir()
    Path("full/note").touch()
    before = files_of(Path())
    code, out, err = called(capfd, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert told in err
    assert files_of(Path()) == before


def test_a_run_that_is_not_whole_is_refused(made, capfd):
    run = run_with(made, "astar")
    (run / "trials.parquet").write_bytes(b"short")
    code, out, err = called(capfd, "crate", run, "crate")
    assert (code, out, err.count("\n")) == (2, "", 2)
    assert "trials.parquet" in err
    assert not Path("crate").exists()


def test_a_file_that_was_altered_is_found_while_it_is_copied(made, capfd):
    run = run_with(made, "astar")
    data = bytearray((run / "run.mcap").read_bytes())
    data[100] ^= 1
    (run / "run.mcap").write_bytes(data)
    code, _, err = called(capfd, "crate", run, "crate")
    assert (code, err.count("\n")) == (2, 1)
    assert "run.mcap" in err
    assert not Path("crate").exists()
    assert sorted(each.name for each in Path().iterdir()) == ["office.map", "out"]


def test_a_link_in_a_run_is_not_followed(made, tmp_path, capfd):
    run = run_with(made, "astar")
    (run / "run.mcap").rename(tmp_path / "kept")
    (run / "run.mcap").symlink_to(tmp_path / "kept")
    code, _, err = called(capfd, "crate", run, "crate")
    assert (code, err.count("\n")) == (2, 2)  # the folder's state, then what to do
    assert not Path("crate").exists()


def test_a_manifest_that_names_places_elsewhere_writes_only_within(made, capfd):
    run = run_with(made, "astar")
    resealed(run, experiment="../../elsewhere", key="../x")
    assert called(capfd, "crate", run, "deep/crate")[0] == 0
    assert [each.name for each in Path("deep").iterdir()] == ["crate"]
    assert not Path("elsewhere").exists()


def test_what_stops_on_the_way_leaves_nothing(made, monkeypatch, capfd):
    def full(path, links=False):
        if Path(path).name == "trials.parquet":
            raise OSError(28, "No space left on device", str(path))
        return open_regular(path, links)

    monkeypatch.setattr(packing, "open_regular", full)
    code, out, err = called(capfd, "crate", made, "crate")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert sorted(each.name for each in Path().iterdir()) == ["office.map", "out"]


def test_a_description_that_nobody_could_read_is_not_written(made, monkeypatch, capfd):
    monkeypatch.setattr(packing, "MOST_METADATA", 1000)
    code, _, err = called(capfd, "crate", made, "crate")
    assert code == 2
    assert "a crate of fewer runs" in err
    assert not Path("crate").exists()


FOLDERS = {
    "map.path=/home/me/office.map": "map.path=office.map",
    "gapath '--config-dir=/home/me/conf' a=b": "gapath '--config-dir=conf' a=b",
    "[/a/b.map,/c/d.map]": "[b.map,d.map]",
    "/alone": "alone",
    "steps / shortest, a/b, ../c/d, ~/e, https://example.org/a/b": None,
}


@pytest.mark.parametrize("text, plain", FOLDERS.items())
def test_folders_are_left_out_of_absolute_paths_alone(text, plain):
    assert without_folders(text) == (text if plain is None else plain)
    assert without_folders({"a": [text, 1]}) == {"a": [without_folders(text), 1]}
