"""The commands that tag runs, and what the lists and pages show of it."""

import json
import re
from dataclasses import replace

import pytest

from gapath.pipelines.report import cli
from gapath.pipelines.report.report import make_report
from gapath.store import durable
from gapath.store.records import Manifest

from ..conftest import sign

MARKUP = "<script>alert(1)</script> \x1b[31m & more"


@pytest.fixture
def outputs(tmp_path, make_run):
    for key, name in (("abcd000000000000", "kg18_test1"), ("abce000000000000", "kg18_test3")):
        run = make_run(tmp_path, "mine", name, "ga1", key=key, log=False)
        known = Manifest.read(run)
        origin = {"directory": {"commit": key[:4] * 10, "clean": key < "abce"}, "packages": {}}
        sign(run, replace(known, provenance=origin))
    return tmp_path


@pytest.fixture
def report(outputs, capsys):
    def call(*words):
        code = cli.main([*map(str, words)])
        return code, *capsys.readouterr()

    return call


def listed(report, outputs, *words):
    code, out, _ = report("runs", outputs, "--json", *words)
    assert code == 0
    return json.loads(out)


def test_a_run_may_be_named_by_its_folder_a_file_or_its_experiment(report, outputs, monkeypatch):
    monkeypatch.chdir(outputs / "mine" / "abcd000000000000")
    folder = outputs / "mine" / "abcd000000000000"
    for given in (folder, folder / "manifest.json", "manifest.json", ".", "mine/abcd"):
        code, text, _ = report("tag", given, "base", "--outputs", outputs)
        assert (code, text.split(": ")[1]) == (0, "tag base\n")


def test_a_run_is_tagged_and_noted_and_the_list_says_so(report, outputs):
    where = ("--outputs", outputs)
    assert report("tag", "abcd", "base", MARKUP, *where) == (
        0, "mine/abcd000000000000: tag base; tag <script>alert(1)</script> \\x1b[31m & more\n", "",
    )  # fmt: skip
    assert report("note", "abcd", "two\nlines", *where)[0] == 0
    (row,) = listed(report, outputs, "--where", "tags like '%base%'")
    assert row["key"] == "abcd000000000000" and row["note"] == "two\\x0alines"
    text = report("runs", outputs)[1]
    assert "base, <script>" in text and "\x1b" not in text
    assert report("tag", "abcd", "base", "--remove", *where)[0] == 0
    assert report("note", "abcd", "", *where)[1].endswith(": tag <script>alert(1)</script> "
                                                          "\\x1b[31m & more\n")  # fmt: skip
    assert report("tag", "abcd", MARKUP, "--remove", *where)[1].endswith("no tag, no note\n")
    assert "tags" not in report("runs", outputs)[1].splitlines()[0]


def test_commits_are_listed_with_a_mark_where_files_were_changed(report, outputs):
    rows = listed(report, outputs)
    assert [row["commit"] for row in rows] == ["abcd" * 10, "abce" * 10 + "-dirty"]
    text = report("runs", outputs)[1]
    assert re.search(r"\babcdabcd\b", text) and "abceabce-dirty" in text


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("tag", "ff", "a"), "no run ff..."),
        (("tag", "abc", "a"), "key: got abc, the beginning of mine/abcd000000000000, "
         "mine/abce000000000000, expected a longer one"),
        (("tag", "", "a"), "key: got '', expected the beginning of a run's key"),
        (("tag", "*", "a"), r"no run *..."),
        (("tag", "abcd", " "), "tags.json: got ' ', expected a tag"),
        (("tag", "abcd", "a", "--remove"), "TEXT: got a, expected none: it has no tag"),
        (("tag", "abcd", "--remove"), "--remove: got no tag, expected which tags"),
        (("note", "abcd", "n" * 3000), "a note of 3000 characters"),
    ],
)  # fmt: skip
def test_what_cannot_be_said_is_one_line(report, outputs, words, error):
    code, out, said = report(*words, "--outputs", outputs)
    assert (code, out, said.count("\n")) == (2, "", 1)
    assert said.startswith("gapath-report: ") and error in said
    assert not (outputs / "mine" / "tags.json").exists()


def test_a_folder_that_is_none_is_one_line(report, outputs):
    code, _, said = report("tag", "abcd", "a", "--outputs", outputs / "none")
    assert (code, said.count("\n")) == (2, 1) and "no such folder" in said


def test_a_folder_that_cannot_be_written_is_one_line(report, outputs, monkeypatch):
    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(durable, "new_file", refuse)  # root may write everywhere
    code, _, said = report("tag", "abcd", "a", "--outputs", outputs)
    assert (code, said.count("\n")) == (2, 1) and "Permission denied" in said


def test_the_pages_show_it_escaped_and_where_runs_come_from(report, outputs, undrawn):
    report("tag", "abcd", MARKUP, "--outputs", outputs)
    report("note", "abcd", "<i>note</i>", "--outputs", outputs)
    make_report(outputs, outputs / "report")
    run = (outputs / "report" / "runs" / "abcd000000000000.html").read_text()
    every = (outputs / "report" / "runs" / "index.html").read_text()
    shown = "&lt;script&gt;alert(1)&lt;/script&gt; \\x1b[31m &amp; more"
    assert shown in run and shown in every and "&lt;i&gt;note&lt;/i&gt;" in run
    for page in (run, every):
        assert "<script>alert" not in page and "\x1b" not in page
    assert f'<tr><th scope="row">directory, commit</th><td>{"abcd" * 10}</td></tr>' in run
    assert '<th scope="row">packages</th><td>0, in manifest.json</td>' in run


def test_tags_that_cannot_be_read_keep_no_run_from_the_list_and_the_report(
    report, outputs, undrawn
):
    (outputs / "mine" / "tags.json").write_text("{")
    code, out, said = report("runs", outputs)
    assert code == 0 and "abcd" in out and said.count("mine/tags.json: got") == 1
    _, skipped = make_report(outputs, outputs / "report")
    assert [run for run, _ in skipped] == ["mine/tags.json"]
