"""What RO-Crate 1.1 and the profile of Process Run Crates ask for.

`tests/reliability/crates/test_validated_crates.py` asks the profile's own validator.
"""

import hashlib
import json
import re
from pathlib import Path

import pytest
from runs_for_crates import called, make_runs

CREDITS = (
    "--author", "Ada Lovelace", "--organization", "Engines", "https://engines.example",
    "--licence", "https://creativecommons.org/licenses/by/4.0/",
)  # fmt: skip

TIME = re.compile(r"\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}(\.\d{3})?\+\d{2}:\d{2}")
MEDIA = re.compile(r"\w*/\w[\w.-]*(\+\w[\w.-]*)?")
ROOT = "./"


@pytest.fixture(params=["bare", "credited"])
def graph(request, gapath, capfd):
    """The entities of a crate of two runs, by name."""
    credit = CREDITS if request.param == "credited" else ()
    assert called(capfd, "crate", make_runs(gapath), "crate", *credit)[0] == 0
    content = json.loads(Path("crate/ro-crate-metadata.json").read_bytes())
    assert content["@context"] == [
        "https://w3id.org/ro/crate/1.1/context",
        "https://w3id.org/ro/terms/workflow-run/context",
    ]
    found = {entity["@id"]: entity for entity in content["@graph"]}
    assert len(found) == len(content["@graph"])
    return found


def listed(value):
    return value if isinstance(value, list) else [value]


def referred(entity, name, graph):
    """The entities that a property names."""
    return [graph[each["@id"]] for each in listed(entity.get(name, []))]


def of_type(graph, name):
    return [entity for entity in graph.values() if name in listed(entity["@type"])]


def test_the_description_describes_the_root(graph):
    own = graph["ro-crate-metadata.json"]
    assert own["@type"] == "CreativeWork"
    assert own["about"] == {"@id": ROOT}
    assert own["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}


def test_the_root_says_what_it_is(graph):
    root = graph[ROOT]
    assert root["@type"] == "Dataset"
    assert root["name"] and root["description"]
    assert TIME.fullmatch(root["datePublished"])
    (licence,), (profile,) = referred(root, "license", graph), referred(root, "conformsTo", graph)
    assert licence["@type"] == profile["@type"] == "CreativeWork"
    assert profile["@id"].startswith("https://w3id.org/ro/wfrun/process/")
    for name in ("author", "publisher"):
        for agent in referred(root, name, graph):
            assert agent["@type"] in ("Person", "Organization")
            assert agent["name"]


def test_every_file_is_a_part_of_the_root_and_is_there(graph):
    files = of_type(graph, "File")
    assert files == referred(graph[ROOT], "hasPart", graph)
    there = {p.relative_to("crate").as_posix() for p in Path("crate").rglob("*") if p.is_file()}
    assert there == {each["@id"] for each in files} | {"ro-crate-metadata.json"}
    for each in files:
        data = (Path("crate") / each["@id"]).read_bytes()
        assert each["sha256"] == hashlib.sha256(data).hexdigest()
        assert each["contentSize"] == str(len(data))
        assert MEDIA.fullmatch(each["encodingFormat"])


def test_every_run_is_an_action_of_gapath(graph):
    actions = of_type(graph, "CreateAction")
    assert actions == referred(graph[ROOT], "mentions", graph)
    assert len(actions) == 2
    for action in actions:
        (tool,) = referred(action, "instrument", graph)
        assert tool["@type"] == "SoftwareApplication"
        assert tool["name"] and tool["softwareVersion"] and "version" not in tool
        assert action["name"] and action["description"]
        assert TIME.fullmatch(action["startTime"]) and TIME.fullmatch(action["endTime"])
        assert action["actionStatus"] == "http://schema.org/CompletedActionStatus"
        assert "error" not in action
        for name in ("object", "result"):
            found = referred(action, name, graph)
            assert found
            assert {each["@type"] for each in found} <= {"File", "PropertyValue", "CreativeWork"}
        environment = referred(action, "environment", graph)
        assert {each["@type"] for each in environment} == {"PropertyValue"}
        for agent in referred(action, "agent", graph):
            assert agent["@type"] in ("Person", "Organization")


def test_no_list_of_one_and_no_null_is_written(graph):
    for entity in graph.values():
        for value in entity.values():
            assert value is not None
            assert not isinstance(value, list) or len(value) > 1


def test_who_is_named_is_named(gapath, capfd):
    assert called(capfd, "crate", make_runs(gapath), "crate", *CREDITS)[0] == 0
    content = json.loads(Path("crate/ro-crate-metadata.json").read_bytes())
    found = {entity["@id"]: entity for entity in content["@graph"]}
    (author,), (place,) = (referred(found[ROOT], n, found) for n in ("author", "publisher"))
    assert author["name"] == "Ada Lovelace"
    assert referred(author, "affiliation", found) == [place]
    assert (place["name"], place["url"]) == ("Engines", "https://engines.example")
    assert found[ROOT]["license"] == {"@id": CREDITS[-1]}
    assert all(
        action["agent"] == {"@id": author["@id"]} for action in of_type(found, "CreateAction")
    )
