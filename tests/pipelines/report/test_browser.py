"""The pages in a browser: they ask for nothing, say nothing in its console, and do what they offer.

Debian's Chromium, or whatever of that kind is on the path; playwright is only its driver.
"""

import math
import os
import re
from itertools import pairwise
from urllib.parse import unquote, urlsplit

import pandas as pd
import pytest

from gapath.pipelines.page.page import Part, render
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.report.report import make_report

from ..conftest import summed

WIDE, PHONE = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
SIZES = pytest.mark.parametrize("size", [WIDE, PHONE], ids=["1280", "390"])
SCHEMES = pytest.mark.parametrize("scheme", ["light", "dark"])
TABLE = "#kg18-table1 .scroll:has(#table1-caption)"
METRICS = "#sweeps-table-metrics-plan"


@pytest.fixture(scope="module")
def report(tmp_path_factory, make_run, make_drive_run):
    """A report of a paper's table, drives, and a sweep of one's own with several seeds."""
    outputs = tmp_path_factory.mktemp("pages")
    for name in ("kg18_test1", "kg18_test2", "kg18_test3"):
        for planner in ("ga1", "ga2", "ga3", "astar"):
            make_run(outputs, "table1", name, planner, n=12)
    make_drive_run(outputs, "drives", "kg18_map4", "kg18", log=True)
    for seed in (1, 2):
        make_run(outputs, "mine", "kg18_test2", "ga3", seed=seed, n=250, log=False)
    files, _ = make_report(outputs, outputs / "report")
    return files[-1]


@pytest.fixture
def opened(browser, report):
    """Open a page; whatever it asks for or says must be nothing when it is closed."""
    contexts, heard = [], []

    def open_(size=WIDE, scheme="light", path=report, script=True):
        context = browser.new_context(
            viewport=size, color_scheme=scheme, reduced_motion="reduce", java_script_enabled=script
        )
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: heard.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: heard.append(str(error)))
        page.on("request", lambda request: heard.append(request.url)
                if not request.url.startswith(("file:", "data:")) else None)  # fmt: skip
        page.goto(path.as_uri())
        return page

    yield open_
    for context in contexts:
        context.close()
    assert heard == []


def texts(page, column, table=TABLE):
    return page.locator(f"{table} tbody tr > :nth-child({column})").all_inner_texts()


def value(text):
    """The number that a cell shows; infinite where it shows none, as it comes last."""
    return math.inf if text == "\N{EN DASH}" else float(text.replace("\u202f", ""))


def sort(page, column, state, table=TABLE, press="click"):
    """Click a column's head, or press Enter on it, until it says how it is sorted."""
    header = page.locator(f"{table} thead th:nth-child({column})")
    if press == "click":
        header.click()
    else:
        header.locator("[role=button]").press(press)
    sorted_ = f"[aria-sort={state}]" if state else ":not([aria-sort])"
    page.locator(f"{table} thead th:nth-child({column}){sorted_}").wait_for()


def column_of(page, title, table=TABLE):
    titles = page.locator(f"{table} thead th").all_inner_texts()
    return [text.strip() for text in titles].index(title) + 1


def clear(color):
    """How bright a colour is, from 0 to 255."""
    return sum(map(int, re.findall(r"\d+", color)[:3])) / 3


@SIZES
@SCHEMES
def test_a_page_fits_and_follows_the_scheme(opened, size, scheme):
    page = opened(size, scheme)
    overflow = "document.documentElement.scrollWidth - innerWidth"
    assert page.evaluate(overflow) <= 0
    ink, paper = page.evaluate(
        "[getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor]"
    )
    assert abs(clear(ink) - clear(paper)) > 150
    assert (clear(paper) < 60) == (scheme == "dark")
    figure = page.locator("#kg18-figure-evaluations img").first
    figure.scroll_into_view_if_needed()
    shades = page.evaluate(
        """async (image) => {
            const canvas = new OffscreenCanvas(200, 200);
            const context = canvas.getContext("2d");
            context.drawImage(image, 0, 0, 200, 200);
            const data = context.getImageData(0, 0, 200, 200).data;
            const seen = [];
            for (let i = 0; i < data.length; i += 4)
                seen.push((data[i] + data[i + 1] + data[i + 2]) / 3);
            return [`rgb(${data.slice(0, 3).join(", ")})`, Math.min(...seen), Math.max(...seen)];
        }""",
        figure.element_handle(),
    )
    corner, darkest, brightest = shades
    assert corner == paper
    assert brightest > 200 if scheme == "dark" else darkest < 40
    page.goto(page.locator(f"{TABLE} tbody a").first.evaluate("link => link.href"))
    assert page.evaluate(overflow) <= 0
    assert (clear(page.evaluate("getComputedStyle(document.body).backgroundColor")) < 60) == (
        scheme == "dark"
    )


