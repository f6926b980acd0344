"""docs/questions.md: each command does what it shows, or is shown anew by --update-golden."""

import re
import shlex
from pathlib import Path

from processes import forked

PAGE = Path(__file__).parents[1] / "docs" / "questions.md"

_CHANGES = re.compile(r"\b[0-9a-f]{6,64}\b|\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d\S*)?")
"""Keys and dates: another version of the code has others."""

_EXAMPLE = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def said(command, folder, answers):
    """What a command prints, its errors last; `--json` and tables alike at full width."""
    words = shlex.split(command)
    answers[command], *texts = forked.run(words, folder, COLUMNS="120", NO_COLOR="1", CI="1")
    return "".join(f"{line.rstrip()}\n" for text in texts for line in text.splitlines())


def done_again(block, folder, answers):
    """A block of the page with the output that its commands have now."""
    shown = ""
    for line in block.splitlines():
        if line.startswith("$ "):
            shown += f"{line}\n{said(line[2:], folder, answers)}"
    return shown


def test_every_answer_on_the_page_is_what_its_command_prints(tmp_path, update_golden):
    text, answers = PAGE.read_text("utf-8"), {}
    first, *others = _EXAMPLE.findall(text)
    for line in first.splitlines():  # the sweeps that are asked about: what they print is not shown
        said(line.removeprefix("$ "), tmp_path, answers)
    found = [(block, done_again(block, tmp_path, answers)) for block in others]
    assert {command: code for command, code in answers.items() if code} == {}
    if update_golden:
        for block, new in found:
            text = text.replace(f"```console\n{block}```", f"```console\n{new}```")
        PAGE.write_text(text, "utf-8")
        return
    for block, new in found:
        assert _CHANGES.sub("*", new) == _CHANGES.sub("*", block)


def test_there_are_ten_questions_at_least():
    titles = re.findall(r"^## .*\?$", PAGE.read_text("utf-8"), re.MULTILINE)
    assert len(titles) >= 10
