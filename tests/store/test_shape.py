"""What files of JSON say has the types that are asked for, and what many repeat is kept once."""

import json
from collections.abc import Mapping
from dataclasses import dataclass

import pytest

from gapath.errors import InputError
from gapath.store.shape import shaped


@dataclass(frozen=True)
class Lock:
    packages: Mapping[str, str]
    spent: Mapping[str, str | int | float | bool]


def read(packages, spent):
    return shaped(Lock, json.loads(json.dumps({"packages": packages, "spent": spent})), "file")


def test_equal_texts_of_many_files_are_in_memory_once():
    packages = {f"package{i}": str(i) for i in range(5)}
    first, second = read(packages, {}), read(packages, {})
    assert first.packages == packages
    assert first.packages is second.packages
    assert read({**packages, "package0": "1"}, {}).packages != packages


@pytest.mark.parametrize("value", [1, 1.0, True, "1"])
def test_values_keep_their_types(value):
    for before in (1, 1.0, True, "1"):
        read({}, {"n": before})
    found = read({}, {"n": value}).spent["n"]
    assert type(found) is type(value)
    assert found == value


@pytest.mark.parametrize(
    ("packages", "spent", "says"),
    [
        ({"a": 1}, {}, "file, packages, a"),
        ({}, {"a": None}, "file, spent, a"),
        (3, {}, "a mapping"),
    ],
)
def test_other_types_are_refused(packages, spent, says):
    with pytest.raises(InputError, match=says):
        read(packages, spent)
