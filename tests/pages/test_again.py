"""Five minutes, how-to pages and questions: each command and each example does what is shown.

What they show is shown anew by --update-golden.
"""

import re
import shutil

import pytest
from matplotlib import pyplot
from pages import again

DOCS = again.ROOT / "docs"
NAMES = ("README.md", "start.md", "questions.md")
PAGES = {
    page.relative_to(DOCS).with_suffix("").as_posix(): page
    for page in (*map(DOCS.joinpath, NAMES), *sorted(DOCS.glob("how-to/*.md")))
}
ELSEWHERE = {"how-to/my-planner"}
"""tests/test_plugin.py does it, where that planner is installed."""


@pytest.mark.parametrize("name", [name for name in PAGES if name not in ELSEWHERE])
def test_a_page_shows_what_its_commands_print(name, tmp_path, update_golden):
    folder = tmp_path / "examples"
    shutil.copytree(again.ROOT / "examples", folder)
    text = PAGES[name].read_text("utf-8")
    page = again.Again(text, folder)
    found = list(page.outputs())
    pyplot.close("all")
    assert page.failed == {}
    if update_golden:
        for shown, now in found:
            if not again.same(now, shown):
                text = text.replace(f"\n{shown}```", f"\n{now}```")
        PAGES[name].write_text(text, "utf-8")
        return
    for shown, now in found:
        assert again.same(now, shown), now


def test_what_is_left_out_stands_in_a_page():
    texts = [page.read_text("utf-8").splitlines() for page in PAGES.values()]
    assert set(again.LEFT_OUT) <= {line for lines in texts for line in lines}


def test_an_output_that_is_another_is_noticed():
    assert again.same("found 3 in 1.2 ms, 3fa2b1c0", "found 3 in 40 ms, 00000000")
    assert not again.same("found 3 in 1.2 ms", "found 2 in 1.2 ms")
    assert again.same("a\nb\nc\nd\n", "a\n...\nd\n") and again.same("a\nd\n", "a\n...\nd\n")
    assert not again.same("a\nb\nc\n", "a\n...\nd\n")


def test_a_command_that_fails_is_noticed(tmp_path):
    page = again.Again("```\ngapath-log info nowhere.mcap\n```\n", tmp_path)
    assert list(page.outputs()) == []
    assert page.failed == {"gapath-log info nowhere.mcap": 2}


def test_there_are_ten_questions_at_least():
    titles = re.findall(r"^## .*\?$", PAGES["questions"].read_text("utf-8"), re.MULTILINE)
    assert len(titles) >= 10
