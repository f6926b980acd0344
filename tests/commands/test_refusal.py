"""A command line that is wrong: one line names the setting, the value and what would be right."""

import re
from importlib import import_module
from importlib.metadata import version

import pytest

MAPS = r"one of \d+ names, see gapath help"
ROOT = "choice, corner_cutting, device, drive, experiment, force, kernels, map, name, navigator, "
ROOT += (
    "output, planner, provenance, recorder, scenario, search, seed, shard, shards, task, threads, "
)
ROOT += "trials"

CASES = {
    # A name that there is not.
    "experiment=unseen/movingai/arenaa": r"experiment/unseen/movingai: got arenaa, .* arena\?",
    "planner=ga33": f"planner: got ga33, expected {MAPS}; did you mean ga3\\?",
    "map=kg18_tset3": rf"map: got kg18_tset3, expected {MAPS}; did you mean kg18_test\d\?",
    "map=": f"map: got '', expected {MAPS}",
    "recorder=[mcap,reruns]": "recorder: got reruns, expected one of mcap, none, rerun; did you "
    r"mean rerun\?",
    "experiment=tabl1": r"experiment: got tabl1, expected one of .*, tune; did you mean table1\?",
    "task=drvie": r"task: got drvie, expected one of drive, plan, scenario; did you mean drive\?",
    "task=": "task: got '', expected one of drive, plan, scenario",
    "corner_cutting=forbidd": r"corner_cutting: got forbidd, expected one of .*mean forbid\?",
    "planner.kind=grid_serch": r"planner\.kind: got grid_serch, .*; did you mean grid_search\?",
    "task=drive navigator.explore.base=ga33": rf"navigator.explore.base: got ga33, "
    rf"expected {MAPS}; .* ga3\?",
    # A setting that there is not.
    "planner.populaton=3": r"planner\.populaton: got an unknown name, expected one of kind, "
    r"population, .*; did you mean population\?",
    "map=file map.pth=a.map": r"map\.pth: got an unknown name, expected one of .* mean path\?",
    "-m map=field_rooms,field_maze map.width=90": r"map\.width: got an unknown name with this map, "
    r"expected map=field_clutter or .*, which has it; .* over several of these, \+\+map\.width=90",
    "+foo=1": "foo: got an unknown name, expected one of task, .*, drive, navigator, planner, "
    "scenario, search",
    "plannr=ga1": rf"plannr: got an unknown name, expected one of {ROOT}; did you mean planner\?",
    "experimnt=table1": rf"experimnt: got an unknown name, .* {ROOT}; did you mean experiment\?",
    "~foo": f"foo: got an unknown name, expected one of {ROOT}",
    "trials.x=3": r"trials\.x: got an unknown name, expected trials, which is one value",
    "hydra.foo=1": r"hydra\.foo: got an unknown name, expected one of .*",
    "-m planer.x=1 seed=1,2": r"planer: got an unknown name, .*; did you mean planner\?",
    # No setting at all.
    "table1": r"table1: got a word alone, expected key=value; did you mean experiment=table1\?",
    "sedigi": r"sedigi: got a word alone, expected key=value; did you mean \w+=sedighi\?",
    "outputs": "outputs: got a word alone, expected key=value",
    "=3": "'=3': got no name, expected key=value",
    "--foo": "command line: got unrecognized arguments: --foo, expected .*",
    "--cfg everything": "command line: got argument --cfg/-c: invalid choice: .*",
    # A choice or a value that cannot be.
    "planner=null": f"planner: got null, expected {MAPS}",
    "-m planner=null": f"planner: got null, expected {MAPS}",
    "planner=grid_search": rf"planner: got grid_search, expected {MAPS}.*; the kind grid_search is "
    r"that of astar, .*",
    "planner=3": f"planner: got 3, expected {MAPS}",
    "planner=[ga1,ga2]": rf"planner: got \[ga1,ga2\], expected {MAPS}",
    "planner={populaton:3}": r"planner\.populaton: got an unknown name, .* mean population\?",
    "planner={population:3}": r"planner\.population: got 3, expected .*",
    "planner=ga1,ga2": "planner: got ga1,ga2, expected one value; gapath -m runs a sweep over .*",
    "+planner=ga1": r"planner: got \+planner=ga1, expected planner=ga1",
    "+seed=1": r"seed: got \+seed=1, expected seed=1",
    "choice=range_1": r"choice: got range_1, expected \+choice=range_1",
    "map.start=[1": r"map\.start: got \[1, expected a whole list \[x, y\], .*",
    "-m planner=ga1,": "planner: got ga1,, expected quotes around what is no plain word, .*",
    "trials=": "trials: got '', expected a value of type int",
    "~planner": "planner: got nothing, expected settings, which task=plan uses",
    "output=${foo}": "output: got Interpolation key 'foo' not found, expected .*",
    "output=": "output: got '', expected a folder",
    "planner=../planner/ga3": r"planner: got \.\./planner/ga3, expected the name of a YAML, .*",
    "planner=ga3.yaml": r"planner: got ga3\.yaml, expected the name of a YAML, without .*",
    "recorder=[mcap,../recorder/none]": r"recorder: got \.\./recorder/none, expected the name .*",
    "trials=1 trials=2": "trials: got 1 and 2, expected one value",
    "force=2": "force: got 2, expected true or false",
    "task=drive drive=null": "drive: got nothing, expected settings, which task=drive uses",
    "task=drive drive.known_map=none.map": r"drive\.known_map, none\.map: got no such file, .*",
    "map=image map.path=a.png map.start={a:1}": r"map\.start: got \{'a': 1\}, expected a value of "
    r"type list\[int\] \| None",
    f"seed={5000 * '9'}": "seed: got a number of 5000 digits, expected at most 400",
    f"-m seed=1,{5000 * '9'}": "seed: got a number of 5000 digits, expected at most 400",
    "seed=-1": r"seed: got -1, expected an integer in \[0, 2\^64\)",
    "trials=0": r"trials: got 0, expected an integer from 1 to 10\^6",
    "threads=257": "threads: got 257, expected an integer from 1 to 256",
    # What the task does not use.
    "task=plan navigator=kg18": "navigator: got kg18 with task=plan, expected task=drive, to which "
    "the group navigator belongs",
    "task=drive planner.population=3": r"planner\.population: got 3 with task=drive, expected "
    "task=plan or task=scenario, to which the group planner belongs",
    # Jobs of one sweep that are one run.
    "-m threads=1,2": "sweep: got threads=1 and threads=2, which are one run, expected jobs that "
    "differ in more than output, force, threads, kernels, device, provenance",
}


