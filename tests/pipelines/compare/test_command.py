"""The command `gapath-report compare`, from run folders to files."""

import itertools
import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy import stats

from gapath.pipelines.compare.answer import NAMES
from gapath.pipelines.report.cli import main

from .conftest import compare

pytestmark = pytest.mark.usefixtures("undrawn")


def test_an_analysis_written_by_itself_agrees(sweep, tmp_path, capsys):
    compare(sweep, "--by", "planner.population", into=tmp_path)
    ours = pd.read_csv(tmp_path / "comparison.csv").set_index(["quantity", "first", "second"])

    frames = []
    for folder in (sweep / "mine").iterdir():
        settings = yaml.safe_load((folder / "config.yaml").read_text())
        frame = pd.read_parquet(folder / "trials.parquet")
        frames.append(frame.assign(group=settings["planner"]["population"]))
    trials = pd.concat(frames)
    told = (tmp_path / "comparison.md").read_text()
    assert "Tests of two groups, their p after Holm: Success by McNemar, exact; " in told
    assert "; Cost by Wilcoxon, signed rank" in told
    names = ["feasible", "evaluations", "plan_time_s", "cost"]
    by = ["map", "seed", "trial"]
    wide = trials.pivot_table(index=by, columns="group", dropna=False, values=names)
    found = wide["feasible"].astype(bool)
    cost = wide["cost"].where(found)
    theirs = {}
    for quantity, values in (("evaluations", wide["evaluations"]), ("time", wide["plan_time_s"]),
                             ("cost", cost), ("success", found)):  # fmt: skip
        ps = {}
        for a, b in itertools.combinations((40, 80, 120, 160), 2):
            if quantity == "success":
                only = (found[a] & ~found[b]).sum(), (found[b] & ~found[a]).sum()
                ps[a, b] = stats.binomtest(int(only[0]), int(sum(only))).pvalue
                continue
            pairs = values[[a, b]].dropna()
            ps[a, b] = stats.wilcoxon(pairs[a], pairs[b]).pvalue
            shares = []
            for _, part in values.groupby("map"):
                u = stats.mannwhitneyu(part[a].dropna(), part[b].dropna()).statistic
                shares.append(u / part[a].count() / part[b].count())
            theirs[quantity, a, b] = np.mean(shares)
            assert ours.loc[(quantity, a, b), "pairs"] == len(pairs)
            assert ours.loc[(quantity, a, b), "effect"] == pytest.approx(
                np.exp(np.median(np.log(pairs[a] / pairs[b])))
            )
        running = 0
        for place, pair in enumerate(sorted(ps, key=ps.get)):
            running = max(running, min(1, (6 - place) * ps[pair]))
            row = ours.loc[(quantity, *pair)]
            assert row["p"] == pytest.approx(ps[pair])
            assert row["p_holm"] == pytest.approx(running)
            friedman = stats.friedmanchisquare(*values.dropna().to_numpy(float).T).pvalue
            assert row["apart"] == (running < 0.05 and row["p_of_all"] < 0.05)
            if quantity != "success":
                assert row["p_of_all"] == pytest.approx(friedman)
    for key, share in theirs.items():
        assert ours.loc[key, "a12"] == pytest.approx(share)
    spent = wide["evaluations"].sum() / found.sum()
    groups = pd.read_csv(tmp_path / "groups.csv").set_index(["quantity", "group"])
    for group, expected in spent.items():
        assert groups.loc[("expected_evaluations", group), "value"] == pytest.approx(expected)
    best = found.mean().idxmax()
    assert f"{best} finds a path most often: {100 * found[best].mean():.1f} %" in (
        capsys.readouterr().out.replace(".0 %", " %")
    )


def test_the_best_comes_first_and_says_from_which_it_can_be_told_apart(sweep, tmp_path, capsys):
    compare(sweep, "--by", "planner.population", "--measure", "success", into=tmp_path)
    text = capsys.readouterr().out
    assert re.search(
        r"160 finds .*[\d.]+ points more than 40 \([\d.]+ to [\d.]+; p [<=] 0.\d+\)", text
    )
    assert re.search(r"160 cannot be told apart by 120 pairs of trials from .*120 \(", text)
    assert "4 groups, 480 trials of plan on 2 maps" in text
    assert "paired by map, start, target, instance, seed, trial: 120 pairs" in text
    assert "nan" not in text.lower()


