"""The command gapath-report runs: what it lists, pools and refuses."""

import csv
import io
import json
import shutil

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from gapath.pipelines.asking.answer import Answer, write_text
from gapath.pipelines.asking.groups import grouped
from gapath.pipelines.asking.listing import short_keys
from gapath.pipelines.numbers.statistics import expected_running_time, wilson
from gapath.pipelines.numbers.text import NOTHING
from gapath.pipelines.report import cli
from gapath.store.results import Results

from ..conftest import summed, write_status

MAPS = ("kg18_test1", "kg18_test3", "kg18_test4")


def populate(outputs, make_run):
    """Runs of GA 1 with three populations on three maps, and of A*, in the order of dates."""
    i = 0
    for name in MAPS:
        for population in (20, 40, 100):
            run = make_run(
                outputs, "sizes", name, "ga1", n=9 + i, log=False, key=f"{i}abcdef{population:03}",
                date=f"2026-01-{10 + i}T12:00:00+00:00", seed=i,
            )  # fmt: skip
            rows = pd.read_parquet(run / "trials.parquet")
            rows.assign(**{"planner.population": population}).to_parquet(run / "trials.parquet")
            config = yaml.safe_load((run / "config.yaml").read_text())
            config["planner"]["population"] = population
            (run / "config.yaml").write_text(yaml.safe_dump(config))
            summed(run)
            i += 1
    run = make_run(outputs, "sizes", "kg18_test1", "astar", n=5, log=False, key="astar0",
                   date="2026-02-01T12:00:00+00:00")  # fmt: skip
    summed(run)


@pytest.fixture(scope="module")
def outputs(tmp_path_factory, make_run):
    folder = tmp_path_factory.mktemp("asked")
    populate(folder, make_run)
    return folder


@pytest.fixture
def ask(outputs, capsys):
    """Give the command's exit code, its output and its messages."""

    def asked(*words, folder=outputs):
        code = cli.main(["runs", str(folder), *words])
        return code, *capsys.readouterr()

    return asked


def rows_of(ask, *words, **more):
    code, out, said = ask(*words, "--json", **more)
    assert code == 0, said
    return json.loads(out)


def test_a_list_has_what_varies_and_the_newest_last(ask):
    code, out, said = ask()
    head, _, *lines = out.splitlines()
    assert (code, said) == (0, "")
    assert head.split()[:7] == ["key", "experiment", "map", "preset", "planner.population", "seed",
                                "trials"]  # fmt: skip
    assert "planner.mixing" not in head and "superseded" not in head and "task" not in head.split()
    assert [line.split()[0] for line in lines] == [f"{i}abcde" for i in range(9)] + ["astar0"]
    assert lines[4].split()[1:5] == ["sizes", "kg18_test3", "ga1", "40"]
    assert lines[-1].split()[-3:] == ["done", "2026-02-01", "12:00"]


def test_conditions_order_and_the_last(ask):
    rows = rows_of(ask, "--where", "map='kg18_test3' and planner.population>=40")
    assert [row["planner.population"] for row in rows] == [40, 100]
    assert [row["key"][0] for row in rows_of(ask, "--last", "2")] == ["8", "a"]
    by = [row["trials"] for row in rows_of(ask, "--sort", "-trials", "--last", "3")]
    assert by == [17, 16, 5]
    by = [row["planner.population"] for row in rows_of(ask, "--sort", "planner.population")]
    assert by == [20] * 3 + [40] * 3 + [100] * 3 + [None]


def test_columns_that_are_asked_for(ask):
    _, out, _ = ask("--columns", "key, planner.population,success", "--last", "2", "--csv")
    assert out.splitlines()[:2] == ["key,planner.population,success", "8abcdef100,100,0.0"]
    _, out, _ = ask("--columns", "planner.population,key", "--last", "2")
    assert [line.split() for line in out.splitlines()[2:]] == [
        ["100", "8abcde"],
        [NOTHING, "astar0"],
    ]


def test_csv_and_json_have_all_columns_with_all_digits(ask, outputs):
    rows = rows_of(ask)
    table = list(csv.DictReader(io.StringIO(ask("--csv")[1])))
    assert list(rows[0]) == list(table[0])
    for row, cells in zip(rows, table, strict=True):
        trials = pd.read_parquet(outputs / "sizes" / row["key"] / "trials.parquet")
        assert row["plan_time_s"] == pytest.approx(trials["plan_time_s"].mean(), rel=1e-14)
        assert float(cells["plan_time_s"]) == row["plan_time_s"]
        assert row["success"] == trials["feasible"].mean()
        if not trials["feasible"].any():
            assert (row["optimality_ratio"], cells["optimality_ratio"]) == (None, "")


