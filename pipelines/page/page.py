"""A page of the report: sections and the files that belong to them."""

import base64
import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, Template
from markupsafe import Markup

from gapath.errors import printable
from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import picture_of
from gapath.pipelines.page.rows import rows_of, width_of
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
    group : str
        Under which heading the menu has it.
    """

    anchor: str
    section: Section
    commands: list[str]
    group: str = ""


def style() -> str:
    """Give the style sheet of all pages."""
    return (_HERE / "templates" / "page.css").read_text(encoding="utf-8")


def script() -> str:
    """Give the script of all pages, and the library that it needs."""
    library = (_HERE / "vendor" / "dataTables.min.js").read_text(encoding="utf-8")
    own = (_HERE / "templates" / "page.js").read_text(encoding="utf-8")
    return f"\n{library}\n{own}"


def _seen(value: Any) -> Any:
    """Let text of others be seen as it is: HTML escapes its own marks, not what turns writing."""
    if isinstance(value, Markup) or not isinstance(value, str) or value.isprintable():
        return value
    return "\n".join(map(printable, value.split("\n")))


@cache
def template(name: str) -> Template:
    """Compile a template of this folder."""
    environment = Environment(
        loader=FileSystemLoader(_HERE / "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        auto_reload=False,
        finalize=_seen,
    )
    environment.globals.update(
        number=number, rows_of=rows_of, width_of=width_of, picture_of=picture_of
    )
    return environment.get_template(name)


def render(
    name: str, page_of: Callable[[tuple[str, ...]], str] = lambda keys: "", **content: Any
) -> str:
    """Render a page: one file that asks nothing of a network, which its policy forbids, too.

    Parameters
    ----------
    name : str
        A template of this folder.
    page_of : callable
        Gives the address of the page of runs, by their keys.
    content
        What it shows.

    Returns
    -------
    str
        HTML.
    """
    code = script()
    digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
    return template(name).render(
        css=style(), script=code, script_hash=digest, page_of=page_of, **content
    )


def files_of(section: Section) -> Iterator[tuple[str, bytes]]:
    """Give the name and content of each file of a section."""
    for table in section.tables:
        yield f"{table.name}.csv", table.csv().encode()
        yield f"{table.name}.md", table.markdown().encode()
        yield f"{table.name}.tex", table.latex().encode()
    for figure in section.figures:
        yield f"{figure.name}.svg", figure.svg
        yield f"{figure.name}.png", figure.png
