"""A page of the report: sections and the files that belong to them."""

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader

from gapath.pipelines.page.section import Section

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class Part:
    """A section as the page shows it: with the commands that made its numbers.

    Parameters
    ----------
    anchor : str
        The name of the section's place on the page.
    section : Section
        Its content.
    commands : list of str
        What to type to make them.
    """

    anchor: str
    section: Section
    commands: list[str]


def render(template: str, **content: Any) -> str:
    """Render a page: one file that asks nothing of a network.

    Parameters
    ----------
    template : str
        A file of this folder.
    content
        What it shows.

    Returns
    -------
    str
        HTML.
    """
    environment = Environment(
        loader=FileSystemLoader(_HERE),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["base64"] = lambda data: base64.b64encode(data).decode()
    css = (_HERE / "report.css").read_text(encoding="utf-8")
    return environment.get_template(template).render(css=css, **content)


def files_of(section: Section) -> Iterator[tuple[str, bytes]]:
    """Give the name and content of each file of a section."""
    for table in section.tables:
        yield f"{table.name}.csv", table.csv().encode()
        yield f"{table.name}.md", table.markdown().encode()
        yield f"{table.name}.tex", table.latex().encode()
    for figure in section.figures:
        yield f"{figure.name}.svg", figure.svg
        yield f"{figure.name}.png", figure.png
