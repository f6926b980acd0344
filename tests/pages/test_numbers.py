"""Every number that a page takes from a run is what the tables of results give."""

import csv
import re
import sys
from pathlib import Path

import bound
import pytest
import renew

from benchmarks.__main__ import INDEX, QUESTIONS
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.text import percent

RESULTS = bound.ROOT / bound.RESULTS
BOUND, WHOLE = bound.read()
PAGES = bound.read_pages(BOUND, WHOLE)
TABLES = [each for each in BOUND if isinstance(each, bound.Table)]


@pytest.fixture(scope="module")
def connection():
    return bound.tables(RESULTS)


def test_every_number_is_what_its_query_gives(connection):
    wrong = bound.faults(BOUND, PAGES, connection)
    assert not wrong, "\n".join(map(str, ["see CONTRIBUTING.md, A number in the pages", *wrong]))


def test_sections_that_are_bound_wholly_have_no_other_number_in_a_table():
    assert list(bound.unbound(WHOLE, BOUND, PAGES)) == []


def test_each_number_that_is_another_is_noticed(connection):
    for name, page in PAGES.items():
        mine = [each for each in BOUND if each.where == name and isinstance(each, bound.Bound)]
        places = sorted(span for each in mine for span in each.found(PAGES)[0].regs[1:])
        shown = [page[start:end] for start, end in places]
        for start, end in reversed(places):
            page = page[:start] + other(page[start:end]) + page[end:]
        wrong = bound.faults(mine, {name: page}, connection)
        assert sorted(bound._plain(f.value) for f in wrong) == sorted(map(bound._plain, shown))


@pytest.mark.parametrize("table", TABLES, ids=lambda table: f"{table.where} {table.head}")
def test_each_row_of_a_table_that_is_another_is_noticed(table, connection):
    page = PAGES[table.where]
    (place,) = table.found(PAGES)
    rows = place[1].splitlines(keepends=True)
    for i, row in enumerate(rows):
        number = re.search(r"\d(?=\D*$)", row)
        changed = row[: number.start()] + other(number[0]) + row[number.end() :] if number else ""
        altered = "".join([*rows[:i], changed, *rows[i + 1 :]])
        altered_page = page[: place.start(1)] + altered + page[place.end(1) :]
        (fault,) = bound.faults([table], {table.where: altered_page}, connection)
        assert fault.value == place[1]
        assert row.strip() in fault.said


def other(shown):
    """A number with another last digit."""
    return "7" if shown == "∞" else shown[:-1] + ("1" if shown[-1] != "1" else "2")


