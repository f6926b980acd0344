"""Crates of strangers: what was changed, is missing, lies elsewhere or is too much is one line."""

import json
import os
import shutil
from pathlib import Path

import pytest
from runs_for_crates import called, make_runs

from gapath.crates import reading

DESCRIPTION = Path("crate/ro-crate-metadata.json")


@pytest.fixture
def crate(gapath, capfd):
    made = make_runs(gapath)
    assert called(capfd, "crate", made, "crate")[0] == 0
    return Path("crate")


def changed(change):
    """Have the description say something else."""

    def do(crate):
        content = json.loads(DESCRIPTION.read_bytes())
        graph = {entity["@id"]: entity for entity in content["@graph"]}
        change(graph)
        content["@graph"] = list(graph.values())
        DESCRIPTION.write_text(json.dumps(content))

    return do


def named(place):
    """Have the first file called something else, which lies there, with the right hash."""

    def change(graph):
        name, entity = next((n, e) for n, e in graph.items() if e["@type"] == "File")
        del graph[name]
        graph[place] = entity | {"@id": place}

    return changed(change)


def log_of(crate):
    return sorted(crate.glob("office/*/run.mcap"))[0]


def flipped(crate):
    data = bytearray(log_of(crate).read_bytes())
    data[len(data) // 2] ^= 1
    log_of(crate).write_bytes(data)


def linked(crate):
    log = log_of(crate)
    shutil.move(log, "kept")
    log.symlink_to(Path("kept").resolve())


def folder_linked(crate):
    shutil.move(crate / "office", "kept")
    (crate / "office").symlink_to(Path("kept").resolve())


def piped(crate):
    log = log_of(crate)
    log.unlink()
    os.mkfifo(log)


def described_by_a_link(crate):
    shutil.move(DESCRIPTION, "kept")
    DESCRIPTION.symlink_to(Path("kept").resolve())


def without_hash(graph):
    for entity in graph.values():
        entity.pop("sha256", None)


def two_logs(graph):
    action = next(e for e in graph.values() if e["@type"] == "CreateAction")
    graph["a/run.mcap"] = {"@id": "a/run.mcap"}
    action["result"].append({"@id": "a/run.mcap"})


def a_log_that_is_no_file(graph):
    for entity in graph.values():
        if entity["@id"].endswith("run.mcap"):
            entity["@type"] = "Thing"


def without_profile(graph):
    del graph["./"]["conformsTo"]


def without_actions(graph):
    for name in [n for n, e in graph.items() if e["@type"] == "CreateAction"]:
        del graph[name]


def written(data):
    return lambda crate: DESCRIPTION.write_bytes(data)


BAD = {
    "a bit flipped": (flipped, "run.mcap: got SHA-256"),
    "cut short": (lambda crate: log_of(crate).write_bytes(b"x"), "run.mcap: got SHA-256"),
    "a map that was changed": (
        lambda crate: next(crate.glob("inputs/*/office.map")).write_text("x"), "office.map: got"),
    "a file that is missing": (lambda crate: log_of(crate).unlink(), "run.mcap: got no file"),
    "a file that is a link": (linked, "run.mcap: got a link"),
    "a folder that is a link": (folder_linked, "office, no folder"),
    "a pipe": (piped, "run.mcap: got no regular file"),
    "no description": (lambda crate: DESCRIPTION.unlink(), "got no ro-crate-metadata.json in it"),
    "a description that is a link": (described_by_a_link, "ro-crate-metadata.json: got a link"),
    "a file above": (named("../office.map"), "a file: got ../office.map"),
    "a file above, hidden": (named("%2e%2e/office.map"), "a file: got %2e%2e/office.map"),
    "a file above, within": (named("office/../../office.map"), "a file: got office/../../off"),
    "an absolute path": (named("/etc/hostname"), "a file: got /etc/hostname"),
    "a name of nothing": (named("office/"), "a file: got office/"),
    "a name with a null": (named("a%00b"), "a file: got a%00b"),
    "a very long name": (named("a" * 300), "File name too long"),
    "an anchor": (named("#here"), "#here: got no file"),
    "no hash": (changed(without_hash), "sha256: got None"),
    "two logs": (changed(two_logs), "got 2 logs"),
    "a log that is no file": (changed(a_log_that_is_no_file), "a log that the crate has"),
    "no profile": (changed(without_profile), "conformsTo: got []"),
    "no runs": (changed(without_actions), "got no CreateAction"),
    "no JSON": (written(b"{"), "readable JSON"),
    "no text": (written(b"\xff\xfe"), "readable JSON"),
    "a list": (written(b"[]"), "a JSON object"),
    "no graph": (written(b"{}"), "@graph: got NoneType"),
    "a graph of numbers": (written(b'{"@graph": [1]}'), "entities with an @id"),
    "two of one name": (
        written(b'{"@graph": [{"@id": "a"}, {"@id": "a"}]}'), "each entity once"),
    "depth": (written(b'{"@graph": ' + b"[" * 10**6), "RecursionError"),
    "a huge number": (written(b'{"@graph": ' + b"9" * 10**6 + b"}"), "ValueError"),
}  # fmt: skip


@pytest.mark.parametrize("harm, told", BAD.values(), ids=BAD)
def test_what_is_wrong_with_a_crate_is_one_line(crate, capfd, harm, told):
    harm(crate)
    code, out, err = called(capfd, "repeat", crate)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert told in err


def test_a_large_description_is_not_read(crate, capfd):
    with DESCRIPTION.open("ab") as file:
        file.truncate(reading.MOST_METADATA + 1)
    code, out, err = called(capfd, "repeat", crate)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"at most {reading.MOST_METADATA}" in err


@pytest.mark.parametrize("place", ["nowhere", "office.map"])
def test_what_is_no_folder_is_one_line(crate, capfd, place):
    code, out, err = called(capfd, "repeat", place)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "no such folder" in err


def test_files_of_the_web_are_left_alone(crate, capfd):
    changed(
        lambda graph: graph.update(
            {"https://example.org/a": {"@id": "https://example.org/a", "@type": "File"}}
        )
    )(crate)
    assert called(capfd, "repeat", crate)[0] == 0


def test_a_crate_was_moved_and_cannot_be_written(crate, capfd):
    shutil.move(crate, "elsewhere")
    places = [Path("elsewhere"), *Path("elsewhere").rglob("*")]
    before = {each: each.is_dir() or each.read_bytes() for each in places}
    for each in places:
        each.chmod(0o555 if each.is_dir() else 0o444)
    shutil.rmtree("out")
    Path("office.map").unlink()
    code, out, err = called(capfd, "repeat", "elsewhere")
    for each in places:
        if each.is_dir():
            each.chmod(0o755)
    assert (code, err) == (0, "")
    now = [Path("elsewhere"), *Path("elsewhere").rglob("*")]  # who is root could write
    assert {each: each.is_dir() or each.read_bytes() for each in now} == before
    assert out.splitlines()[-1] == "elsewhere: reproduced; of 2 runs 2 reproduced"
