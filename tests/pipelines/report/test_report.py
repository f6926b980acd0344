import json
import re
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import pytest

from gapath.pipelines.page.section import ALL, Section, find_sections
from gapath.pipelines.report import report as report_module
from gapath.pipelines.report.cli import main
from gapath.pipelines.report.report import make_report

from ..conftest import sign, write_status


class Page(HTMLParser):
    """Collects every tag, and complains of what is not closed."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open = [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "link", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def all(self, tag):
        return [attrs for name, attrs in self.tags if name == tag]


@pytest.fixture(scope="module")
def report(outputs, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "new"
    files, skipped = make_report(outputs, folder)
    assert skipped == []
    return files


@pytest.fixture(scope="module")
def page(report):
    return report[-1].read_text()


def test_files(report):
    folder = report[-1].parent
    names = {str(path.relative_to(folder)) for path in report}
    assert report[-1].name == "index.html"
    for table in ("table1", "table1_effort", "classes"):
        assert {f"{table}.csv", f"{table}.md", f"{table}.tex"} <= names
    for figure in ("convergence", "evaluations", "paths_kg18_test1", "paths_kg18_test4"):
        assert {f"{figure}.svg", f"{figure}.png"} <= names
    there = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert there == names  # nothing half-written


def test_the_page_asks_nothing_of_a_network(report, page):
    tags = Page(page)
    (script,) = re.findall("<script>(.*?)</script>", page, re.DOTALL)
    assert tags.all("script") == [{}]
    (policy,) = [meta["content"] for meta in tags.all("meta") if "http-equiv" in meta]
    known = b64encode(sha256(script.encode()).digest()).decode()
    assert policy.startswith("default-src 'none'; img-src data:;")
    assert policy.endswith(f"script-src 'sha256-{known}'")
    for attrs in tags.all("img"):
        assert attrs["src"].startswith("data:image/svg+xml,<svg")
    for attrs in tags.all("a"):
        target = attrs["href"]
        assert target.startswith("#") or (report[-1].parent / target).is_file()
    assert [attrs["href"] for attrs in tags.all("link")] == ["data:,"]
    assert "@import" not in page
    assert not re.search(r"url\((?!%23)", page.replace(script, ""))  # but within pictures


def test_the_page_can_be_read_by_everyone(page):
    tags = Page(page)
    assert tags.all("html")[0]["lang"] == "en"
    assert any(attrs.get("name") == "viewport" for attrs in tags.all("meta"))
    assert all(len(attrs["alt"]) > 40 for attrs in tags.all("img"))
    assert all(attrs["scope"] in ("col", "row") for attrs in tags.all("th"))
    assert len(tags.all("caption")) == len(tags.all("table"))
    ids = [attrs["id"] for _, attrs in tags.tags if "id" in attrs]
    assert len(ids) == len(set(ids))
    for attrs in tags.all("a"):
        if attrs["href"].startswith("#"):
            assert attrs["href"][1:] in ids


def test_the_page_says_what_it_is_made_of(page):
    assert page.count("Map 3 (reconstructed)") > 3
    assert "gapath experiment=table1" in page
    assert "Three executions say little" in page
    assert "Versions that made the runs" in page
    assert "Left out" not in page
    assert "sweeps-table-plan" not in page  # each experiment has its own section


def test_the_same_runs_give_the_same_page(outputs, report):
    """And so do the pages of runs, where the way to the run folders is the same."""
    first = report[-1].parent
    again = first.with_name("again")
    files, _ = make_report(outputs, again)
    for path in files:
        name = path.relative_to(again)
        assert path.read_bytes() == (first / name).read_bytes(), name


def test_sections_are_found_and_keep_the_protocol():
    modules = find_sections()
    names = {module.__name__.rpartition(".")[2] for module in modules}
    assert {"table1", "table_classes", "figure_convergence", "figure_paths"} <= names
    assert [module.ORDER for module in modules] == sorted({module.ORDER for module in modules})
    for module in modules:
        assert module.EXPERIMENT is None or isinstance(module.EXPERIMENT, str)
        assert callable(module.section)


def test_every_section_has_a_place_of_its_own(page):
    ids = [attrs["id"] for tag, attrs in Page(page).tags if tag == "section"]
    assert {"kg18-table1", "kg18-table-classes", "sweeps-table-metrics-plan"} <= set(ids)
    assert len(ids) == len(set(ids))


@pytest.mark.usefixtures("undrawn")
def test_only_what_was_run_is_shown(tmp_path, make_run):
    make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    files, _ = make_report(tmp_path, tmp_path / "report")
    page = files[-1].read_text()
    assert '<section id="sweeps-table-plan-plan">' in page
    assert "Convergence" not in page
    assert "KG18 Table 1" not in page


@pytest.mark.parametrize(("task", "others"), [("plan", 1), (ALL, 1), ("drive", 2)])
def test_what_a_section_wants_is_not_shown_as_other_trials(
    task, others, tmp_path, make_run, monkeypatch
):
    """Nor where that section is asked for every task; one of another task's wants none of these."""
    seen = {}

    def section(trials, runs, name):
        seen.setdefault(name, []).append(*set(trials["experiment"]))
        return Section(name)

    mine, rest = (
        SimpleNamespace(
            __name__=name, TASK=of, EXPERIMENT=experiment, ORDER=0,
            section=lambda trials, runs, name=name: section(trials, runs, name),
        )
        for name, of, experiment in (("mine", task, "mine"), ("rest", "plan", None))
    )  # fmt: skip
    monkeypatch.setattr(report_module, "find_sections", lambda: [mine, rest])
    for experiment in ("mine", "plan"):
        make_run(tmp_path, experiment, "kg18_test1", "ga3", n=1, log=False)
    make_report(tmp_path, tmp_path / "report")
    assert seen["rest"] == ["mine", "plan"][-others:]
    assert seen.get("mine", ["mine"]) == ["mine"]