def test_a_table_sorts_by_numbers_and_back(opened):
    page = opened()
    table = "#kg18-table1 .scroll:has(#table1_effort-caption)"
    column = column_of(page, "Expected evaluations", table)
    before = texts(page, column, table)
    numbers = [value(text) for text in before]
    assert sorted(before) != sorted(before, key=value) != before
    sort(page, column, "ascending", table)
    assert [value(text) for text in texts(page, column, table)] == sorted(numbers)
    sort(page, column, "descending", table, press="Enter")
    down = [value(text) for text in texts(page, column, table)]
    assert down[:-3] == sorted(numbers, reverse=True)[3:] and down[-3:] == [math.inf] * 3
    sort(page, column, "", table)
    assert texts(page, column, table) == before


def test_what_is_missing_comes_last_whichever_way_a_column_is_sorted(opened):
    page = opened()
    column = column_of(page, "Epochs")
    for state in ("ascending", "descending"):
        sort(page, column, state)
        cells = texts(page, column)
        assert cells[-3:] == ["\N{EN DASH}"] * 3 and "\N{EN DASH}" not in cells[:-3]


def test_each_row_says_where_it_belongs_and_shows_it_once(opened):
    page = opened()
    hidden = f"{TABLE} tbody th.again"
    assert page.locator(hidden).count() == 9  # three maps, four planners
    assert texts(page, 1).count("Map 2 (reconstructed)") == 4
    assert page.locator(hidden).first.evaluate("cell => getComputedStyle(cell).color") == (
        "rgba(0, 0, 0, 0)"
    )
    sort(page, 2, "ascending")
    planners, maps = texts(page, 2), texts(page, 1)
    assert planners == sorted(planners)
    again = page.locator(f"{TABLE} tbody tr").evaluate_all(
        "rows => rows.map(row => row.cells[0].classList.contains('again'))"
    )
    assert again == [False, *(one == other for one, other in pairwise(maps))]


def test_a_filter_leaves_the_rows_that_match(opened):
    page = opened()
    field = page.locator(f"{METRICS} input[type=search]")
    rows = page.locator(f"{METRICS} tbody tr")
    whole = rows.count()
    assert whole > 8
    field.fill('"map 2" "ga 3"')
    assert all("Map 2" in text and "GA 3" in text for text in rows.all_inner_texts())
    assert 0 < rows.count() < whole
    said = page.locator(f"{METRICS} [role=status]").inner_text()
    assert said == f"{rows.count()} of {whole} rows"
    field.fill("href")  # what is not seen is not looked for
    assert rows.all_inner_texts() == ["No row matches."]
    field.fill("")
    assert rows.count() == whole
    few = page.locator("#kg18-drives-table")
    assert few.locator("table").count() and not few.locator("input").count()


def test_a_large_table_shows_a_page_of_rows_at_a_time(opened, tmp_path):
    shown = pd.DataFrame({
        "Map": [f"m{i // 10}" for i in range(600)],
        "Planner": [f"p{i % 10}" for i in range(600)],
        "Time": [str(i * 7919 % 600) for i in range(600)],
    })  # fmt: skip
    part = Part("large", Section("Large", tables=(Table("t", "T.", shown, shown),)), [])
    path = tmp_path / "bench.html"
    path.write_text(render("bench.html.j2", parts=[part], machine={}, quick=False))
    page = opened(path=path)
    rows = page.locator("#large tbody tr")
    assert rows.count() == 250
    sort(page, 3, "ascending", "#large")
    assert texts(page, 3, "#large") == [str(i) for i in range(250)]
    page.locator(".dt-paging-button", has_text="3").press("Enter")
    page.locator("#large tbody tr:nth-child(1)", has_text="500").wait_for()
    assert texts(page, 3, "#large") == [str(i) for i in range(500, 600)]
    page.locator("#large input").fill('"m7" "p3"')
    assert rows.count() == 1


@SIZES
def test_the_menu_leads_to_a_section_and_marks_it(opened, size):
    page = opened(size)
    summary, links = page.locator(".menu summary"), page.locator(".menu a[href^='#']")
    assert page.locator(".menu p").all_inner_texts()[0] == "KG18" or size is PHONE
    for link in (links.nth(2), links.last, links.first):
        if size is PHONE:
            assert not link.is_visible()
            summary.press("Enter")
        place = link.get_attribute("href")
        link.click()
        page.wait_for_function(
            "place => document.querySelector(`.menu a[href='${place}']`).ariaCurrent === 'true'",
            arg=place, timeout=3000,
        )  # fmt: skip
        box = page.locator(place).bounding_box()
        assert -1 <= box["y"] < size["height"]
        assert page.locator(".menu [aria-current]").count() == 1
        assert summary.bounding_box()["y"] >= -1, "the menu stays"
    page.evaluate("document.getElementById('kg18-figure-paths').scrollIntoView()")
    page.locator(".menu a[href='#kg18-figure-paths'][aria-current]").wait_for(state="attached")


