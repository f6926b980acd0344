"""The pages: names, links, commands and examples hold what they say."""

import re
import runpy
import shlex
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest
import yaml
from hydra import initialize_config_dir
from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra._internal.utils import get_args_parser
from hydra.core.global_hydra import GlobalHydra
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.types import RunMode
from omegaconf import OmegaConf

import gapath
from gapath import components
from gapath.api import load_map
from gapath.commands import genotype as genotype_cli
from gapath.commands import log as log_cli
from gapath.commands import run as cli
from gapath.commands.composing import Composer
from gapath.commands.told import screen
from gapath.mapio.movingai import read_scenario
from gapath.pipelines.asking import command as asking
from gapath.pipelines.compare import command as comparing
from gapath.pipelines.keeping import command as keeping
from gapath.pipelines.report import cli as report_cli
from gapath.pipelines.report import watch
from gapath.planning.path import octile_length
from gapath.running import config
from gapath.running.posing import read_problem
from gapath.task import find_task

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
PAGES = [
    page
    for pattern in ("*.md", "docs/**/*.md", "maps/*.md", "examples/*.md", "outputs/README.md")
    for page in sorted(ROOT.glob(pattern))
]
PAPERS = (ROOT / "docs" / "papers.md").read_text("utf-8")
KG18, rest = PAPERS.split("\n## S04")
S04, M22 = rest.split("\n## M22")
OF_PAPERS = pytest.mark.parametrize(
    ("page", "name", "assumed"),
    [(KG18, "bspline_ga", "### What is assumed"),
     (S04, "sedighi", "### What is assumed of S04"),
     (M22, "visibility_ga", "### What is assumed of M22")],
    ids=["kg18", "s04", "m22"],
)  # fmt: skip

each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def blocks(text, language=""):
    """The fenced code blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def inline(text):
    """Everything in single backticks."""
    outside = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"`([^`\n]+)`", outside)


def is_object(name):
    """Tell whether a dotted name is a module, or something within one."""
    parts = name.split(".")
    parts = ["gapath", *parts] if parts[0] == "pipelines" else parts
    for at in range(len(parts), 0, -1):
        try:
            found = import_module(".".join(parts[:at]))
        except ModuleNotFoundError:
            continue
        for part in parts[at:]:
            annotated = getattr(found, "__annotations__", {})
            if not hasattr(found, part) and part not in annotated:
                return False
            found = getattr(found, part, None)
        return True
    return False


def is_test(name):
    path, _, function = name.partition("::")
    file = ROOT / path
    return file.is_file() and f"\ndef {function}(" in file.read_text("utf-8")


def is_setting(name):
    """Tell whether `planner.x`, `map.x`, `recorder.y.x` or a root setting is in a YAML."""
    group, _, rest = name.partition(".")
    if not rest:
        files = [ROOT / "conf" / "config.yaml"]
    elif group == "recorder":
        files = [ROOT / "conf" / "recorder" / f"{rest.partition('.')[0]}.yaml"]
    else:
        files = sorted((ROOT / "conf" / group).glob("*.yaml"))
    key = name.rpartition(".")[2]
    return any(key in yaml.safe_load(file.read_text("utf-8")) for file in files if file.is_file())


def exists(name):
    if "::" in name:
        return is_test(name)
    if "/" in name:
        return (ROOT / name).exists()
    if name.startswith(("gapath.", "pipelines.")):
        return is_object(name)
    return is_setting(name)


def test_every_name_in_the_papers_page_exists():
    names = sorted(set(inline(PAPERS)))
    assert len(names) > 80
    assert [name for name in names if not exists(name)] == []


@each_page
def test_every_test_and_object_that_a_page_names_exists(page):
    names = set(inline(page.read_text("utf-8")))
    named = [n for n in names if re.fullmatch(r"tests/[\w/.:]+|gapath\.[\w.]+", n)]
    assert [name for name in named if not exists(name)] == []


@pytest.mark.parametrize(
    "name",
    [
        "gapath.kernels.kg18.bspline.spline",
        "gapath.kernels.nothing",
        "pipelines.papers.kg18.MINUTES",
        "tests/test_docs.py::test_of_nothing",
        "tests/none.py::test_every_name_in_the_papers_page_exists",
        "conf/planner/none.yaml",
        "planner.colour",
        "recorder.mcap.colour",
        "colour",
    ],
)
def test_a_name_that_does_not_exist_is_noticed(name):
    assert not exists(name)


def planner_yaml(name):
    return (ROOT / "conf" / "planner" / f"{name}.yaml").read_text("utf-8")


@OF_PAPERS
def test_every_setting_is_on_the_papers_page_with_its_default(page, name, assumed):
    rows = re.findall(r"^\| `planner\.(\w+)` \| ([^|]+) \|", page, re.MULTILINE)
    shown = {setting: yaml.safe_load(value) for setting, value in rows}
    settings = yaml.safe_load(planner_yaml(name))
    assert shown == {setting: value for setting, value in settings.items() if setting != "kind"}


@OF_PAPERS
def test_what_is_assumed_in_the_yaml_is_assumed_on_the_papers_page(page, name, assumed):
    yaml_says = set(re.findall(r"^(\w+): \S+ +# assumed", planner_yaml(name), re.MULTILINE))
    section = page.partition(f"{assumed}\n")[2].partition("\n###")[0]
    assert yaml_says == set(re.findall(r"^\| `planner\.(\w+)`", section, re.MULTILINE))


def anchor(heading):
    """The name that a heading has in links, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@each_page