@pytest.mark.parametrize("width", [30, 60, 80, 100, 140])
def test_a_list_is_as_wide_as_the_terminal(ask, width, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setattr(shutil, "get_terminal_size", lambda: shutil.os.terminal_size((width, 20)))
    out = ask()[1]
    assert max(map(len, out.splitlines())) <= width
    assert "0abcde" in out and (width < 60 or "success" in out)
    assert ("optimality" in out) == (width >= 140)


def test_long_texts_are_shortened_at_last():
    file = io.StringIO()
    write_text(Answer(["a", "b"], [["x" * 30, None], [1.5, 20]]), file, 20, {})
    assert file.getvalue().splitlines() == [
        "a                  b",
        "---------------  ---",
        "xxxxxxxxxxxxxx…  1.5",
        f"{NOTHING}                 20",
    ]


@pytest.mark.parametrize(
    ("keys", "short"),
    [
        ([], []),
        (["0123456789"], ["012345"]),
        (["0123456789", "0123457789"], ["0123456", "0123457"]),
        (["abc", "abcdefgh"], ["abc", "abcdef"]),
        (["same0000", "same0000"], ["same00", "same00"]),
    ],
)
def test_keys_are_as_short_as_they_can_be(keys, short):
    assert [short_keys(keys)[key] for key in keys] == short


def test_a_run_is_asked_for_by_the_beginning_of_its_key(ask, tmp_path, make_run):
    assert [row["key"] for row in rows_of(ask, "3a", "astar0")] == ["3abcdef020", "astar0"]
    for key in ("abcdef1", "abcdef2"):
        make_run(tmp_path, "e", "kg18_test1", "ga1", n=2, log=False, key=key, seed=int(key[-1]))
    code, _, said = ask("abcdef", folder=tmp_path)
    assert code == 2 and "KEY: got abcdef, expected more of it: abcdef1, abcdef2 begin so" in said
    assert [line.split()[0] for line in ask(folder=tmp_path)[1].splitlines()[2:]] == [
        "abcdef1", "abcdef2",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--where", "succes > 1"], "where: got succes > 1, expected a column in place of succes;"),
        (["--where", "map ="], "where: got map =, expected SQL that can be answered (Parser Error"),
        (["--where", ""], "where: got '', expected"),
        (["--columns", "key,pop"], "--columns: got pop, expected a column"),
        (["--columns", ""], "--columns: got '', expected a column"),
        (["--columns", "planner.populaton"], "did you mean planner.population?"),
        (["--sort", "-sucess"], "--sort: got sucess, expected a column; did you mean success?"),
        (["--group", "population"], "--group: got population, expected a column; did you mean pla"),
        (["--group", "map", "--sort", "seed"], "--sort: got seed, expected a column"),
        (["--group", "map", "--columns", "seed"], "--columns: got seed, expected a column"),
        (["--last", "0"], "--last: got 0, expected"),
        (["zzz"], "KEY: got zzz, expected the beginning of a run's key"),
        ([""], "KEY: got '', expected the beginning of a run's key"),
        (["--sql", "select 1", "--group", "map"], "--group: got --sql, too, expected only one"),
        (["--sql", "select 1", "--sort", "map"], "--sort: got --sql, too, expected only one"),
        (["--sql", "select nope from runs"], "--sql: got select nope from runs, expected a column"),
        (["--sql", "select planner.populaton from runs"], "did you mean planner.population?"),
        (["--sql", "select sum(feasble) from trials"], "did you mean feasible?"),
        (["--sql", "select * from run"], "SQL that can be answered (Catalog Error"),
        (["--sql", "selec 1"], "SQL that can be answered (Parser Error"),
        (["--sql", ""], "expected one SELECT over the tables runs and trials"),
        (["--sql", "select 1; select 2"], "expected one SELECT over"),
        (["--sql", "drop table runs"], "expected one SELECT over"),
        (["--sql", "copy runs to 'x.csv'"], "expected one SELECT over"),
        (["--sql", "set enable_external_access = true"], "expected one SELECT over"),
        (["--sql", "install httpfs"], "expected one SELECT over"),
        (["--sql", "attach 'x.db'"], "expected one SELECT over"),
        (["--sql", "select * from '/etc/passwd'"], "SQL that can be answered"),
        (["--sql", "select * from read_csv('/etc/passwd')"], "Permission Error"),
        (["--sql", "select * from read_parquet('*/*/trials.parquet')"], "Permission Error"),
        (["--sql", "select success::int[] from runs"], "SQL that can be answered"),
    ],
)
def test_what_cannot_be_answered_is_one_line(ask, words, said):
    code, out, error = ask(*words)
    assert (code, out, error.count("\n")) == (2, "", 1)
    assert error.startswith("gapath-report: ") and said in error


def test_no_folder_and_no_runs_are_one_line(ask, tmp_path):
    assert ask(folder=tmp_path / "none")[0] == ask(folder=tmp_path)[0] == 2


