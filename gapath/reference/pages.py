"""The pages that are made from the sources: docs/settings.md and docs/columns.md."""

from gapath.discovery import kinds
from gapath.recorders.mcap.format import TOPICS, schema
from gapath.reference.columns import column
from gapath.reference.settings import CHOSEN, Preset, Setting, presets, root, shown
from gapath.task import columns, find_task

_MADE = "<!-- Made by `make reference`: do not edit. -->"


def settings_page() -> str:
    """Write docs/settings.md: every setting, a table for each kind of component."""
    lines = ["# Settings", "", _MADE, "",
             "Every setting: its value in each YAML of `conf`, meaning, unit, range and source. "
             "`gapath help NAME` says the same in a terminal. \"assumed\" is what a paper leaves "
             "open; \"gapath\" is what no paper has."]  # fmt: skip
    lines += ["", "## Root", "", "Settings of every run, of tasks, and of a search.", ""]
    lines += _table([("", [(root(), setting)]) for setting in root().settings])
    for group in CHOSEN:
        lines += ["", f"## {group.capitalize()}s", ""]
        named = presets(group)
        lines += ["| name | kind | what it is |", "| --- | --- | --- |"]
        lines += [f"| `{group}={p.name}` | {_kind(group, p)} | {_cell(p.about)} |" for p in named]
        for kind in dict.fromkeys(each.kind for each in named):
            lines += _of_kind(group, kind, [each for each in named if each.kind == kind])
    return "\n".join(lines) + "\n"


def _kind(group: str, preset: Preset) -> str:
    """Name the kind of a YAML; it leads to the table of its settings, if it has any."""
    name = f"`{preset.kind}`"
    return f"[{name}](#{group}-{preset.kind})" if preset.settings else name


def _of_kind(group: str, kind: str, named: list[Preset]) -> list[str]:
    users: dict[str, list[tuple[Preset, Setting]]] = {}
    for each in named:
        for setting in each.settings:
            users.setdefault(setting.name, []).append((each, setting))
    if not users:
        return []
    return ["", f"### {group} {kind}", "", *_table(list(users.items()))]


def _table(rows: list[tuple[str, list[tuple[Preset, Setting]]]]) -> list[str]:
    lines = ["| setting | value | meaning | unit | range | source |",
             "| --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    for _, users in rows:
        base = next((each for preset, each in users if preset.name == preset.kind), users[0][1])
        cells = [f"`{base.name}`", _values(users), _cell(base.meaning), base.unit,
                 _cell(base.range), _cell(_source(base))]  # fmt: skip
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _values(users: list[tuple[Preset, Setting]]) -> str:
    """Say which YAMLs have which value; of many names the first two and how many more."""
    values: dict[str, list[str]] = {}
    for preset, setting in users:
        values.setdefault(_cell(shown(setting.value)), []).append(preset.name)
    if len(values) == 1:
        return f"`{next(iter(values))}`"
    if len(values) > _MOST_VALUES:
        return "its own in each"
    return "; ".join(f"`{value}` ({', '.join(names)})" for value, names in values.items())


_MOST_VALUES = 6


def _source(setting: Setting) -> str:
    told = all(each in setting.remark for each in setting.source.split(", "))
    return setting.remark if told else f"{setting.source}: {setting.remark}".removesuffix(": ")


def _cell(text: str) -> str:
    """Write text such that it stays in a cell of a table, and reads as it stands."""
    text = text.replace("``", "`").replace("|", "\\|")
    parts = text.split("`")  # every second one is code, where < is itself
    return "`".join(part if i % 2 else part.replace("<", "&lt;") for i, part in enumerate(parts))


def columns_page() -> str:
    """Write docs/columns.md: columns of ``trials.parquet``, messages of the log."""
    lines = ["# Columns and messages", "", _MADE, "",
             "What a run folder's files hold: the columns of `trials.parquet`, a row a trial, and "
             "the messages of `run.mcap`."]  # fmt: skip
    for task in kinds("task"):
        lines += ["", f"## Columns of task={task}", ""]
        lines += ["| column | type | unit | meaning |", "| --- | --- | --- | --- |"]
        for name, kind in columns(find_task(task).row).items():
            unit, meaning = column(name)
            lines.append(f"| `{name}` | {kind.__name__} | {unit} | {_cell(meaning)} |")
    lines += ["", "## Messages of the log", "",
              "Standard messages are what viewers of ROS 2 draw; those of `gapath_msgs` hold the "
              "numbers exactly."]  # fmt: skip
    for topic in TOPICS:
        lines += _of_topic(topic)
    return "\n".join(lines) + "\n"


def _of_topic(topic: str) -> list[str]:
    """Describe a topic's messages: standard ones by name, our own with each field."""
    name, text = TOPICS[topic], schema(TOPICS[topic]).decode()
    lines = ["", f"### {topic}", "", f"`{name}`"]
    if not name.startswith("gapath_msgs/"):
        return lines
    said, fields = [], []
    for line in text.splitlines():
        before, _, comment = line.partition("#")
        if not before.strip():
            said.append(comment.strip())
        elif "=" not in before:
            fields.append(
                f"| `{before.split()[1]}` | {before.split()[0]} | {_cell(comment.strip())} |"
            )
        else:
            fields.append(f"| `{before.split()[1]}` | constant, {before.split()[0]} | |")
    head = ["| field | type | meaning |", "| --- | --- | --- |"]
    lines[-1] += f": {_cell(' '.join(said))}"
    return [*lines, "", *head, *fields]


PAGES = {"settings.md": settings_page, "columns.md": columns_page}
"""Names within ``docs``, and who writes them."""