@pytest.mark.usefixtures("undrawn")
def test_a_folder_that_was_renamed_is_still_read(tmp_path, make_run):
    make_run(tmp_path, "table1", "kg18_test1", "ga3", n=3)
    (tmp_path / "table1").rename(tmp_path / "mine")
    files, skipped = make_report(tmp_path, tmp_path / "report")
    assert skipped == []
    assert "KG18 Table 1" in files[-1].read_text()


@pytest.mark.usefixtures("undrawn")
def test_what_is_skipped_is_named_and_the_rest_goes_on(tmp_path, make_run, capsys):
    whole = make_run(tmp_path, "table1", "kg18_test1", "ga1")
    torn = make_run(tmp_path, "table1", "kg18_test2", "ga1")
    dead = make_run(tmp_path, "table1", "kg18_test3", "ga1")
    bare = make_run(tmp_path, "table1", "kg18_test1", "ga2", log=False)
    log = torn / "run.mcap"
    log.write_bytes(log.read_bytes()[:-300])
    sign(torn)
    write_status(dead, "running", text="<b>& a message</b>")
    assert main([str(tmp_path)]) == 0
    page = (tmp_path / "report" / "index.html").read_text()
    Page(page)
    left_out = page[page.index("Left out") :]
    for run in (torn, dead, bare):
        assert f"table1/{run.name}" in left_out
    assert whole.name not in left_out
    assert "interrupted: &lt;b&gt;&amp; a message" in left_out
    out, err = capsys.readouterr()
    assert err.count("left out") == 3
    assert str(tmp_path / "report" / "index.html") in out


@pytest.mark.usefixtures("undrawn")
def test_a_hostile_name_stays_text(tmp_path, make_run):
    run = make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    manifest = json.loads((run / "manifest.json").read_text())
    manifest["command"] = "gapath map=<script>alert(1)</script>"
    (run / "manifest.json").write_text(json.dumps(manifest))
    files, _ = make_report(tmp_path, tmp_path / "report")
    assert Page(files[-1].read_text()).all("script") == [{}]  # ours
    page = files[-1].parent / "runs" / f"{run.name}.html"
    assert Page(page.read_text()).all("script") == [{"src": "page.js"}]
    assert "alert(1)&lt;/script&gt;" in page.read_text()


@pytest.mark.parametrize("arguments", [["{}/no"], ["{}"], ["runs", "{}/no"], ["runs", "{}"]])
def test_nothing_to_report_is_one_line_and_exit_code_2(tmp_path, capsys, arguments):
    assert main([argument.format(tmp_path) for argument in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert str(tmp_path) in err
    assert list(tmp_path.iterdir()) == []


def test_no_usable_run_says_why(tmp_path, make_run, capsys):
    run = make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    write_status(run, "failed", text="OSError: disk full")
    assert main([str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert "disk full" in err
    assert err.count("\n") == 1
    assert not (tmp_path / "report").exists()


def test_an_output_that_cannot_be_written(tmp_path, make_run, capsys):
    make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    (tmp_path / "file").touch()
    assert main([str(tmp_path), "-o", str(tmp_path / "file")]) == 2
    assert "file" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--help"], ["runs", "--help"]])
def test_help(arguments, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(arguments)
    assert exit_.value.code == 0
    assert "gapath-report" in capsys.readouterr().out


def test_the_entry_point_is_quick_to_import():
    text = Path(main.__code__.co_filename).read_text()
    assert not re.search(r"^(import|from) (pandas|matplotlib|\.report)", text, re.MULTILINE)