def test_every_link_within_the_project_leads_somewhere(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text("utf-8")):
        if re.match(r"(https?|mailto):", link):
            continue
        name, _, part = link.partition("#")
        there = (page.parent / name).resolve() if name else page
        assert there.exists(), link
        if part:
            headings = re.findall(r"^#+ (.+)$", there.read_text("utf-8"), re.MULTILINE)
            assert part in map(anchor, headings), link


def commands(page):
    """Commands of ours that a page shows, but for those with placeholders."""
    text = page.read_text("utf-8")
    lines = [
        line for block in blocks(text, r"\w*") for line in block.replace("\\\n", "").split("\n")
    ]
    found = [line.strip().removeprefix("$ ") for line in [*lines, *inline(text)]]
    placeholder = re.compile(r"[<>…|\\]|\.\.\.|\b[A-Z]{3,}\b")
    return [
        line
        for line in found
        if re.match(r"gapath(-log|-report|-genotype)? \S", line) and not placeholder.search(line)
    ]


def check_parser(parser, words):
    try:
        parser.parse_args(words)
    except SystemExit as stop:
        assert not stop.code, f"{parser.prog} does not know {words}"


def check_report(words):
    if words[:1] == ["runs"]:
        check_parser(asking.parser(), words[1:])
    elif words[:1] == ["compare"]:
        check_parser(comparing.parser(), words[1:])
    elif words[0] in ("tag", "note", "prune", "archive"):
        check_parser(keeping.parser(words[0]), words[1:])
    elif words[:1] == ["watch"]:
        check_parser(watch.parser(), words[1:])
    else:
        check_parser(report_cli._report_parser(), words)


def check_gapath(words):
    """Check the jobs of a command: of a sweep as many as bring every value of each setting."""
    if words[0] in screen.WORDS:
        assert screen.tell(words) == 0
        return
    if words[0] in ("log", "report", "genotype", "run"):
        CHECKS[f"gapath-{words[0]}".removesuffix("-run")](words[1:])
        return
    given = get_args_parser().parse_args(words)
    if given.shell_completion or given.help:
        return
    jobs = [given.overrides]
    if given.multirun:
        parsed = OverridesParser.create().parse_overrides(given.overrides)
        each = [BasicSweeper.split_arguments([setting], None)[0] for setting in parsed]
        most = max(map(len, each))
        jobs = [[word for v in each for word in v[i % len(v)]] for i in range(most)]
    for overrides in jobs:
        check_job(tuple(overrides))


@cache
def composer():
    """Compose as a sweep does: YAMLs that several jobs choose once."""
    with initialize_config_dir(config.conf_folder(), version_base="1.3"):
        loader = GlobalHydra.instance().config_loader()
        sweep = loader.load_configuration("config", ["hydra.mode=MULTIRUN"], RunMode.MULTIRUN)
        return Composer(loader, sweep)


