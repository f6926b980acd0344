"""Questions in SQL, asked of tables in memory or of run folders: nothing else can be read.

The engine is DuckDB. A setting's name has dots, which SQL takes for something else: in a question
it is written as it is, and quoted here.
"""

import re
from collections.abc import Collection, Sequence
from typing import Any

from gapath.errors import InputError, did_you_mean

_DOTTED = re.compile(r"[^\W\d]\w*(?:\.\w+)+")
_UNKNOWN = re.compile(r'(?:column|table) "([^"]+)" not found')


def near(name: str, columns: Collection[str]) -> str:
    """Ask for the nearest of some columns, also by the last part of their names.

    Parameters
    ----------
    name : str
        What was asked for.
    columns : collection of str
        What there is.

    Returns
    -------
    str
        Empty, or the end of a sentence.
    """
    ends = {column.rpartition(".")[2].lower(): column for column in reversed(list(columns))}
    return did_you_mean(name, ends | {column.lower(): column for column in columns})


def quoted(text: str, columns: Collection[str], where: str) -> str:
    """Quote the names of columns that have dots, so that SQL takes each for one name.

    Parameters
    ----------
    text : str
        SQL. What stands in quotes or in a comment there is left alone.
    columns : collection of str
        The columns that there are.
    where : str
        Where the text stands, for messages.

    Returns
    -------
    str
        The same, with ``"planner.population"`` for ``planner.population``, also behind the name
        of a table: ``runs."planner.population"``.

    Raises
    ------
    InputError
        If a name with dots is no column: gives the nearest.
    """
    import duckdb

    known = {column.lower(): column for column in columns}
    groups = {column.partition(".")[0] for column in known if "." in column}
    data, parts, done = text.encode(), [], 0
    for place, _ in duckdb.tokenize(text):  # words, quoted texts, comments; places are in bytes
        found = _DOTTED.match(data[place:].decode()) if place >= done else None
        if found is None:
            continue
        word = found.group()
        group, _, rest = word.partition(".")
        if word.lower() in known:
            name = f'"{known[word.lower()]}"'
        elif group.lower() in groups:
            right = f"a column in place of {word}{near(word, columns)}"
            raise InputError(where, " ".join(text.split()), right)
        else:
            name = f'{group}."{known[rest.lower()]}"' if rest.lower() in known else word
        parts += [data[done:place], name.encode()]
        done = place + len(word.encode())
    return b"".join([*parts, data[done:]]).decode()


def refusal(error: Exception, text: str, columns: Collection[str], where: str) -> InputError:
    """Say in one line what is wrong with a question.

    Parameters
    ----------
    error : Exception
        What DuckDB raised.
    text : str
        The question, as it was given.
    columns : collection of str
        The columns that there are.
    where : str
        Where the text stands.

    Returns
    -------
    InputError
        To raise; names an unknown column and the nearest.
    """
    message, text = str(error).partition("\n")[0], " ".join(text.split())
    unknown = _UNKNOWN.search(message)
    if unknown:
        name = unknown.group(1)
        dotted = re.search(rf"\b{re.escape(name)}(\.\w+)+", text)  # SQL took it for a table's
        name = dotted.group() if dotted else name
        hint = near(name, columns)
        if f'"{name}"' in text or not (hint or dotted):
            hint = f"{hint}; text stands in single quotes: '{name}'"
        return InputError(where, text, f"a column in place of {name}{hint}")
    return InputError(where, text, f"SQL that can be answered ({message})")


def connect(files: Sequence[str] = ()) -> Any:
    """Start DuckDB in memory, where no question can reach other files or the network.

    Parameters
    ----------
    files : sequence of str
        The files that may be read.

    Returns
    -------
    duckdb.DuckDBPyConnection
        A connection of its own.
    """
    import duckdb

    connection = duckdb.connect(":memory:")
    connection.execute(f"set allowed_paths = [{', '.join(map(literal, files))}]")
    connection.execute("set enable_external_access = false")
    connection.execute("set lock_configuration = true")
    return connection


def literal(text: str) -> str:
    """Write text as SQL does."""
    return "'" + text.replace("'", "''") + "'"
