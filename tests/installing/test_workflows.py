"""The files for GitHub Actions: by its schema, and by doing what the one for users does."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from packages import PROJECT, ROOT

OWN = ROOT / ".github" / "workflows" / "tests.yml"
EXAMPLE = ROOT / "examples" / "github" / "reproduce.yml"
FILES = [OWN, EXAMPLE]
BASH = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c"]
"""As GitHub runs a step where the shell is named."""


def by_schema(file):
    pytest.importorskip("check_jsonschema")
    check = [sys.executable, "-m", "check_jsonschema", "--builtin-schema"]
    return subprocess.run(
        [*check, "vendor.github-workflows", str(file)], capture_output=True, text=True
    )


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_a_workflow_is_one_by_the_schema(file):
    done = by_schema(file)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("right", "wrong"), [("runs-on:", "run-on:"), ("- uses:", "- use:"), ("push:", "pushed:")]
)
def test_what_is_no_workflow_is_noticed(tmp_path, right, wrong):
    text = EXAMPLE.read_text()
    assert right in text
    (tmp_path / "workflow.yml").write_text(text.replace(right, wrong, 1))
    assert by_schema(tmp_path / "workflow.yml").returncode == 1


def test_our_own_tries_every_python_and_only_targets_that_there_are():
    jobs = yaml.safe_load(OWN.read_text())["jobs"]
    least, below = map(int, re.findall(r"3\.(\d+)", PROJECT["requires-python"]))
    pythons = [f"3.{minor}" for minor in range(least, below)]
    for name in ("tests", "package"):
        assert jobs[name]["strategy"]["matrix"]["python"] == pythons
    assert len(jobs["tests"]["strategy"]["matrix"]["system"]) == 3
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    asked = re.findall(r"make ([a-z-]+)", OWN.read_text().partition("\njobs:")[2])
    assert {"test", "check", "bench-quick"} == {*asked} <= {*targets}


def bash(script, folder):
    """Run a script as a step."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        [*BASH, script],
        cwd=folder,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
    )


def steps():
    """The scripts of the example by name, but for its installation."""
    (job,) = yaml.safe_load(EXAMPLE.read_text())["jobs"].values()
    found = {step["name"]: step["run"] for step in job["steps"] if "run" in step}
    assert "requirements.txt" in found.pop("install")
    return found


@pytest.fixture(scope="module")
def committed(tmp_path_factory):
    """A repository with the logs that the page has one make."""
    folder = tmp_path_factory.mktemp("repository")
    page = (ROOT / "docs" / "ci.md").read_text("utf-8")
    (block,) = re.findall(r"^```sh\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    done = bash(block, folder)
    assert done.returncode == 0, done.stderr
    assert len([*folder.glob("logs/*.mcap")]) == 3
    return folder


def test_the_example_does_what_the_page_says(committed, tmp_path):
    shutil.copytree(committed / "logs", tmp_path / "logs")
    do, compare = steps().values()
    assert do in (ROOT / "docs" / "ci.md").read_text("utf-8")
    assert bash(do, tmp_path).returncode == 0
    done = bash(compare, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("reproduced, byte for byte") == 3


def test_an_experiment_that_is_another_one_fails(committed, tmp_path):
    shutil.copytree(committed, tmp_path, dirs_exist_ok=True)  # with the runs as they were
    shutil.rmtree(tmp_path / "outputs" / "known")
    do, compare = steps().values()
    (known,) = [line for line in do.splitlines() if "name=known" in line]
    assert bash(known.replace("planner=ga3", "planner=ga2"), tmp_path).returncode == 0
    done = bash(compare, tmp_path)
    assert done.returncode == 1
    assert "population" not in done.stderr and "< " in done.stdout and "> " in done.stdout


def test_a_log_that_says_something_else_fails(committed, tmp_path):
    shutil.copytree(committed, tmp_path, dirs_exist_ok=True)
    log = tmp_path / "logs" / "known.mcap"
    whole = bytearray(log.read_bytes())
    whole[len(whole) // 2] ^= 1
    log.write_bytes(whole)
    assert bash(steps().popitem()[1], tmp_path).returncode == 2