def test_a_figure_enlarges_and_gives_the_focus_back(opened):
    page = opened()
    button = page.locator("#kg18-figure-evaluations button.enlarge").first
    small = button.bounding_box()["width"]
    for open_, close in (("Enter", "Escape"), ("Space", "Enter")):
        button.press(open_)
        picture = page.locator("dialog[open] img")
        assert picture.bounding_box()["width"] > 1.5 * small
        page.keyboard.press(close)
        assert page.locator("dialog[open]").count() == 0
        assert button.evaluate("button => button === document.activeElement")


@SIZES
def test_the_columns_that_name_a_row_stay(opened, size):
    page = opened(size)
    box = page.locator(f"{METRICS} .scroll")
    box.scroll_into_view_if_needed()
    cells = box.locator("tbody tr:nth-child(2) > *")
    before = [cell.bounding_box()["x"] for cell in cells.all()]
    box.evaluate("box => box.scrollTo(150, 0)")
    after = [cell.bounding_box()["x"] for cell in cells.all()]
    edge = box.bounding_box()["x"]
    assert edge - 1 <= after[1] < after[2] < after[3] + 150
    assert after[2] - edge < 0.5 * box.bounding_box()["width"], "room for what they name"
    gone = box.evaluate("box => box.scrollLeft")
    assert gone > 50
    assert after[4] == pytest.approx(before[4] - gone, abs=1)
    last = cells.nth(2).bounding_box()
    assert last["x"] + last["width"] < edge + 0.7 * box.bounding_box()["width"]


def hrefs(page):
    return page.locator("a[href]").evaluate_all("links => links.map(link => link.href)")


def test_a_row_leads_to_the_page_of_its_run_and_that_to_its_files(opened, report):
    page = opened()
    page.locator(f"{TABLE} tbody a").first.click()
    page.wait_for_url("**/runs/*.html")
    assert page.locator("h1").inner_text() == "GA 1 on Map 1"
    for address in hrefs(page):
        path = unquote(urlsplit(address).path)
        assert os.path.exists(path), path  # noqa: PTH110
    names = page.locator("#run li a").all_inner_texts()
    assert {"run.mcap", "config.yaml", "trials.parquet"} <= set(names)
    commands = page.locator("pre").all_inner_texts()
    assert commands[0] == "gapath experiment=table1"
    of_log = r"gapath-log view (\S+/run\.mcap)\ngapath-log verify \1"
    assert re.fullmatch(of_log, commands[1].strip())
    assert page.locator(".still polyline:not(.least)").count() >= 4  # three epochs, some paths
    assert page.locator("#trials tbody tr").count() == 12
    column = column_of(page, "plan_time_s", "#trials")
    sort(page, column, "ascending", "#trials")
    times = [float(text) for text in texts(page, column, "#trials")]
    assert times == sorted(times) and len(set(times)) > 1


def test_a_row_of_several_runs_leads_to_their_list(opened, report):
    page = opened()
    page.locator("#sweeps-table-plan-mine tbody a").press("Enter")
    page.wait_for_url("**/runs/of-*.html")
    assert page.locator("h1").inner_text() == "2 runs behind a row: GA 3 on Map 2"
    page.goto(page.locator("tbody a").last.evaluate("a => a.href"))  # waits for all of it
    assert page.locator("h1").inner_text() == "GA 3 on Map 2"
    assert "kept no log" in page.locator("#stills").inner_text()
    assert page.locator("#trials tbody tr").count() == 200
    assert "The first 200 of 250 trials" in page.locator("#trials caption").inner_text()


def test_numbers_of_trials_are_whole_or_without_end_as_they_were(opened, tmp_path, make_run):
    run = make_run(tmp_path, "mine", "kg18_test2", "ga3", n=4, log=False)
    costs, counts = [math.inf, 9.0, 1234567.25, 12.0], [390385, 7, 100001, 2**53 + 1]
    rows = pd.read_parquet(run / "trials.parquet").assign(cost=costs, evaluations=counts)
    rows.assign(feasible=rows["cost"] < math.inf).to_parquet(run / "trials.parquet")
    summed(run)
    make_report(tmp_path, tmp_path / "report")
    page = opened(path=tmp_path / "report" / "runs" / f"{run.name}.html")
    column, counted = (column_of(page, name, "#trials") for name in ("cost", "evaluations"))
    assert texts(page, counted, "#trials") == [str(count) for count in counts]
    sort(page, column, "ascending", "#trials")
    assert texts(page, column, "#trials") == ["9", "12", "1234600", "\N{INFINITY}"]


def test_without_scripts_everything_is_there(opened, report):
    page = opened(PHONE, script=False)
    assert page.locator(f"{TABLE} tbody tr").count() == 12
    assert page.locator(".menu a[href='#kg18-table1']").is_visible()
    assert page.locator("figure img").first.is_visible()
    page.goto(page.locator(f"{TABLE} tbody a").first.evaluate("link => link.href"))
    trials = page.locator("#trials pre")
    assert trials.is_visible() and trials.inner_text().startswith("trial,")
