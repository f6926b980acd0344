"""Crates before the validator of their profile and a reader of such crates.

Both need older versions of libraries than gapath does, so they have an environment of their own,
which the long form makes: a minute. What the profile asks for is also in tests/crates.
"""

import json
import shutil
import subprocess
import sys
import time
import venv
from pathlib import Path

import pytest
from scale import rounds

TOOLS = ("roc-validator==0.13.0", "runcrate==0.6.2", "rocrate==0.16.0")

NO_ADDRESS = {
    "RECOMMENDED process-run-crate-0.5_3.2: The Application SHOULD have a url",
    "RECOMMENDED process-run-crate-0.5_5.1: The SoftwareApplication id SHOULD be an absolute URI",
}
"""What gapath cannot say of itself as long as it is nowhere on the web."""

CREDITS = (
    "--author", "Ada Lovelace", "--organization", "Engines", "https://engines.example",
    "--licence", "https://creativecommons.org/licenses/by/4.0/",
)  # fmt: skip

EXPERIMENTS = {
    "plan": ("planner=ga3,astar", "map=kg18_test3", "trials=3"),
    "drive": ("task=drive", "navigator=replan_astar", "map=kg18_map1", "trials=2"),
    "scenario": ("task=scenario", "planner=astar", "map=kg18_map2", "scenario.drawn=3"),
}


@pytest.fixture(scope="module")
def tools(tmp_path_factory):
    if not rounds(False, True):
        pytest.skip("the long form makes an environment for the validator")
    place = tmp_path_factory.mktemp("tools")
    venv.create(place, with_pip=True)
    python = place / "bin" / "python"
    begun = time.monotonic()
    subprocess.run([python, "-m", "pip", "install", "--quiet", *TOOLS], check=True)
    print(f"environment of {', '.join(TOOLS)}: {time.monotonic() - begun:.0f} s")
    return python


def answer(tools, crate):
    script = Path(__file__).parents[2] / "crates" / "outside.py"
    done = subprocess.run([tools, script, crate], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def log_command(*arguments):
    command = [sys.executable, "-m", "gapath.commands.log", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def contents(places):
    return {each: each.read_bytes() for each in places if each.is_file()}


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_the_profiles_validator_and_a_reader_take_a_crate(name, tools, gapath, tmp_path):
    code, _, err = gapath("-m", f"name={name}", "recorder=mcap", *EXPERIMENTS[name])
    assert code == 0, err
    begun = time.monotonic()
    log_command("crate", f"out/{name}", "crate", *CREDITS)
    packed = time.monotonic() - begun
    shutil.move("crate", "moved")
    shutil.rmtree("out")
    places = [Path("moved"), *Path("moved").rglob("*")]
    before = contents(places)
    for each in places:
        each.chmod(0o555 if each.is_dir() else 0o444)
    try:
        found, repeated = answer(tools, tmp_path / "moved"), log_command("repeat", "moved")
    finally:
        for each in places:
            each.chmod(0o755 if each.is_dir() else 0o644)
    assert contents([Path("moved"), *Path("moved").rglob("*")]) == before  # for root, too
    required, recommended = found["REQUIRED"], found["RECOMMENDED"]
    assert required["issues"] == []
    assert set(recommended["issues"]) <= NO_ADDRESS
    runs = [line.split(":")[0] for line in repeated.splitlines()[:-1]]
    assert [f"action: #{run}" in found["runcrate"] for run in runs] == [True] * len(runs)
    assert "moved: reproduced" in repeated
    size = sum(each.stat().st_size for each in places if each.is_file())
    print(
        f"{name}: {len(runs)} runs, {size} bytes, packed in {packed:.1f} s; of "
        f"{required['checks']} required checks none failed, of {recommended['checks']} with those "
        f"recommended {len(recommended['issues'])}; runcrate has every action; moved, read-only: "
        "reproduced"
    )


def test_the_validator_finds_what_is_wrong(tools, gapath, tmp_path):
    code, _, err = gapath("name=plan", "recorder=mcap", "planner=astar", "map=kg18_test3")
    assert code == 0, err
    log_command("crate", "out/plan", "crate")
    description = Path("crate/ro-crate-metadata.json")
    content = json.loads(description.read_bytes())
    for entity in content["@graph"]:
        entity.pop("instrument", None)
    description.write_text(json.dumps(content))
    (issue,) = answer(tools, tmp_path / "crate")["REQUIRED"]["issues"]
    assert "MUST have an instrument" in issue
