"""The command: what it prints, writes and refuses."""

import json
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest
from PIL import Image

from gapath.commands import run as cli
from gapath.store import runfolder

OPEN = "type octile\nheight 3\nwidth 5\nmap\n.....\n.....\n.....\n"
WALLED = "type octile\nheight 3\nwidth 5\nmap\n..@..\n..@..\n..@..\n"
ENDS = ["map.start=[0,0]", "map.target=[4,2]"]


def only(folder):
    (path,) = folder.iterdir()
    return path


def test_one_run_prints_a_summary_and_its_files(gapath, tmp_path):
    code, text, errors = gapath("map=kg18_test1", "planner=ga1", "seed=7")
    assert (code, errors) == (0, "")
    assert "status        found" in text
    assert "(reconstructed)" in text
    folder = only(tmp_path / "out" / "plan")
    files = text.partition("to see it")[0].splitlines()
    listed = [line.strip() for line in files if line.startswith("  ")]
    names = sorted(p.name for p in folder.iterdir() if p.name != runfolder.LOCK)
    assert listed and sorted(line.rpartition("/")[2] for line in listed) == names
    assert "trial-0.rrd" in names and "run.mcap" in names
    row = pq.read_table(folder / "trials.parquet").to_pylist()[0]
    assert (row["map"], row["planner"], row["seed"], row["trial"]) == ("kg18_test1", "ga1", 7, 0)
    manifest = json.loads((folder / "manifest.json").read_bytes())
    assert manifest["command"].startswith("gapath map=kg18_test1 planner=ga1 seed=7")
    files = set(manifest["files"]) - {"gapath.diff"}  # of a checkout that was edited
    assert files == {"config.yaml", "trials.parquet", "run.mcap", "metadata.yaml", "trial-0.rrd"}


def test_a_picture_of_any_name_says_how_it_was_read(gapath, tmp_path):
    pixels = np.array([[0, 255, 0], [0, 0, 0]], dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "büro.png")
    Image.fromarray(255 - pixels).save(tmp_path / "dark.png")
    ends = ["map.start=[0,0]", "map.target=[2,0]", "planner=astar", "recorder=none"]
    for arguments, read_as in (
        (["map=file", f'map.path="{tmp_path}/büro.png"'], "white is an obstacle, black the"),
        (["map=image", f"map.path={tmp_path}/dark.png", "map.invert=true"],
         "black is an obstacle, white the"),
    ):  # fmt: skip
        code, text, errors = gapath(*arguments, *ends)
        assert (code, errors) == (0, "")
        (line,) = [line for line in text.splitlines() if line.startswith("read as")]
        assert read_as in line
    assert "read as" not in gapath("map=kg18_test1", "planner=astar", "recorder=none")[1]


def test_the_same_run_is_skipped_unless_forced_or_broken(gapath, tmp_path):
    run = ["map=kg18_test1", "planner=astar", "recorder=none"]
    code, first, _ = gapath(*run)
    assert code == 0
    table, skipped = gapath(*run)[1].split("\n\n")
    assert table == first.partition("\n\n")[0]  # the result again, from the files
    assert "astar: skipped" in skipped
    assert "astar: skipped" not in gapath(*run, "force=true")[1]
    (only(tmp_path / "out" / "plan") / "trials.parquet").write_bytes(b"broken")
    assert "astar: skipped" not in gapath(*run)[1]
    assert "astar: skipped" in gapath(*run)[1]


def test_a_run_that_another_process_holds_is_left_alone(gapath, tmp_path):
    run = ["map=kg18_test1", "planner=astar", "recorder=none"]
    gapath(*run)
    with runfolder.RunFolder(only(tmp_path / "out" / "plan")).lock():
        code, text, _ = gapath(*run, "force=true")
        assert (code, "another process" in text) == (cli.BUSY, True)