def test_no_run_fulfils_it(ask):
    assert ask("--where", "map = 'elsewhere'")[::2] == (0, "no such runs\n")
    for words in (["--group", "map"], ["--sql", "select count(*) as n from trials"]):
        code, out, said = ask("--where", "map = 'elsewhere'", *words, "--csv")
        assert (code, said) == (0, "no such runs\n") and len(out.splitlines()) <= 2


def spoiled(folder, outputs):
    """The runs, three of them spoiled, one superseded, and folders that are no runs."""
    shutil.copytree(outputs, folder)
    runs = sorted((folder / "sizes").iterdir())
    write_status(runs[0], "interrupted")
    (runs[1] / "trials.parquet").unlink()
    (runs[2] / "manifest.json").unlink()
    shutil.copytree(runs[3], runs[3].with_name("again"))
    write_status(runs[3].with_name("again"), "done", "2026-03-01")
    (folder / "report").mkdir()
    (folder / "report" / "index.html").write_text("")
    return [run.name for run in runs]


def test_runs_that_cannot_be_used_are_listed_with_the_reason(ask, tmp_path, outputs):
    keys = spoiled(tmp_path / "o", outputs)
    size = (outputs / "sizes" / keys[1] / "trials.parquet").stat().st_size
    code, out, said = ask(folder=tmp_path / "o")
    assert code == 0 and len(out.splitlines()) == 2 + 11
    row = {line.split()[0]: line for line in out.splitlines()}
    assert all(word in row["0abcde"] for word in ("interrupted", "kg18_test1"))
    assert "unusable" in row["1abcde"] and "unusable" in row["2abcde"]
    assert [key for key in row if row[key].split()[-3:-2] == ["again"]] == ["3abcde"]
    right = f"{size} bytes, as the manifest says", "a file, as every finished run has one"
    assert said.splitlines() == [
        f"sizes/{keys[0]}: interrupted",
        f"sizes/{keys[1]}: trials.parquet: got no file, expected {right[0]}",
        f"sizes/{keys[2]}: manifest.json: got no file, expected {right[1]}",
    ]


def test_runs_that_do_not_count_are_left_out_by_name_where_trials_are_pooled(
    ask, tmp_path, outputs
):
    keys = spoiled(tmp_path / "o", outputs)
    for words in (["--group", "map"], ["--sql", "select count(*) as trials from trials"]):
        code, out, said = ask(*words, "--json", folder=tmp_path / "o")
        trials = sum(row["trials"] for row in json.loads(out))
        assert (code, trials) == (0, 12 + 13 + 14 + 15 + 16 + 17 + 5)
        assert [line.partition(":")[0] for line in said.splitlines()] == [
            f"left out sizes/{keys[place]}" for place in (0, 1, 2, 3)
        ]
        assert said.endswith("again counts, of the same setting\n")


def test_groups_by_hand(ask):
    rows = rows_of(ask, "--group", "planner.population,map", "--where", "map <> 'kg18_test3'")
    assert [(row["planner.population"], row["map"]) for row in rows] == [
        *((size, name) for size in (20, 40, 100) for name in ("kg18_test1", "kg18_test4")),
        (None, "kg18_test1"),
    ]
    assert [row["runs"] for row in rows] == [1] * 7
    never = rows[1]
    assert (never["success"], never["success_low"]) == (0, 0) and 0 < never["success_high"] < 0.3
    assert never["expected_evaluations"] is None and never["length"] == 25
    exact = rows[-1]  # draws no random numbers
    assert (exact["success"], exact["success_low"], exact["expected_evaluations"]) == (
        1,
        None,
        None,
    )
    text = ask("--group", "map")[1].splitlines()
    assert text[0].split()[:4] == ["map", "runs", "trials", "success"]
    assert "∞" in text[-1] and "kg18_test4" in text[-1]


def test_groups_are_ordered_by_what_they_came_to(ask):
    rows = rows_of(ask, "--group", "map", "--sort", "-success", "--columns", "success,map")
    assert [row["map"] for row in rows] == list(MAPS)
    assert list(rows[0]) == ["success", "map"]