@pytest.mark.parametrize("line", CASES)
def test_a_wrong_command_line_is_one_line(gapath, tmp_path, line):
    code, text, errors = gapath(*line.split(), output=None)
    assert (code, text) == (2, "")
    assert re.fullmatch(f"gapath: {CASES[line]}\n", errors), errors
    assert not list(tmp_path.iterdir())


def test_the_version_is_gapaths(gapath):
    assert gapath("--version") == (0, f"gapath {version('gapath')}\n", "")


@pytest.mark.parametrize("name", ["log", "genotype", "report"])
def test_the_version_of_the_other_commands_is_gapaths(capsys, name):
    module = "gapath.pipelines.report.cli" if name == "report" else f"gapath.commands.{name}"
    with pytest.raises(SystemExit) as stop:
        import_module(module).main(["--version"])
    assert not stop.value.code
    assert capsys.readouterr().out == f"gapath-{name} {version('gapath')}\n"


def test_a_path_is_where_it_was_typed_also_where_hydra_changes_the_folder(gapath, tmp_path):
    (tmp_path / "a.map").write_text("type octile\nheight 3\nwidth 5\nmap\n" + ".....\n" * 3)
    run = ["map=file", "map.path=a.map", "map.start=[0,0]", "map.target=[4,2]", "planner=astar",
           "recorder=none"]  # fmt: skip
    drive = ["task=drive", *run[:4], "drive.known_map=a.map", "recorder=none"]
    for job in (["hydra.run.dir=elsewhere", *run], ["-m", "seed=1,2", *run], drive):
        code, _, errors = gapath(*job, "hydra.job.chdir=true", "output=mine", output=None)
        assert (code, errors) == (0, "")
    folders = [path.parent for path in tmp_path.rglob("manifest.json")]
    assert len(folders) == 4
    assert {path.parents[1] for path in folders} == {tmp_path / "mine"}
