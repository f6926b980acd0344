"""What a word means, as text for a terminal: a setting, a choice, a group."""

import shutil
import sys
import textwrap
from collections.abc import Iterator
from typing import Any

from gapath.discovery import yaml_names
from gapath.errors import InputError
from gapath.reference.settings import (
    CHOSEN,
    OF_HYDRA,
    Preset,
    Setting,
    about,
    groups_of_tasks,
    preset,
    presets,
    root,
    shown,
)


def width() -> int:
    """Give the columns of the terminal, no more than are read with ease."""
    return min(shutil.get_terminal_size().columns, 120)


def listed(group: str) -> str:
    """List the names of a group, a line each; of a terminal no line is longer than it."""
    names = yaml_names(group)
    wide = max(map(len, names)) + 2
    told = [about(group, name) for name in names]
    if sys.stdout.isatty():
        told = [textwrap.shorten(text, width() - wide, placeholder=" ...") for text in told]
    return "\n".join(f"{name:<{wide}}{text}" for name, text in zip(names, told, strict=True))


def chosen(group: str, name: str) -> str:
    """Tell what a name of a group is, and all of its settings; raises InputError for none."""
    names = yaml_names(group)
    if name not in names:
        raise InputError(group, name, _near(name, names))
    return _of_preset(preset(group, name))


def overview() -> str:
    """Tell which groups and which settings of the root there are."""
    lines = ["what is chosen, GROUP=NAME: gapath help GROUP lists the names"]
    for group in (*CHOSEN, *OF_HYDRA):
        lines.append(f"  {group:<14}{len(yaml_names(group))} names")
    lines += ["", "what is set, SETTING=VALUE: gapath help SETTING says more"]
    for setting in root().settings:
        lines.append(f"  {setting.name} = {shown(setting.value)}")
    lines += ["", "settings of what is chosen: gapath help NAME, as ga3 or kg18_test4"]
    return "\n".join(lines)


def topic(word: str) -> str:
    """Tell everything that a word stands for.

    Parameters
    ----------
    word : str
        A setting, "planner.population" or "trials"; a name, "ga3" or "planner=ga3"; a group; a
        column of the trials, "expansions"; a topic of the log, "/drive_step".

    Returns
    -------
    str
        Some lines.

    Raises
    ------
    InputError
        If it stands for nothing; names what is near.
    """
    group, equals, name = word.partition("=")
    if equals and group in CHOSEN:
        return chosen(group, name)
    found = list(_found(word)) or list(_in_run_folders(word))
    if not found:
        raise InputError("help", word, _near(word, _all_words()))
    return "\n\n".join(found)


def _found(word: str) -> Iterator[str]:
    for setting in root().settings:
        if word == setting.name:
            yield f"{setting.name} = {shown(setting.value)}\n{explained(setting)}"
    inner = [each for each in root().settings if each.name.startswith(f"{word}.")]
    if inner:
        yield "\n".join(_entry(each) for each in inner)
    if word in (*CHOSEN, *OF_HYDRA):
        yield f"{word}=NAME, one of\n{textwrap.indent(listed(word), '  ')}"
    for group in CHOSEN:
        if word in yaml_names(group):
            yield _of_preset(preset(group, word))
    for group in OF_HYDRA:
        if word in yaml_names(group):
            yield f"{group}={word}: {about(group, word)}"
    if word.partition(".")[0] in CHOSEN:
        yield from _of_setting(word)


def _in_run_folders(word: str) -> Iterator[str]:
    """Tell what a column or a topic is; takes NumPy and more, which settings do without."""
    from gapath.recorders.mcap.format import TOPICS, schema
    from gapath.reference.columns import all_columns, column

    if word in all_columns():
        unit, meaning = column(word)
        told = f"{unit}: {meaning}" if unit else meaning
        yield "\n".join([f"{word}, a column of trials.parquet", *_wrapped(told)])
    if word in TOPICS:
        fields = textwrap.indent(schema(TOPICS[word]).decode(), "  ")
        yield f"{word}, messages of run.mcap: {TOPICS[word]}\n{fields}".rstrip()


def _of_preset(told: Preset) -> str:
    head = f"{told.group}={told.name}: {told.about}"
    return "\n".join([*_wrapped(head, ""), *(_entry(each) for each in told.settings)])


def _entry(setting: Setting) -> str:
    return f"  {setting.name} = {shown(setting.value)}\n{explained(setting)}"


def explained(setting: Setting) -> str:
    """Say meaning, unit, range and source of a setting, indented."""
    unit = f"{setting.unit}; " if setting.unit else ""
    told = all(each in setting.remark for each in setting.source.split(", "))
    source = setting.remark if told else f"{setting.source}: {setting.remark}".removesuffix(": ")
    lines = [setting.meaning, f"{unit}{setting.range}", source]
    return "\n".join(line for text in lines for line in _wrapped(text))


def _of_setting(name: str) -> Iterator[str]:
    """Tell what a setting means to each kind of component that has it, and its values there."""
    users: dict[str, list[tuple[Preset, Setting]]] = {}
    for each in presets(name.partition(".")[0]):
        for setting in each.settings:
            if setting.name == name:
                users.setdefault(each.kind, []).append((each, setting))
    for kind, pairs in users.items():
        first = next((s for each, s in pairs if each.name == kind), pairs[0][1])
        values: dict[str, list[str]] = {}
        for each, setting in pairs:
            values.setdefault(shown(setting.value), []).append(each.name)
        told = "; ".join(f"{value} in {', '.join(names)}" for value, names in values.items())
        yield "\n".join([*_wrapped(f"{name} of {kind}: {told}", ""), explained(first)])


def _wrapped(text: str, indent: str = "      ") -> list[str]:
    return textwrap.wrap(
        text, width(), initial_indent=indent, subsequent_indent=indent or "  ",
        break_on_hyphens=False, break_long_words=False,
    )  # fmt: skip


def _all_words() -> list[str]:
    """Give every word that `topic` knows."""
    words = [*CHOSEN, *OF_HYDRA, *groups_of_tasks(), *(each.name for each in root().settings)]
    for group in (*CHOSEN, *OF_HYDRA):
        words += yaml_names(group)
    for group in CHOSEN:
        words += [setting.name for each in presets(group) for setting in each.settings]
    return list(dict.fromkeys(words))


def _near(word: str, names: list[str]) -> str:
    """Say what would be right in place of an unknown word, the nearest ones."""
    from difflib import get_close_matches

    ends: dict[str, Any] = {}
    for name in names:
        ends.setdefault(name.lower(), name)
        ends.setdefault(name.rpartition(".")[2].lower(), name)
    near = get_close_matches(word.lower(), list(ends), n=4)
    told = list(dict.fromkeys(ends[each] for each in near))
    return f"one of {len(names)} words, such as {', '.join(told or names[:3])}; gapath help"
