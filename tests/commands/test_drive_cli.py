"""What ``gapath task=drive`` prints, and that its log alone is enough to do it again."""

from pathlib import Path

import pytest

from gapath.commands import log as log_cli
from gapath.events import NEVER_LEFT, DriveStarted
from gapath.recorders import mcap
from gapath.tasks.drive import usual_limit

HEAD = "type octile\nheight 3\nwidth 7\nmap\n"
OPEN = HEAD + ".......\n" * 3
SHUT_IN = HEAD + ".@.....\n@@.....\n.......\n"
SHUT_OUT = HEAD + ".....@.\n.....@@\n.......\n"
DRIVE = ["task=drive", "navigator=replan_astar", "map=file", "map.path=room.map",
         "map.start=[0,0]", "map.target=[6,0]"]  # fmt: skip


def drive(*words):
    """A drive, with some words in the place of its own ones."""
    return [*{word.partition("=")[0]: word for word in (*DRIVE, *words)}.values()]


def lines(text):
    """The table of a summary: label -> value."""
    table = text.partition("\n\n")[0].splitlines()
    return {line[:14].strip(): line[14:] for line in table}


ENDS = {
    "reached": (OPEN, [], "reached", "6 steps possible"),
    "returned": (SHUT_OUT, [], "returned", "no way to the target"),
    "never left": (SHUT_IN, [], f"returned ({NEVER_LEFT})", "no way to the target"),
    "overran": (OPEN, ["drive.step_limit=3"], "overran (drive.step_limit: 3)", "6 steps possible"),
}


@pytest.mark.parametrize(("room", "more", "ending", "shortest"), ENDS.values(), ids=ENDS)
def test_every_line_says_how_drives_ended_and_nothing_that_does_not_exist(
    room, more, ending, shortest, gapath, tmp_path, capfd
):
    (tmp_path / "room.map").write_text(room)
    run = [*DRIVE, *more, "recorder=mcap"]
    code, text, errors = gapath(*run)
    assert (code, errors) == (0, "")
    table = lines(text)
    assert (table["outcome"], table["shortest"]) == (ending, shortest)
    assert ("ratio" in table) == (ending == "reached")
    outcome, _, remark = ending.partition(" (")
    (log,) = tmp_path.glob(f"out/drive/*/{mcap.FILE}")
    assert log_cli.main(["info", str(log)]) == 0
    told = outcome if outcome == "overran" else ending
    assert f"1 of 1: 1 {told}\n" in capfd.readouterr().out

    sweep = gapath("-m", *run, "seed=1")[1]
    assert f": {ending}, {table['steps']} steps, " in sweep
    both = lines(gapath(*run, "seed=2", "trials=2")[1])
    remark = remark and f" ({remark}".replace("(never", "(2 never")
    assert both[outcome] == f"2 (100.0 %){remark}"
    short = gapath("-m", *run, "seed=3", "trials=2")[1]
    assert f": 2 drives: 2 {outcome}{remark}; median " in short
    assert "nan" not in text + sweep + str(both) + short


def test_a_drive_that_begins_at_its_target_has_no_ratio(gapath, tmp_path):
    (tmp_path / "room.map").write_text(OPEN)
    code, text, _ = gapath(*drive("map.target=[0,0]"), "recorder=none")
    assert code == 0
    assert lines(text)["outcome"] == "reached"
    assert "ratio" not in lines(text) and "nan" not in text


@pytest.mark.parametrize("then", [Path.unlink, lambda path: path.write_text(OPEN)])
def test_a_log_is_done_again_without_the_files_that_its_run_read(
    then, gapath, tmp_path, capfd, monkeypatch
):
    (tmp_path / "room.map").write_text(SHUT_OUT)
    known = tmp_path / "known.map"
    known.write_text(SHUT_OUT.replace("@@", ".@"))
    assert gapath(*DRIVE, "drive.known_map=known.map", "recorder=mcap")[0] == 0
    (log,) = tmp_path.glob(f"out/drive/*/{mcap.FILE}")
    then(known)
    (tmp_path / "room.map").unlink()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert log_cli.main(["verify", str(log)]) == 0
    told = capfd.readouterr().out
    assert "reproduced" in told and "; drive.known_map is what the log has of known.map" in told
    run = next(mcap.read_events(log))
    assert run.problem.maps["drive.known_map"].obstacles.sum() == 2