def test_a_walled_in_target_is_a_row_not_a_crash(gapath, tmp_path):
    (tmp_path / "walled.map").write_text(WALLED)
    code, text, _ = gapath("map=file", "map.path=walled.map", *ENDS, "trials=2")
    assert code == 0
    assert "infeasible" in text or "found         0" in text
    folder = only(tmp_path / "out" / "plan")
    rows = pq.read_table(folder / "trials.parquet").to_pylist()
    assert [row["status"] for row in rows] == ["infeasible"] * 2
    assert json.loads((folder / "status.json").read_bytes())["state"] == "infeasible"


def test_the_same_file_with_other_settings_is_another_map(gapath, tmp_path):
    (tmp_path / "open.map").write_text(OPEN)
    run = ["-m", "map=movingai", "map.path=open.map", *ENDS, "recorder=none"]
    assert gapath(*run, "map.free_weight=0.5,0.25")[0] == 0
    rows = [pq.read_table(path).to_pylist()[0] for path in tmp_path.glob("out/plan/*/*.parquet")]
    assert {row["map"] for row in rows} == {"open", "open[free_weight=0.25]"}


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["planner.population=-5"], "planner.population: got -5"),
        (["planner.population=many"], "planner.population: got 'many'"),
        (["planner.population=1e13"], "planner.population"),
        (["planner.control_points=2"], "planner.control_points: got 2"),
        (["planner.mutation_probability=nan"], "planner.mutation_probability: got nan"),
        (["planner.mutation_probability=1.5"], "planner.mutation_probability: got 1.5"),
        (["planner.min_epochs=501"], "planner.min_epochs: got 501"),
        (["planner.max_epochs=0"], "planner.max_epochs: got 0"),
        (["planner.colour=red"], "planner.colour"),
        (
            ["map=file", "map.path=büro.map"],
            """quotes around what is no plain word, 'map.path="büro.map"'""",
        ),
        (["colour"], "colour: got a word alone, expected key=value"),
        (["map.start=[0,0"], "map.start: got [0,0, expected a whole list [x, y]"),
        (["map=image", 'map.path="plan'], "or quoted text"),
        (["map=image", "map.path=plan (2).png"], """'map.path="plan (2).png"'"""),
        (["+planner.colour=red"], "planner.colour: got an unknown name"),
        (["+colour=red"], "colour: got an unknown name"),
        (["planner=ga9"], "planner: got ga9, expected one of "),
        (["planner=null"], "planner: got null, expected one of "),
        (["~planner"], "planner"),
        (["task=fly"], "task: got fly"),
        (["navigator=sedighi"], "navigator: got sedighi with task=plan, expected task=drive"),
        (["task=drive", "planner=ga1"], "planner: got ga1 with task=drive, expected task=plan"),
        (["-m", "drive.step_limit=5,6"], "drive.step_limit: got 5 with task=plan"),
        (["task=drive", "threads=2"], "threads: got 2, expected 1 with task=drive"),
        (["task=drive", "drive.sensor.range=-1"], "drive.sensor.range: got -1"),
        (["task=drive", "drive.sensor.colour=1"], "drive.sensor.colour"),
        (["task=drive", "drive.step_limit=0"], "drive.step_limit: got 0"),
        (["task=drive", "drive.unknown_weight=1"], "drive.unknown_weight: got 1"),
        (["task=drive", "drive.changes.lifetime=0"], "drive.changes.lifetime: got 0"),
        (["task=drive", "drive.known_map=gone.map"], "gone.map"),
        (["task=drive", "navigator=pilot"], "navigator: got pilot"),
        (["task=drive", "navigator.explore_interval=0"], "navigator.explore_interval: got 0"),
        (["task=drive", "navigator.retreat_interval=[3,2]"], "navigator.retreat_interval"),
        (["task=drive", "navigator.explore.population=1"], "navigator.explore.population: got 1"),
        (["task=drive", "navigator.explore.base=ga9"], "ga9"),
        (["planner.kind=os"], "planner.kind: got os"),
        (["map=nowhere"], "map: got nowhere"),
        (["map.instance=-1"], "map.instance: got -1"),
        (["map.map_class=kg18_test9"], "map.map_class: got kg18_test9"),
        (["trials=0"], "trials: got 0"),
        (["trials=many"], "trials: got 'many'"),
        (["threads=0"], "threads: got 0"),
        (["seed=-1"], "seed: got -1"),
        (["name=../x"], "name: got '../x'"),
        (["name=compare"], "name: got compare, expected another"),
        (["corner_cutting=maybe"], "corner_cutting: got maybe"),
        (["recorder.rerun.trials=[3]"], "recorder.rerun.trials: got [3]"),
        (["recorder.rerun.trials=[a]"], "recorder.rerun.trials"),
        (["recorder.mcap.flush_every=9"], "recorder.mcap.flush_every: got an unknown name"),
        (["recorder=tape"], "recorder: got tape"),
        (["map=file"], "map.path: got nothing"),
        (["map=file", "map.path=gone.map"], "gone.map"),
        (["map=file", "map.path=notes.doc"], "map.path: got notes.doc"),
        (["map=file", "map.path=open.map"], "map.start: got null"),
        (["map=file", "map.path=open.map", "map.start=[0,0]"], "map.target: got null"),
        (["map=file", "map.path=open.map", "map.start=[5,0]", "map.target=[0,0]"], "map.start"),
        (["map=file", "map.path=open.map", "map.start=[0]", "map.target=[0,0]"], "map.start"),
        (["map=file", "map.path=walled.map", "map.start=[2,0]", "map.target=[0,0]"], "an obstacle"),
        (["map=kg18_test1", "planner=sedighi"], "map: got 100 x 50 fields, expected a square grid"),
        (["map=file", "map.path=short.map", *ENDS], "short.map"),
        (["map=file", "map.path=binary.map", *ENDS], "binary.map"),
        (["map=file", "map.path=deep.png", *ENDS], "deep.png"),
        (["map=file", "map.path=cut.png", *ENDS], "cut.png"),
        (["map=file", "map.path=huge.png", *ENDS], "huge.png"),
        (["map=file", "map.path=dangling.yaml", *ENDS], "dangling.yaml"),
        (["map=file", "map.path=escaping.yaml", *ENDS], "escaping.yaml"),
        (["map=rosmap", "map.path=flat.yaml", *ENDS], "resolution"),
        (["map=rosmap", "map.path=flat.yaml", "map.unknown=maybe", *ENDS], "map.unknown"),
        (["-m", "planner=ga1,ga2", "planner.population=20,2"], "planner.population: got 2"),
        (["-m", "planner=ga1,ga9"], "planner: got ga9"),
        (["-m", "map=kg18_test1,file"], "map.path"),
    ],
)
def test_bad_input_is_one_clear_error(gapath, tmp_path, arguments, named):
    files = {"open.map": OPEN, "walled.map": WALLED, "short.map": OPEN[:-6], "notes.doc": "hello"}
    ros = "image: {}\nresolution: {}\norigin: [0, 0, 0]\nnegate: 0\n"
    ros += "occupied_thresh: 0.65\nfree_thresh: 0.25\n"
    files |= {"dangling.yaml": ros.format("gone.pgm", 0.05)}
    files |= {"escaping.yaml": ros.format("../secret.pgm", 0.05)}
    files |= {"flat.yaml": ros.format("grey.png", 0)}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "binary.map").write_bytes(bytes(range(256)))
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "grey.png")
    Image.fromarray(np.zeros((4, 4), np.uint16)).save(tmp_path / "deep.png")
    whole = (tmp_path / "grey.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(whole[:50])
    (tmp_path / "huge.png").write_bytes(whole[:16] + b"\x7f\xff\xff\xff" * 2 + whole[24:])

    code, text, errors = gapath(*arguments)
    assert code == cli.BAD_INPUT
    assert named in errors
    assert "Traceback" not in errors
    assert errors.startswith("gapath: ")
    assert errors.count("\n") == 1
    assert text == ""
    assert not (tmp_path / "out").exists()


def test_values_that_differ_from_the_yaml_are_in_the_name(gapath):
    plain = ["map=kg18_test1", "recorder=none"]
    for extra, name in [
        (["planner=ga1", "planner.population=40"], "ga1\n"),
        (["planner=ga1", "++planner.population=8"], "ga1[population=8]\n"),
        (["planner=astar", "corner_cutting=forbid"], "astar[corner_cutting=forbid]\n"),
        (["planner=ga1", "seed=3"], "ga1\n"),
    ]:
        assert f"planner       {name}" in gapath(*plain, *extra)[1]


def test_a_scenario_that_was_edited_is_another_run(gapath, tmp_path):
    (tmp_path / "open.map").write_text(OPEN)
    run = ["map=movingai", "map.path=open.map", "map.scenario=s.scen", "recorder=none"]
    for target in ("4\t2", "4\t1"):
        text = f"version 1\n0\topen.map\t5\t3\t0\t0\t{target}\t4\n"
        (tmp_path / "s.scen").write_text(text)
        assert ": skipped" not in gapath(*run)[1]
    assert ": skipped" in gapath(*run)[1]


def test_sweeps_may_name_maps_by_pattern(gapath):
    code, text, _ = gapath("-m", "map=glob(kg18_test*)", "planner=astar", "recorder=none")
    assert code == 0
    assert text.count("1 of 1 found") == 4


@pytest.mark.parametrize("flags", [[], ["-m"]])
@pytest.mark.parametrize("output", ["taken", "/proc/none", "", "null"])
def test_an_output_that_cannot_be_written_is_refused(gapath, tmp_path, output, flags):
    (tmp_path / "taken").write_text("mine")
    code, _, errors = gapath(*flags, "map=kg18_test1", f"output={output}", output=None)
    assert code == cli.BAD_INPUT
    assert errors.startswith("gapath: output: got ")
    assert "Traceback" not in errors
    assert (tmp_path / "taken").read_text() == "mine"


def test_a_configuration_reads_well(gapath):
    code, text, _ = gapath("--cfg", "job", output=None)
    assert code == 0
    assert "kg18_test3" in text


def test_the_installed_command_works_from_anywhere(tmp_path):
    command = [sys.executable, "-c", "from gapath.commands.run import main; main()", "--cfg", "job"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "bspline_ga" in done.stdout
    assert not list(tmp_path.iterdir())


def test_a_summary_into_a_closed_pipe_is_no_error(tmp_path):
    settings = ["map=kg18_test1", "planner=astar", "recorder=none", f"output={tmp_path}"]
    command = [sys.executable, "-c", "from gapath.commands.run import main; main()", *settings]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0
    assert only(tmp_path / "plan").is_dir()


@pytest.mark.parametrize("recorder", ["mcap", "[mcap,rerun]", "rerun", "none"])
def test_a_summary_says_how_to_see_the_run(gapath, tmp_path, recorder):
    code, out, _ = gapath("map=kg18_test1", "planner=astar", f"recorder={recorder}")
    assert code == 0
    (folder,) = (tmp_path / "out").glob("*/*")
    shown = {"none": None, "rerun": folder / "trial-0.rrd"}.get(recorder, folder)
    ends = f"to see it\n  gapath-log view {shown}\n" if shown else "status.json\n"
    assert out.endswith(ends)


def test_where_runs_are_looked_for_a_key_says_how_to_see_it(gapath, tmp_path):
    code, out, _ = gapath("map=kg18_test1", "planner=astar", "recorder=mcap", output=None)
    (folder,) = (tmp_path / "outputs").glob("*/*")
    assert code == 0
    assert out.endswith(f"to see it\n  gapath-log view {folder.name}\n")
