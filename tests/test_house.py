"""The plan of the house: how much a room holds, what it says of itself, and who knows of tasks."""

import ast
import os
import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
HOUSE = ("gapath", "pipelines", "benchmarks", "tests")

MODULES_AT_THE_ROOT = 10
FILES_IN_A_FOLDER = 12
LINES_OF_A_FILE = 350
ARGUMENTS = 9

LINKS = ("conf", "maps", "pipelines")
"""Folders at the top that are part of the package; in an sdist, which has no links, copies."""

SAME_SIGNATURE = {("benchmarks/rivals/textbook.py", "evolve")}
"""The rival of a kernel takes what the kernel takes."""

WITH_BRACKETS = ("pipelines/papers/names.py", "gapath/components.py")
"""The first writes names for people, what differs behind them; the second reads those of fields."""

NAMED_OTHERWISE = {
    ("gapath/__init__.py", "plan"),
    ("gapath/__init__.py", "drive"),
    ("gapath/api.py", "drive"),
}
"""The library's functions and a group of settings, not the tasks."""


def folders(root, *tops):
    """Folders with Python files, and all of their files; links lead to other tops."""
    for top in tops:
        for place, inner, names in os.walk(root / top):
            if Path(place) == root / "gapath":
                inner[:] = [name for name in inner if name not in LINKS]
            if any(name.endswith(".py") for name in names):
                yield Path(place).relative_to(root).as_posix(), sorted(names)


def modules(root, *tops):
    """Python files: path from the root, and text."""
    for folder, names in folders(root, *tops):
        for name in names:
            if name.endswith(".py"):
                yield f"{folder}/{name}", (root / folder / name).read_text("utf-8")


def crowded(root):
    return [
        f"{folder}: {len(names)} files"
        for folder, names in folders(root, *HOUSE)
        if len(names) > FILES_IN_A_FOLDER
    ]


def ranges_with_one_end(root):
    """Texts that say what would be right with a least integer, but no most."""
    one = re.compile(r"\bintegers? (from \d+ on|>=? ?\d)|\bnumbers? from \d+ on|^at least \d+$")
    for path, text in modules(root, "gapath", "pipelines"):
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Call):
                for given in node.args:
                    if isinstance(given, ast.Constant) and one.search(str(given.value)):
                        yield f"{path}: {given.value}"


def long_files(root):
    return [
        f"{path}: {lines} lines"
        for path, text in modules(root, *HOUSE)
        if (lines := len(text.splitlines())) > LINES_OF_A_FILE
    ]


def long_signatures(root):
    for path, text in modules(root, "gapath", "pipelines", "benchmarks"):
        if path.startswith("gapath/kernels/"):
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                given = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
                count = sum(argument.arg not in ("self", "cls") for argument in given)
                if count > ARGUMENTS and (path, node.name) not in SAME_SIGNATURE:
                    yield f"{path}:{node.lineno}: {node.name} takes {count}"


def asked_for(text):
    """Strings that code compares with, looks up or matches, and their lines."""
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Compare():
                places = [node.left, *node.comparators]
            case ast.Dict():
                places = node.keys
            case ast.Subscript():
                places = [node.slice]
            case ast.MatchValue():
                places = [node.value]
            case _:
                continue
        for place in places:
            several = isinstance(place, ast.Tuple | ast.List | ast.Set)
            for item in place.elts if several else [place]:
                if isinstance(item, ast.Constant) and isinstance(item.value, str):
                    yield item.value, item.lineno


def asked_for_tasks(root):
    tasks = {path.stem for path in (root / "gapath" / "tasks").glob("*.py")} - {"__init__"}
    assert tasks, "gapath/tasks holds no task"
    return [
        f"{path}:{line}: {name!r}"
        for path, text in modules(root, "gapath", "pipelines", "benchmarks")
        for name, line in asked_for(text)
        if name in tasks
        and path != f"gapath/tasks/{name}.py"
        and (path, name) not in NAMED_OTHERWISE
    ]