trials = st.lists(
    st.tuples(
        st.booleans(),
        st.integers(0, 3000),
        st.floats(1e-6, 10),
        st.floats(1, 1e3) | st.just(np.nan),
    ),
    min_size=1,
    max_size=6,
)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(["a", "b", None]), st.booleans(), trials), min_size=1))
def test_groups_are_those_of_all_trials_together(runs):
    names = ("feasible", "evaluations", "plan_time_s", "length")
    tables = [pd.DataFrame(rows, columns=names) for _, _, rows in runs]
    came = [Results.of(table["feasible"], dict(table[[*names[1:]]])) for table in tables]
    by = ["map", "planner.stop"]
    keys = pd.DataFrame([row[:2] for row in runs], columns=by).astype({"map": "str"})
    found = grouped(keys, came, by)
    together = pd.concat(
        [table.assign(**key, run=i) for i, (table, key) in
         enumerate(zip(tables, keys.to_dict("records"), strict=True))]
    )  # fmt: skip
    groups = list(together.groupby(by, dropna=False))
    assert len(groups) == len(found)
    for (_, group), (_, row) in zip(groups, found.iterrows(), strict=True):
        n, rate = len(group), group["feasible"].mean()
        assert (row["runs"], row["trials"], row["success"]) == (group["run"].nunique(), n, rate)
        for name in names[1:]:
            assert row[name] == pytest.approx(group[name].mean(), rel=1e-12, nan_ok=True)
        seconds = expected_running_time(group["plan_time_s"], group["feasible"])
        assert row["expected_seconds"] == pytest.approx(seconds, rel=1e-12)
        if group["evaluations"].any():
            evaluations = expected_running_time(group["evaluations"], group["feasible"])
            assert row["expected_evaluations"] == pytest.approx(evaluations, rel=1e-12)
            assert (row["success_low"], row["success_high"]) == wilson(rate, n)
        else:
            assert row[["expected_evaluations", "success_low", "success_high"]].isna().all()


def test_a_question_in_sql_is_answered_as_pandas_does(ask, outputs):
    text = (
        "select r.map, r.planner.population as size, count(*) as n, avg(t.length) as length, "
        "sum(t.evaluations) / sum(t.feasible::int) as spent from runs r join trials t using (key) "
        "where r.planner.population is not null group by all order by all"
    )
    frames = [
        pd.read_parquet(path).assign(key=path.parent.name) for path in outputs.rglob("*.parquet")
    ]
    together = pd.concat(frames)
    together = together[together["planner"] == "ga1"]
    rows = rows_of(ask, "--sql", text)
    groups = list(together.groupby(["map", "planner.population"]))
    assert len(rows) == len(groups) == 9
    for row, ((name, size), group) in zip(rows, groups, strict=True):
        assert (row["map"], row["size"], row["n"]) == (name, size, len(group))
        mean, found = group["length"].mean(), group["feasible"].sum()
        assert row["length"] == pytest.approx(mean, rel=1e-12)
        assert (row["spent"] is None) == (found == 0)


def test_columns_that_some_runs_lack_are_null_and_types_are_kept(tmp_path, make_run, ask):
    lacks = make_run(tmp_path, "e", "kg18_test1", "ga1", n=4, log=False, key="lacks")
    pd.read_parquet(lacks / "trials.parquet").drop(columns="turns").to_parquet(
        lacks / "trials.parquet"
    )
    summed(lacks)
    fails = make_run(tmp_path, "e", "kg18_test4", "ga2", n=3, log=False, key="fails", seed=1)
    rows = pd.read_parquet(fails / "trials.parquet")
    rows.assign(length=np.nan, **{"planner.x": 2}).to_parquet(fails / "trials.parquet")
    summed(fails)
    made = rows_of(
        ask,
        "--sql",
        "select key, count(*) as n, count(turns) as turns, count(length) as length, "
        "avg(length) as mean, any_value(planner.x) as x, any_value(typeof(planner.x)) as kind, "
        "any_value(typeof(length)) as real, any_value(typeof(seed)) as seed "
        "from trials group by key order by key",
        folder=tmp_path,
    )
    kinds = {"kind": "BIGINT", "real": "DOUBLE"}
    assert [{name: row[name] for name in kinds} for row in made] == [kinds] * 2
    del made[0]["seed"], made[1]["seed"]
    assert made == [
        {"key": "fails", "n": 3, "turns": 3, "length": 0, "mean": None, "x": 2, **kinds},
        {"key": "lacks", "n": 4, "turns": 0, "length": 4, "mean": 25.0, "x": None, **kinds},
    ]


def test_trials_that_cannot_be_read_are_left_out_by_name(tmp_path, outputs, ask):
    shutil.copytree(outputs, tmp_path / "o")
    bad = [
        tmp_path / "o" / "sizes" / key / "trials.parquet" for key in ("0abcdef020", "5abcdef100")
    ]
    for path in bad:
        path.write_bytes(b"x" * path.stat().st_size)
    text = "select count(distinct r.key) as runs, count(*) as n from runs r join trials using (key)"
    code, out, said = ask("--sql", text, "--csv", folder=tmp_path / "o")
    assert (code, out) == (0, f"runs,n\n8,{sum(range(9, 18)) + 5 - 9 - 14}\n")
    assert sorted(said.splitlines()) == [
        f"left out sizes/{path.parent.name}: its trials cannot be read" for path in bad
    ]