@pytest.mark.drawn
def test_every_file_says_the_same(sweep, tmp_path):
    compare(sweep, "--by", "planner.population", into=tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names <= NAMES
    assert {"comparison.csv", "comparison.md", "comparison.tex", "groups.csv", "maps.csv"} <= names
    for quantity in ("success", "expected_evaluations", "expected_time", "cost"):
        svg = (tmp_path / f"comparison_{quantity}.svg").read_text("utf-8")
        assert "<svg" in svg
        assert (tmp_path / f"comparison_{quantity}.png").read_bytes()[:4] == b"\x89PNG"
    page = (tmp_path / "comparison.md").read_text("utf-8")
    pictures = set(re.findall(r"\]\((\w+\.svg)\)", page))
    assert pictures == {name for name in names if name.endswith(".svg")}
    assert "| 160" in page
    assert r"\toprule" in (tmp_path / "comparison.tex").read_text("utf-8")
    maps = pd.read_csv(tmp_path / "maps.csv")
    assert list(maps["n"]) == [60] * 8
    assert set(maps["map"]) == {"kg18_test1", "kg18_test3"}
    for path in tmp_path.glob("*.csv"):
        assert "nan" not in path.read_text("utf-8").lower()


@pytest.mark.parametrize("by", ["planner.population", "map"])  # in blocks, and not
def test_the_same_runs_give_the_same_bytes_whatever_their_keys(sweep, tmp_path, capsys, by):
    other = shutil.copytree(sweep, tmp_path / "runs")
    for run in [*other.glob("*/*")]:  # the last comes first
        run.rename(run.with_name("".join(f"{15 - int(digit, 16):x}" for digit in run.name)))
    contents = []
    for outputs, name in ((sweep, "one"), (other, "two")):
        compare(outputs, "--by", by, into=tmp_path / name)
        files = sorted((tmp_path / name).iterdir())
        contents.append({path.name: path.read_bytes() for path in files})
    assert contents[0] == contents[1]


def test_without_a_folder_it_writes_beside_the_runs_and_finds_them_again(sweep, tmp_path, capsys):
    outputs = tmp_path / "outputs"
    shutil.copytree(sweep, outputs)
    for _ in range(2):
        compare(outputs, "--by", "planner.population", "--where", "map = 'kg18_test1'")
        text = capsys.readouterr()
        assert "240 trials of plan on kg18_test1" in text.out
        where = r"compare/planner.population_map-kg18_test1_[0-9a-f]{6}/comparison.md"
        assert re.search(where, text.out)
        assert text.err == ""


def test_each_question_has_a_folder_of_its_own(sweep, tmp_path, capsys):
    outputs = tmp_path / "outputs"
    shutil.copytree(sweep, outputs)
    names = "planner.population in (40, 80) and map = 'kg18_test1' and seed = 0 and trials = 60 and"
    conditions = ["seed<5", "seed != 5", "seed < 5", f"{names} seed < 5", f"{names} seed < 6"]
    for condition in conditions:
        compare(outputs, "--by", "planner.population", "--where", condition, "--measure", "success")
    compare(outputs, "--by", "planner.population", "--measure", "success")
    folders = [path.name for path in (outputs / "compare").iterdir()]
    assert len(folders) == len(conditions) + 1
    assert "planner.population" in folders


def test_nothing_of_an_older_comparison_stays(sweep, tmp_path, capsys):
    into = tmp_path / "it"
    compare(sweep, "--by", "planner.population", into=into)
    mine = {"notes.md", "comparison_mine.svg"}
    for name in mine:
        (into / name).write_text("mine")
    plain = tmp_path / "other"
    plain.mkdir()
    (plain / "maps.csv").write_text("mine")
    only = "--where=map = 'kg18_test1'"
    for folder, kept in ((into, mine), (plain, {"maps.csv"})):
        compare(sweep, "--by", "planner.population", only, "--measure", "cost", into=folder)
        compare(sweep, "--by", "planner.population", only, "--measure", "cost",
                into=tmp_path / "fresh")  # fmt: skip
        fresh = {path.name for path in (tmp_path / "fresh").iterdir()}
        assert {path.name for path in folder.iterdir()} == fresh | kept


def test_groups_by_conditions(sweep, tmp_path, capsys):
    wheres = ["planner.population = 40", "planner.population = 160"]
    compare(sweep, *(f"--where={each}" for each in wheres), into=tmp_path)
    ours = pd.read_csv(tmp_path / "comparison.csv")
    assert set(ours["first"]) | set(ours["second"]) == set(wheres)
    assert set(ours["pairs"]) - {120} == {ours.set_index("quantity").loc["cost", "pairs"]}
    assert "planner.population" in capsys.readouterr().out


def test_json_has_sentences_and_numbers(sweep, tmp_path, capsys):
    compare(sweep, "--by", "planner.population", "--measure", "success,cost", "--json",
            into=tmp_path)  # fmt: skip
    found = json.loads(capsys.readouterr().out)
    assert set(found["sentences"]) == {"success", "cost"}
    assert len(found["pairs"]) == 12
    assert found["pairs"][0]["first"] == "40"


def test_methods_have_their_names_and_their_settings_are_what_is_compared(
    try_out, tmp_path, capsys
):
    for preset in ("ga1", "ga3"):
        try_out(tmp_path, preset=preset)
    for preset in ("astar", "dijkstra"):
        try_out(tmp_path, preset=preset, cost=11.5)
    compare(tmp_path, "--by", "preset")
    text = capsys.readouterr().out
    assert "A* and Dijkstra share the first place: 100 %." in text
    assert "No test of A* and Dijkstra: without chance" in text
    assert "A* and Dijkstra: no number, since without chance nothing is evaluated." in text
    assert "differ in" not in text
    assert "paired by map" in text


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"n": 1}, "one pair only, too few for a test"),
        ({"feasible": False}, "no trial succeeded"),
        ({"feasible": True, "cost": 9.0, "evaluations": 40, "plan_time_s": 1.0}, "the same in all"),
    ],
)
def test_statistics_that_cannot_be_had_say_why(try_out, tmp_path, capsys, columns, said):
    for population in (40, 80, 160):
        try_out(tmp_path, {"planner.population": population}, **columns)
    compare(tmp_path, "--by", "planner.population")
    text = capsys.readouterr().out
    assert said in text
    assert "nan" not in text.lower()
    assert " inf" not in text


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--by", "planner.popultion"], "did you mean planner.population?"),
        (["--by", "population"], "did you mean planner.population?"),
        (["--by", "planner.control_points"], "8 runs, all of"),
        (["--by", "seed"], "seed: 8 runs, all of 0, expected two values or more"),
        ([], "expected --by SETTING, or a --where for each of two or more groups"),
        (["--where", "seed = 0"], "1 --where and no --by"),
        (["--by", "map", "--where", "seed = 0", "--where", "seed = 1"], "joined by and"),
        (["--by", "map", "--where", "seed = 3"], "a condition that a run fulfils"),
        (
            ["--by", "map", "--where", "sed = 3"],
            "--where: got sed = 3, expected a column in place of sed; did you mean seed?",
        ),
        (["--by", "map", "--where", "seed ="], "gapath-report: --where: got seed =, expected SQL"),
        (["--where", "seed = 0", "--where", "seed = 3"], "a condition that a run fulfils"),
        (["--where", "seed = 0", "--where", "map = 'kg18_test1'"], "in two groups"),
        (["--by", "map", "--measure", "sucess"], "did you mean success?"),
        (["--by", "map", "--by", "seed"], "--by: got map, seed, expected one name"),
    ],
)
def test_bad_questions_have_one_line_and_write_nothing(sweep, tmp_path, capsys, arguments, said):
    into = tmp_path / "none"
    assert main(["compare", str(sweep), *arguments, "-o", str(into)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert error.startswith("gapath-report: ")
    assert not into.exists()


def test_a_folder_without_runs_or_with_a_file_in_the_way_is_refused(sweep, tmp_path, capsys):
    assert main(["compare", str(tmp_path / "none"), "--by", "map"]) == 2
    (tmp_path / "file").write_text("")
    assert main(["compare", str(sweep), "--by", "map", "-o", str(tmp_path / "file")]) == 2
    text = capsys.readouterr()
    errors = text.err.splitlines()
    assert "no such folder" in errors[0]
    assert "a folder that can be written" in errors[1]
    assert "map: 2 groups, 480 trials" in text.out
    assert "files in" not in text.out
    assert main(["compare", str(sweep), "--by", "map", "--json", "-o", str(tmp_path / "file")]) == 2
    assert json.loads(capsys.readouterr().out)["heading"].startswith("map: 2 groups")


def test_runs_of_two_tasks_have_to_be_chosen_from(try_out, make_drive_run, tmp_path, capsys):
    try_out(tmp_path, map_name="kg18_test1")
    make_drive_run(tmp_path, "drives", "kg18_map1", "kg18")
    assert main(["compare", str(tmp_path), "--by", "map"]) == 2
    assert "task: got drive, plan" in capsys.readouterr().err


def test_drives_are_compared_as_plans_are(make_drive_run, tmp_path, capsys):
    for navigator in ("kg18", "kg18_astar", "replan_astar"):
        make_drive_run(tmp_path, "drives", "kg18_map4", navigator, n=40)
    compare(tmp_path, "--by", "method")
    text = capsys.readouterr().out
    assert "trials of drive on kg18_map4" in text
    assert "is the fastest" in text


def test_many_groups_are_summed_up(try_out, tmp_path, capsys):
    for population in range(10, 260, 10):
        try_out(tmp_path, {"planner.population": population}, n=500)
    compare(tmp_path, "--by", "planner.population", "--measure", "success,cost")
    text = capsys.readouterr().out
    assert re.search(r"is told apart from \d+ others, least of all from \d+ ", text)
    assert re.search(r"from (\d+, ){5}|from .* and \d+ more\.", text)
    assert "and 13 more in the files" in text
    csv = pd.read_csv(next(tmp_path.rglob("comparison.csv")))
    assert list(csv["quantity"].value_counts()) == [300, 300]
    assert csv.loc[csv["quantity"] == "cost", "p"].notna().all()
    assert csv.loc[csv["quantity"] == "cost", "a12"].notna().sum() == 24