def vague_rooms(root):
    """Packages whose docstring is missing, no sentence, or that of another package."""
    said = {}
    for path, text in modules(root, "gapath", "pipelines", "benchmarks"):
        if path.endswith("/__init__.py"):
            words = ast.get_docstring(ast.parse(text)) or ""
            if len(words.split()) < 4 or "." not in words:
                yield f"{path}: {words!r}"
            elif words in said:
                yield f"{path}: {words!r}, as {said[words]}"
            said[words] = path


def none(found, advice):
    found = list(found)
    assert not found, "\n".join([advice, *found])


def test_few_modules_lie_at_the_root_of_the_package():
    found = sorted(path.name for path in (ROOT / "gapath").glob("*.py"))
    assert len(found) <= MODULES_AT_THE_ROOT, f"give some of them a room: {found}"


def test_no_folder_is_crowded():
    none(crowded(ROOT), f"more than {FILES_IN_A_FOLDER} files in a folder: make a room of some")


def test_no_file_is_long():
    none(long_files(ROOT), f"more than {LINES_OF_A_FILE} lines: split where there is a seam")


def test_no_function_takes_a_crowd_of_arguments():
    none(long_signatures(ROOT), f"more than {ARGUMENTS} arguments: make one thing of some")


def test_no_code_asks_which_task_it_is():
    none(asked_for_tasks(ROOT), "a task is asked for by its name: let it say what differs")


def taken_apart(root):
    """Find code that takes a name apart at its bracket: it is for people, settings are data."""
    for path, text in modules(root, "gapath", "pipelines", "benchmarks"):
        if path in WITH_BRACKETS:
            continue
        for node in ast.walk(ast.parse(text)):
            split = isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
            if split and any(isinstance(a, ast.Constant) and a.value == "[" for a in node.args):
                yield f"{path}:{node.lineno}"


def test_ranges_in_messages_have_both_ends():
    assert not [*ranges_with_one_end(ROOT)]


def test_no_code_takes_a_name_apart():
    none(list(taken_apart(ROOT)), "a name is for people: ask the run's settings")


def test_every_room_says_what_question_it_answers():
    none(vague_rooms(ROOT), "its docstring does not say what question the room answers")


@pytest.mark.parametrize(
    "code",
    [
        "task == 'drive'",
        "'drive' != task",
        "task in ('plan', 'drive')",
        "task in {'plan', 'drive'}",
        "{'drive': 1}[task]",
        "rows['drive']",
        "kind: Literal['plan', 'drive']",
        "match task:\n    case 'plan' | 'drive':\n        pass",
    ],
)
def test_code_that_asks_for_a_task_is_noticed(code):
    assert "drive" in [name for name, _ in asked_for(code)]


@pytest.mark.parametrize("code", ["TASK = 'drive'", "make_task('drive')", "{'task': 'drive'}"])
def test_code_that_names_a_task_may(code):
    assert "drive" not in [name for name, _ in asked_for(code)]


def test_hooks_run_what_make_check_runs():
    recipe = re.search(r"^check:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    checks = re.findall(r"\$\(BIN\)/(.+)", recipe[1])
    (local,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    assert local["repo"] == "local", "nothing is fetched"
    assert [hook["entry"].removeprefix(".venv/bin/") for hook in local["hooks"]] == checks


def test_the_citation_is_one():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert cited["cff-version"] == "1.2.0"
    assert {"message", "title", "abstract", "authors"} <= set(cited)
    assert "version" not in cited, "it stands in pyproject.toml"
    for key in ("license", "keywords", "authors"):
        assert cited[key] == project[key]
    papers = (ROOT / "docs" / "papers.md").read_text("utf-8")
    text = " ".join(papers.split())
    for paper in cited["references"]:
        assert {"type", "title", "authors", "year"} <= set(paper)
        assert paper["title"] in text
        assert paper.get("doi", "") in text
    assert [str(paper["year"]) for paper in cited["references"]] == ["2018", "2004", "2022"]
