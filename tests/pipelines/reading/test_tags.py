"""What people say of runs: any text, in a file of its own, whole or not at all."""

import json
import multiprocessing
import os
from dataclasses import replace

import pytest

from gapath.errors import InputError
from gapath.pipelines.reading import tags
from gapath.pipelines.reading.tags import LONGEST_NOTE, LONGEST_TAG, MOST_TAGS, Said, read_said, say

TEXTS = (
    "base", "two words", "<b>&amp;</b>", "a\nb\r\nc", "\x1b[31m\x07", "\u202egnp", "\ud800", "é",
    "'; drop table runs", "=1+1", "t" * LONGEST_TAG,
)  # fmt: skip


@pytest.fixture
def run(tmp_path):
    place = tmp_path / "outputs" / "mine" / "0123456789abcdef"
    place.mkdir(parents=True)
    (place / "manifest.json").write_text("{}")
    return place


@pytest.mark.parametrize("text", TEXTS)
def test_any_text_is_kept_as_it_is(run, text):
    say(run, lambda said: Said({text: "now"}, text))
    assert read_said(run.parent) == {run.name: Said({text: "now"}, text)}
    say(run, lambda said: Said())
    assert read_said(run.parent) == {}
    assert [path.name for path in run.iterdir()] == ["manifest.json"]


@pytest.mark.parametrize(
    "said",
    [
        Said({"": ""}), Said({" a": ""}), Said({"a\n": ""}), Said({"t" * (LONGEST_TAG + 1): ""}),
        Said({str(i): "" for i in range(MOST_TAGS + 1)}), Said({}, "n" * (LONGEST_NOTE + 1)),
    ],
)  # fmt: skip
def test_too_much_is_refused_and_nothing_changes(run, said):
    say(run, lambda _: Said({"a": "now"}))
    before = (run.parent / "tags.json").read_bytes()
    with pytest.raises(InputError, match=r"tags\.json"):
        say(run, lambda _: said)
    assert (run.parent / "tags.json").read_bytes() == before


SPOILED = {
    "no JSON": lambda file: file.write_text("{"),
    "a list": lambda file: file.write_text("[]"),
    "other types": lambda file: file.write_text('{"a": {"tags": {"a": 1}, "note": ""}}'),
    "a tag too long": lambda file: file.write_text(
        json.dumps({"a": {"tags": {"a" * 1000: ""}, "note": ""}})
    ),
    "a folder": lambda file: file.mkdir(),
    "a pipe": os.mkfifo,
    "a link": lambda file: file.symlink_to("/etc/hostname"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_a_file_that_cannot_be_used_is_named_and_stays(run, name):
    file = run.parent / "tags.json"
    SPOILED[name](file)
    before = os.lstat(file)
    with pytest.raises(InputError, match=r"mine/tags\.json"):
        read_said(run.parent)
    with pytest.raises(InputError, match=r"mine/tags\.json"):
        say(run, lambda said: Said({"a": ""}))
    assert os.lstat(file) == before


def test_a_disk_that_is_full_loses_nothing(run, monkeypatch):
    say(run, lambda said: Said({"a": "now"}))

    def full(file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(InputError, match="No space left"):
        say(run, lambda said: Said({"b": "now"}))
    assert read_said(run.parent) == {run.name: Said({"a": "now"})}


def _add(place, first):
    run = type(place)(place)
    for i in range(first, first + 5):
        say(run, lambda said, i=i: replace(said, tags={**said.tags, str(i): ""}))


def test_nobody_overwrites_what_another_says(run):
    processes = multiprocessing.get_context("fork")
    started = [processes.Process(target=_add, args=(run, 5 * i)) for i in range(4)]
    for each in started:
        each.start()
    for each in started:
        each.join(60)
    assert set(read_said(run.parent)[run.name].tags) == {str(i) for i in range(20)}


def test_the_lock_is_needed(run, monkeypatch):
    """Of two who change a file at once without a lock one is lost: so the test above can fail."""
    monkeypatch.setattr(tags.fcntl, "flock", lambda *given: None)

    def meanwhile(said):
        say(run, lambda said: Said({"other": ""}))
        return Said({"mine": ""})

    say(run, meanwhile)
    assert set(read_said(run.parent)[run.name].tags) == {"mine"}