def test_a_drive_that_overran_says_where_its_limit_comes_from(gapath, tmp_path, monkeypatch):
    monkeypatch.setattr("gapath.tasks.drive.LEAST_STEPS", 5)
    (tmp_path / "room.map").write_text(f"type octile\nheight 1\nwidth 15\nmap\n{'.' * 15}\n")
    text = gapath(*drive("map.target=[14,0]"), "recorder=none")[1]
    assert lines(text)["outcome"].startswith("overran (drive.step_limit: 6, two steps for every")


def test_the_step_limit_goes_with_the_map_unless_it_is_set(gapath, tmp_path):
    assert [usual_limit(size) for size in (1, 100 * 50, 400 * 300, 8192**2)] == [
        2000, 2000, 48_000, 10**6
    ]  # fmt: skip
    (tmp_path / "room.map").write_text(
        "type octile\nheight 80\nwidth 100\nmap\n" + f"{'.' * 100}\n" * 80
    )
    for more, limit in [([], 3200), (["drive.step_limit=7"], 7)]:
        assert gapath(*DRIVE, *more, f"name=limit{limit}", "recorder=mcap")[0] == 0
        (log,) = tmp_path.glob(f"out/limit{limit}/*/{mcap.FILE}")
        (told,) = [event for event in mcap.read_events(log) if isinstance(event, DriveStarted)]
        assert (told.step_limit, told.sensor_range, told.unknown_weight) == (limit, 4, 0.5)


def test_a_map_that_a_navigator_does_not_take_is_refused_before_the_first_job(gapath, tmp_path):
    rows = "." * 1025 + "\n"
    (tmp_path / "room.map").write_text(f"type octile\nheight 1024\nwidth 1025\nmap\n{rows * 1024}")
    code, text, errors = gapath("-m", *drive("navigator=replan_astar,dstar_lite"))
    assert (code, text) == (2, "")
    assert "map: got 1025 x 1024 fields, expected at most 1048576" in errors
    assert not (tmp_path / "out").exists()


def test_a_run_folder_or_its_manifest_stands_for_its_log(gapath, tmp_path, capfd):
    (tmp_path / "room.map").write_text(OPEN)
    assert gapath(*DRIVE, "recorder=mcap")[0] == 0
    (log,) = tmp_path.glob(f"out/drive/*/{mcap.FILE}")
    folder, manifest = log.parent, log.with_name("manifest.json")

    def call(*argv):
        return log_cli.main([str(word) for word in argv]), *capfd.readouterr()

    code, out, _ = call("verify", folder, manifest, log)
    assert code == 0
    lines = [line.partition(": reproduced")[0] for line in out.splitlines()]
    assert lines == [str(folder), str(manifest), str(log)]
    (folder.parent / "multirun.yaml").write_text("hydra: {}\n")  # as a sweep leaves it
    assert call("verify", *folder.parent.iterdir())[::2] == (0, "")
    for experiment in ("drive", folder.parent):
        code, _, err = call("info", experiment, "--outputs", folder.parent.parent)
        right = f"an experiment, expected one of its runs, a folder in {folder.parent}"
        assert (code, err) == (2, f"gapath-log: {experiment}: got {right}\n")
    assert f"file:         {log}, " in call("info", folder)[1]
    assert call("rerun", manifest)[1] == f"{folder / 'trial-0.rrd'}\n"

    part = folder / "run.part" / "run.mcap.part"
    part.parent.mkdir()
    log.rename(part)
    (folder / "status.json").write_text('{"state": "interrupted"}')
    for command in ("info", "verify", "rerun", "view"):
        code, out, err = call(command, folder)
        assert (code, out) == (2, "")
        assert f"{folder}: got interrupted" in err and f"gapath-log salvage {part}" in err

    assert gapath(*DRIVE, "recorder=none", "name=bare")[0] == 0
    (bare,) = (path for path in tmp_path.glob("out/bare/*") if path.is_dir())
    assert "got a run without a log, expected one with recorder=mcap" in call("verify", bare)[2]


@pytest.mark.parametrize("limit", ["MAX_CHUNK", "MAX_LOG"])
def test_a_map_too_large_for_a_log_is_one_line(limit, gapath, monkeypatch, tmp_path):
    known = tmp_path / "known.map"
    rows = "\n".join("." * 40 for _ in range(30))
    known.write_text(f"type octile\nheight 30\nwidth 40\nmap\n{rows}\n")
    monkeypatch.setattr(f"gapath.recorders.mcap.log.{limit}", 5000)
    code, _, err = gapath(
        "task=drive", "map=field_rooms", "map.width=40", "map.height=30", "recorder=mcap",
        f"drive.known_map={known}", "navigator=replan_astar",
    )  # fmt: skip
    assert code == 2 and err.count("\n") == 1
    assert "recorder.mcap: got " in err and "a smaller map, or fewer epochs or trials" in err