def test_a_table_with_another_number_is_noticed(tmp_path):
    rows = list(csv.DictReader((RESULTS / "table1.csv").open()))
    (cell,) = (r for r in rows if r["map"] == "kg18_test3" and r["preset"] == "ga1")
    cell["found"] = str(int(cell["found"]) - 10)
    with (tmp_path / "table1.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    wrong = bound.faults(BOUND, PAGES, bound.tables(RESULTS, tmp_path))
    said = {(fault.where, fault.shown, fault.value) for fault in wrong}
    assert {("docs/results.md", "64.9", "63.9"), ("docs/maps.md", "64.9", "63.9")} <= said


@pytest.mark.parametrize(
    ("page", "says"),
    [
        ("It takes 5 ms.", "0 times, not once"),
        ("It takes 5 s. It takes 5 s.", "2 times, not once"),
        ("It takes 4 s.", "4 -> 5"),
        ("It takes 15 s.", "15 -> 5"),
        ("It takes\n5.1 s.", "5.1 -> 5.0"),
        ("It takes 5 s.", ""),
        ("It takes\n5.0 s.", ""),
    ],
)
def test_a_text_that_is_wrong_is_noticed(page, says, connection):
    each = bound.Bound("page", "takes {} s.", "select 4.96")
    wrong = bound.faults([each], {"page": page}, connection)
    assert says in str(wrong[0]) if says else not wrong


@pytest.mark.parametrize("query", ["select 5, 6", "select null", "select 5 where false", "from no"])
def test_a_query_that_gives_something_else_is_noticed(query, connection):
    (fault,) = bound.faults([bound.Bound("p", "a {} b", query)], {"p": "a 5 b"}, connection)
    assert fault.value is None
    assert query in str(fault)


def test_a_table_with_a_number_of_nobodys_is_noticed():
    page = "# One\n\n| map | found |\n| --- | --- |\n| 1 | 5 % |\n| 2 | 6 % |\n\n# Two\n"
    each = bound.Bound("p", "| 1 | {} % |", "select 5")
    assert list(bound.unbound(["p#one"], [each], {"p": page})) == ["p#one: | 2 | 6 % |"]
    literal = bound.Bound("p", "| 2 | 6 % |", "select 6 where false")
    assert list(bound.unbound(["p#one"], [each, literal], {"p": page})) == ["p#one: | 2 | 6 % |"]
    given = literal._replace(given="the paper's")
    assert list(bound.unbound(["p#one"], [each, given], {"p": page})) == []


@pytest.mark.parametrize(
    ("page", "query", "says"),
    [
        ("| a | b |\n| --- | --- |\n| 1 | 2 |\n", "select 1, 2", ""),
        ("| a | b |\n| --- | --- |\n| 1 |  |\n", "select 1, null", ""),
        ("| a | b |\n| --- | --- |\n| 1 | 2 |\n", "select 1, 3", "| 1 | 2 | -> | 1 | 3 |"),
        ("| a | b |\n| --- | --- |\n| 1 | 2 |\n", "select 1, 2 where false", "-> no row"),
        ("| a | b |\n| --- | --- |\n| 1 | 2 |\n", "values (1, 2), (3, 4)", "no row -> | 3 | 4 |"),
        ("| a | b |\n| --- | --- |\n", "select 1, 2", "0 times, not once"),
        ("| a | c |\n| --- | --- |\n| 1 | 2 |\n", "select 1, 2", "0 times, not once"),
    ],
)
def test_a_table_is_what_its_query_gives(page, query, says, connection):
    table = bound.Table("p", "| a | b |", query)
    wrong = bound.faults([table], {"p": f"Text.\n\n{page}\nText.\n"}, connection)
    assert says in wrong[0].said if says else not wrong


@pytest.mark.parametrize("of", [(0, 20), (7, 20), (1, 3000), (2999, 3000), (20, 20)])
def test_what_queries_may_use_is_what_reports_use(of, connection):
    rate, n = of[0] / of[1], of[1]
    made = connection.execute(f"select low({rate}, {n}), high({rate}, {n}), percent({rate})")
    *ends, text = made.fetchone()
    assert ends == pytest.approx(wilson(rate, n), abs=1e-12)
    assert text == percent(rate)


@pytest.mark.parametrize(
    ("number", "text"),
    [("0.02349", "0.023"), ("9.96", "10"), ("28957", "29000"), ("0", "0"), ("'inf'", "∞")],
)
def test_significant_digits(number, text, connection):
    made = connection.execute(f"select significant({number}::double, 2)").fetchone()
    assert made == (text,)


def test_every_table_has_a_question_that_makes_it_and_leads_to_its_runs():
    questions = {path.stem for path in RESULTS.glob("*.sql")}
    assert questions == {path.stem for path in RESULTS.glob("*.csv")}
    for name in questions:
        text = (RESULTS / f"{name}.sql").read_text("utf-8")
        assert re.match(r"-- .*(gapath experiment=|gapath -m |make )", text), name
        columns = (RESULTS / f"{name}.csv").read_text("utf-8").partition("\n")[0].split(",")
        elsewhere = re.search(r"whose runs (\w+)\.csv has", text)
        assert {"key", "keys"} & set(columns) or elsewhere[1] in questions, name
    assert sum(path.stat().st_size for path in RESULTS.rglob("*.csv")) < 500_000


def test_the_tables_of_benchmarks_are_of_one_whole_run():
    made = {path.stem for path in (RESULTS / bound.BENCH).glob("*.csv")}
    assert made == {*QUESTIONS, "targets", "machine", Path(INDEX).stem}
    assert INDEX == renew.LAST


def test_new_runs_are_held_against_the_pages_and_accepted(gapath, tmp_path, monkeypatch, capfd):
    gapath("map=kg18_test1", "planner=ga1", "trials=3", "recorder=none", "name=mine")
    results, page = tmp_path / bound.RESULTS, tmp_path / "page.md"
    results.mkdir(parents=True)
    results.with_name("numbers.toml").write_text(
        'whole = []\n[["page.md"]]\ntext = "{} trials"\nquery = "select trials from mine"\n'
    )
    question = "select key, count(*) as trials from trials where experiment = 'mine' group by key"
    (results / "mine.sql").write_text(f"-- gapath name=mine\n{question}")
    (results / "mine.csv").write_text("key,trials\nbefore,2\n")
    page.write_text("Of 2 trials.")
    monkeypatch.setattr(bound, "ROOT", tmp_path)

    def said(*words):
        monkeypatch.setattr(sys, "argv", ["renew.py", str(tmp_path / "out"), *words])
        with pytest.raises(SystemExit) as stop:
            renew.main()
        return stop.value.code, capfd.readouterr().out.splitlines()

    none = "bench: no results, left as they are"
    assert said() == (1, [none, "page.md:1: 2 -> 3 in Of 2 trials.", "1 numbers changed"])
    assert said("--accept", "other")[1] == [none, "0 numbers changed, and are written"]
    assert page.read_text() == "Of 2 trials."
    assert said("--accept", "mine")[0] == 0
    assert page.read_text() == "Of 3 trials."
    assert said() == (0, [none, "0 numbers changed"])


def test_what_was_measured_anew_is_held_against_the_pages_and_accepted(
    tmp_path, monkeypatch, capfd
):
    results, page = tmp_path / bound.RESULTS, tmp_path / "page.md"
    for folder, seconds in (results / "bench", 5), (tmp_path / "out" / "bench", 6):
        folder.mkdir(parents=True)
        (folder / "start.csv").write_text(f"what,seconds\nit,{seconds}\n")
        for name in (INDEX, "README.md"):
            (folder / name).write_text("question\n")
    page.write_text("| what | s |\n| --- | --- |\n| it | 5 |\n")
    results.with_name("numbers.toml").write_text(
        'whole = []\n[["page.md"]]\nhead = "| what | s |"\nquery = "from bench.start"\n'
    )
    monkeypatch.setattr(bound, "ROOT", tmp_path)
    for words, code, said in (
        ([], 1, "page.md:1: | it | 5 | -> | it | 6 |"),
        (["--accept", "start"], 0, "1 numbers changed, and are written"),
        ([], 0, "0 numbers changed"),
    ):
        monkeypatch.setattr(sys, "argv", ["renew.py", str(tmp_path / "out"), *words])
        with pytest.raises(SystemExit) as stop:
            renew.main()
        assert stop.value.code == code
        assert said in capfd.readouterr().out
    assert page.read_text().endswith("| it | 6 |\n")