@cache  # pages show the same ones
def check_job(overrides):
    """Compose a job and make its parts; only maps with files are read."""
    loose = OmegaConf.to_container(composer()(overrides))
    del loose["hydra"]
    root, chosen = config.split(loose)
    made = find_task(root.task).make(chosen)
    for name, values in root.recorder.items():
        components.build("recorder", values, f"recorder.{name}")
    components.build("map", root.map, "map")
    if "path" in root.map:
        read_problem(root.map, root.corner_cutting, made, {})


def check_genotype(words):
    assert genotype_cli.main(words) == 0


CHECKS = {
    "gapath": check_gapath,
    "gapath-log": lambda words: check_parser(log_cli._parser(), words),
    "gapath-report": check_report,
    "gapath-genotype": check_genotype,
}
EXAMPLE = "planner=one_bend"  # of tests/plugin, which has tests of its own


@each_page
def test_every_command_shown_is_understood(page, monkeypatch):
    monkeypatch.chdir(EXAMPLES)
    for command in commands(page):
        program, *words = shlex.split(command, comments=True)
        if not any(word.startswith(EXAMPLE) for word in words):
            CHECKS[program](words)


WITH_FILES = sorted(
    {line.partition(" #")[0] for page in PAGES for line in commands(page) if "map.path=" in line}
)


@pytest.mark.parametrize("command", WITH_FILES)
def test_every_command_with_a_file_does_what_the_page_says(command, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(EXAMPLES)
    words = [*shlex.split(command)[1:], "recorder=none", f"output={tmp_path}"]
    monkeypatch.setattr("sys.argv", ["gapath", *words])
    cli.main()
    text, errors = capfd.readouterr()
    assert errors == ""
    one = r"^(status +(?:found|optimal)|outcome +reached)$"
    many = r"^found +\d+ \(100.0 %\)$|: (\d+) of \2 found"
    assert re.search(f"{one}|{many}", text, re.MULTILINE)


def test_the_pages_use_every_example():
    used = " ".join(page.read_text("utf-8") for page in PAGES if page.parent != EXAMPLES)
    for file in EXAMPLES.iterdir():
        image = file.suffix == ".pgm"  # named by a YAML file
        assert image or file.is_dir() or file.suffix == ".md" or file.name in used, file.name


def test_published_lengths_of_the_example_are_those_of_its_scenario(monkeypatch):
    monkeypatch.chdir(EXAMPLES)
    rows = read_scenario("arena.map.scen")
    assert len(rows) == 6
    for number, row in enumerate(rows):
        grid = load_map("arena.map", scenario="arena.map.scen", problem=number)
        plan = gapath.plan(grid, planner="astar", minimise="length", corner_cutting="forbid")
        assert octile_length(plan.path) == pytest.approx(row.optimal_length, abs=1e-6)


def test_a_command_that_is_wrong_is_noticed():
    outside = ["map=file", "map.path=office.png", "map.start=[1,1]", "map.target=[2,2]"]
    for words in (["planner=ga9"], ["planner.colour=red"], ["planner.population=-5"], outside):
        with pytest.raises(cli.BAD_CONFIGURATION):
            check_gapath(words)
    with pytest.raises(AssertionError, match="gapath-log does not know"):
        CHECKS["gapath-log"](["look", "run.mcap"])
    with pytest.raises(AssertionError, match="gapath-report does not know"):
        check_report(["outputs", "--colour"])


def test_the_examples_of_the_log_page_read_a_log(tmp_path, monkeypatch, capfd):
    pytest.importorskip("mcap_ros2")
    arguments = ["map=kg18_test1", "planner=ga1", "recorder=mcap", "trials=2", "seed=5"]
    monkeypatch.setattr("sys.argv", ["gapath", *arguments, f"output={tmp_path / 'out'}"])
    cli.main()
    (log,) = tmp_path.glob("out/plan/*/run.mcap")
    monkeypatch.chdir(log.parent)
    capfd.readouterr()
    examples = blocks((ROOT / "docs" / "log.md").read_text("utf-8"), "python")
    assert len(examples) == 2
    for example in examples:
        (tmp_path / "example.py").write_text(example)
        runpy.run_path(str(tmp_path / "example.py"))
    printed = capfd.readouterr().out.splitlines()
    assert len(printed) == 2 + 1 + 2
    assert "0 0 True" in printed[0]
    assert printed[2] == "kg18_test1 5"
