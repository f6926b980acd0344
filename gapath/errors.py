"""Bad input: the one exception that says so, and the checks that raise it."""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from typing import Any

MOST_MEMORY = 1 << 30
"""Bytes that a planner's settings may ask for."""

FAULTS = (Exception, SystemExit)
"""What is a component's fault where it raises it: it must not end the process by itself, either."""


_UNSEEN = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufeff]"
)
"""Control characters, ends of lines, marks that turn the direction of writing, halves of pairs."""

_ENDS = re.compile(r"\s*\n\s*")

_MOST_SHOWN = 400
"""Characters of a name or a value that a message shows."""


def printable(text: object) -> str:
    r"""Write text of others such that it is seen as it is, and does nothing else.

    A terminal obeys what stands between control characters, and marks of direction let text read
    as another.

    Parameters
    ----------
    text : object
        A name from a file, a path; its ``str``.

    Returns
    -------
    str
        One line: control characters as ``\x1b``, ends of lines, marks of direction and lone
        surrogates, which cannot be written at all, as ``\u202e``.
    """
    return _UNSEEN.sub(_written, str(text))


def _written(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"


def few(items: Sequence[object]) -> str:
    """List things of which there may be many: the first nine, and how many more there are."""
    rest = len(items) - _LISTED
    return ", ".join(map(str, items[:_LISTED])) + (f" and {rest} more" if rest > 0 else "")


_LISTED = 9


class InputError(ValueError):
    """A file, a field or a value that a user gave cannot be used.

    The message names the file or the field, the value, and what would be right, in one `printable`
    line. Commands print it without a traceback and exit with code 2.

    Parameters
    ----------
    where : str
        The file or the configuration field, e.g. ``"planner.population"``.
    value : object
        What was found there.
    expected : str
        What would be right.
    """

    def __init__(self, where: object, value: object, expected: str) -> None:
        self.where, self.value, self.expected = str(where), value, expected
        found = _shown(value) or repr("")
        right = printable(_ENDS.sub(" ", expected))
        super().__init__(f"{_shown(where)}: got {found}, expected {right}")

    def within(self, path: object) -> "InputError":
        """Give the same error of what was found in a file, whose name it says once."""
        named = self.where == str(path) or self.where.startswith(f"{path}: ")
        where = self.where if named else f"{path}: {self.where}"
        return InputError(where, self.value, self.expected)

    def __reduce__(self) -> tuple[type["InputError"], tuple[Any, ...]]:
        return type(self), (self.where, self.value, self.expected)


class Missing(InputError):
    """Packages that an extra of gapath brings are not installed.

    The message says what needs them, and how to install them.

    Parameters
    ----------
    what : str
        What needs them, for example ``"recorder=rerun"``.
    extra : str
        The extra, for example ``"view"``.
    packages : sequence of str
        Those that are missing.
    """

    def __init__(self, what: str, extra: str, packages: Sequence[str]) -> None:
        named = ", ".join(packages)
        super().__init__(what, f"no {named}", f"pip install 'gapath[{extra}]'")
        self.args = (f"{_shown(what)} needs {named}: {self.expected}",)
        self._given = what, extra, packages

    def __reduce__(self) -> tuple[type["InputError"], tuple[Any, ...]]:
        return type(self), self._given


def _shown(value: object) -> str:
    text = _ENDS.sub(" ", str(value))
    rest = len(text) - _MOST_SHOWN
    return printable(text if rest <= 0 else f"{text[:_MOST_SHOWN]}... ({rest} characters more)")


def require(condition: bool, where: object, value: object, expected: str) -> None:
    """Raise `InputError` unless the condition holds.

    Parameters
    ----------
    condition : bool
        What must be true.
    where : object
        The file or the configuration field.
    value : object
        What was found there.
    expected : str
        What would be right.

    Raises
    ------
    InputError
        If the condition is false.
    """
    if not condition:
        raise InputError(where, value, expected)


def require_extra(what: str, extra: str, *packages: str) -> None:
    """Raise `Missing` unless what an extra of gapath brings is installed.

    Parameters
    ----------
    what : str
        What needs it.
    extra : str
        The extra.
    *packages : str
        Those of its packages that are needed; all of them where none is named.

    Raises
    ------
    Missing
        If one is not installed.
    """
    missing = [name for name in packages or packages_of(extra) if not _installed(name)]
    if missing:
        raise Missing(what, extra, missing)


@lru_cache
def packages_of(extra: str) -> tuple[str, ...]:
    """Give the packages that an extra of gapath brings, as ``pyproject.toml`` names them."""
    needed = metadata.requires("gapath") or []
    named = re.compile(rf"([\w.-]+).*; *extra == ['\"]{extra}['\"]")
    return tuple(found[1] for each in needed if (found := named.match(each)))


@lru_cache  # a look-up reads the whole description of a package
def _installed(package: str) -> bool:
    try:
        metadata.version(package)
    except metadata.PackageNotFoundError:
        return False
    return True


def require_all(home: object, where: str, needed: Mapping[str, Any]) -> None:
    """Raise `InputError` if a module or class of an installed package lacks something.

    Parameters
    ----------
    home : module or type
        What must have it.
    where : str
        Its name.
    needed : mapping of str to type
        Each name, and what stands there: anything that `isinstance` takes.

    Raises
    ------
    InputError
        If a name is missing or something else stands there.
    """
    for name, kind in needed.items():
        if name in getattr(home, "__dataclass_fields__", ()):  # its objects have it
            continue
        require(hasattr(home, name), where, f"no {name}", f"one with {', '.join(needed)}")
        value, right = getattr(home, name), getattr(kind, "__name__", str(kind))
        require(isinstance(value, kind), f"{where}.{name}", value, right)


def one_of(given: object, names: Iterable[str]) -> str:
    """Say what would be right in place of an unknown name: the names, if few, and the nearest.

    Parameters
    ----------
    given : object
        What was given.
    names : iterable of str
        What there is.

    Returns
    -------
    str
        For an `InputError`, for example "one of 18 names; did you mean ga3?".
    """
    names = list(names)
    few = len(names) <= _FEW
    listed = ", ".join(names) if few else f"{len(names)} names, see gapath help"
    return f"one of {listed}{did_you_mean(given, {name: name for name in names})}"


_FEW = 24


def did_you_mean(given: object, names: Mapping[str, str]) -> str:
    """Ask for the nearest of some names; nothing if none is near.

    Parameters
    ----------
    given : object
        What was given.
    names : mapping of str to str
        Each name, and how it would be written there.

    Returns
    -------
    str
        Empty, or the end of a sentence.
    """
    from difflib import get_close_matches  # only where something is wrong

    near = get_close_matches(str(given).lower(), names, n=1)
    return f"; did you mean {names[near[0]]}?" if near else ""


class Checks:
    """Checks the settings of a component, one call a setting.

    Parameters
    ----------
    settings : object
        Has the settings as attributes.
    group : str
        The configuration group that they belong to, e.g. "planner".
    """

    def __init__(self, settings: object, group: str) -> None:
        self.settings, self.group = settings, group

    def __call__(self, name: str, good: bool, expected: str) -> None:
        """Raise `InputError` unless a setting is good.

        Parameters
        ----------
        name : str
            The setting.
        good : bool
            What must be true.
        expected : str
            What would be right.

        Raises
        ------
        InputError
            If it is not good; names the setting and its value.
        """
        require(good, f"{self.group}.{name}", getattr(self.settings, name), expected)

    def whole(self, name: str, least: int, most: int) -> None:
        """Raise `InputError` unless a setting is within a range, both ends included.

        Parameters
        ----------
        name : str
            The setting, an integer.
        least, most : int
            The ends of its range.

        Raises
        ------
        InputError
            If it is outside; names the setting, its value and both ends.
        """
        good = least <= getattr(self.settings, name) <= most
        self(name, good, f"an integer from {least} to {most}")


def require_memory(needed: int, where: str, value: str) -> None:
    """Raise `InputError` if settings need more than `MOST_MEMORY`.

    Parameters
    ----------
    needed : int
        Bytes.
    where : str
        The configuration fields.
    value : str
        What was found there.

    Raises
    ------
    InputError
        If it is too much; says how much.
    """
    expected = f"settings that need at most {MOST_MEMORY >> 30} GiB"
    require(needed <= MOST_MEMORY, where, f"{value}: {needed / 2**30:.1f} GiB", expected)
