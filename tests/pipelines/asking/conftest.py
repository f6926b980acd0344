"""Runs to ask about, and the command that is asked."""

import json
import shutil

import pandas as pd
import pytest
import yaml

from gapath.pipelines.report import cli

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


@pytest.fixture(scope="session")
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
