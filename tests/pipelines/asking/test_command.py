"""The command gapath-report runs: what it lists, and what it refuses."""

import csv
import io
import json
import shutil
from importlib.resources import files

import pandas as pd
import pytest
import yaml

from gapath.pipelines.asking.answer import Answer, write_text
from gapath.pipelines.asking.listing import short_keys
from gapath.pipelines.numbers.text import NOTHING

from ..conftest import summed
from .conftest import rows_of, spoiled


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


CONFIG = yaml.safe_load((files("gapath.conf") / "config.yaml").read_text("utf-8"))
TOP = [name for name, value in CONFIG.items() if not isinstance(value, dict | list)]


@pytest.mark.parametrize("name", [*TOP, "of_a_plugin"])
def test_any_setting_may_vary(ask, tmp_path, make_run, name, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setattr(shutil, "get_terminal_size", lambda: shutil.os.terminal_size((200, 20)))
    for i, value in enumerate(("one", "two")):
        run = make_run(tmp_path, "e", "kg18_test1", "ga1", n=2, log=False, key=value, seed=i)
        config = yaml.safe_load((run / "config.yaml").read_text()) | {name: value}
        (run / "config.yaml").write_text(yaml.safe_dump(config))
        summed(run)
    code, out, said = ask(folder=tmp_path)
    assert (code, said, len(out.splitlines())) == (0, "", 4)
    assert name in (*out.splitlines()[0].split(), "task", "name")  # which manifests say


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
    assert code == 2 and "key: got abcdef, the beginning of e/abcdef1, e/abcdef2, expected" in said
    folder, file = tmp_path / "e" / "abcdef1", tmp_path / "e" / "abcdef2" / "status.json"
    for given in (["e/abcdef1", "abcdef2"], [folder, file]):
        code, text, _ = ask(*map(str, given), folder=tmp_path)
        assert (code, text) == (0, ask(folder=tmp_path)[1])
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
        (["zzz"], "got no run zzz..., expected a key that"),
        ([""], "key: got '', expected the beginning of a run's key"),
        (["--sql", "select 1", "--group", "map"], "--group: got --sql, too, expected only one"),
        (["--sql", "select 1", "--sort", "map"], "--sort: got --sql, too, expected only one"),
        (["--sql", "select nope from runs"], "--sql: got select nope from runs, expected a column"),
        (["--sql", "select planner.populaton from runs"], "did you mean planner.population?"),
        (["--sql", "select sum(feasble) from trials"], "did you mean feasible?"),
        (["--sql", "select * from run"], "SQL that can be answered (Catalog Error"),
        (["--sql", "selec 1"], "SQL that can be answered (Parser Error"),
        (
            ["--sql", "select 1 as a, 2 as a", "--json"],
            "--json: got two columns a, expected another",
        ),
        (["--sql", ""], "expected one SELECT over the tables runs and trials"),
        (["--sql", "select 1; select 2"], "expected one SELECT over"),
        (["--sql", "drop table runs"], "expected one SELECT over"),
        (["--sql", "copy runs to 'x.csv'"], "expected one SELECT over"),
        (["--sql", "set enable_external_access = true"], "expected one SELECT over"),
        (["--sql", "install httpfs"], "expected one SELECT over"),
        (["--sql", "attach 'x.db'"], "expected one SELECT over"),
        (["--sql", "select * from '/etc/passwd'"], "SQL that can be answered"),
        (["--sql", "select * from read_csv('/etc/passwd')"], "Permission Error"),
        (["--sql", "select *\nfrom glob('/etc/*')"], "Permission Error"),
        (["--sql", "select planner.populaton\nfrom runs"], "did you mean planner.population?"),
        (["--where", "planner.populaton\n> 1"], "did you mean planner.population?"),
        (["--where", "success >\n"], "got success >, expected SQL"),
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


def test_runs_of_one_experiment_lie_below_another_folder(ask, outputs):
    code, _, said = ask(folder=outputs / "sizes")
    assert code == 2 and f"expected the folder above, {outputs.resolve()}: " in said


def test_no_run_fulfils_it(ask):
    assert ask("--where", "map = 'elsewhere'")[::2] == (0, "no such runs\n")
    for words in (["--group", "map"], ["--sql", "select map from trials"]):
        for form in ([], ["--csv"], ["--json"]):
            code, out, said = ask("--where", "map = 'elsewhere'", *words, *form)
            assert (code, said) == (0, "no such runs\n") and len(out.splitlines()) <= 5


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
