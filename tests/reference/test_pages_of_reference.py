"""The pages that are made from the sources are as the sources are today."""

from pathlib import Path

import pytest

from gapath.discovery import kinds
from gapath.recorders.mcap.format import TOPICS
from gapath.reference.columns import COLUMNS
from gapath.reference.pages import PAGES, column, columns_page, settings_page
from gapath.reference.settings import CHOSEN, presets, root
from gapath.task import columns, find_task, metrics

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_what_make_reference_writes(name):
    assert (DOCS / name).read_text("utf-8") == PAGES[name](), "make reference writes it anew"


def test_every_setting_and_every_name_is_on_the_page():
    page = settings_page()
    for setting in root().settings:
        assert f"| `{setting.name}` |" in page
    for group in CHOSEN:
        for each in presets(group):
            place = f"{group}-{each.kind}"
            kind = f"[`{each.kind}`](#{place})" if each.settings else f"`{each.kind}`"
            assert f"| `{group}={each.name}` | {kind} |" in page
            assert (f"### {place.replace('-', ' ')}" in page) == bool(each.settings)
            assert all(f"| `{setting.name}` |" in page for setting in each.settings)


def test_every_column_has_a_meaning():
    names = {name for task in kinds("task") for name in columns(find_task(task).row)}
    assert names == {*COLUMNS, *metrics()}
    for name in names:
        assert column(name)[1], name
    page = columns_page()
    assert all(f"\n### {topic}\n" in page for topic in TOPICS)
    assert "| `chromosomes` | int32[] | the best individual |" in page


def test_tables_have_as_many_cells_everywhere():
    for page in PAGES.values():
        for part in page().split("\n\n"):
            lines = part.splitlines()
            if lines[0].startswith("|"):
                counts = {line.replace("\\\\|", "").count("|") for line in lines}
                assert len(counts) == 1, lines[0]
