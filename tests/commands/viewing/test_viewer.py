"""``gapath-log view``: in the viewer, without a display, in a browser, two beside each other."""

import re
import signal
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest
from recorders.recordings import QUIET, read

from gapath.commands import log as log_cli
from gapath.commands.viewing.told import told_trial
from gapath.errors import InputError
from gapath.recorders import mcap
from gapath.recorders.rerun.scenes import record_two


@pytest.fixture
def display(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":99")


def call(capsys, *argv):
    code = log_cli.main([str(word) for word in argv])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


def fake(folder, monkeypatch, script):
    viewer = folder / "viewer"
    viewer.write_text(f"#!/bin/sh\n{script}\n")
    viewer.chmod(0o755)
    monkeypatch.setenv("RERUN_CLI_PATH", str(viewer))


@pytest.mark.parametrize("code", [0, 3])
def test_the_viewer_is_started_on_this_machine_only(
    code, plans, capsys, monkeypatch, display, tmp_path
):
    told = tmp_path / "told"
    fake(tmp_path, monkeypatch, f'(echo $1 $2; head -c 3 "$3") > {told}\nexit {code}')
    result, _, err = call(capsys, "view", plans)
    assert told.read_bytes() == b"--bind 127.0.0.1\nRRF"
    assert result == bool(code)
    failed = "the Rerun viewer failed with exit code 3; see it in a browser: gapath-log view --web "
    assert (failed in err) == bool(code)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a display")
def test_without_a_display_a_line_says_what_else_there_is(plans, capsys, monkeypatch, tmp_path):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    fake(tmp_path, monkeypatch, "exit 0")
    assert call(capsys, "view", plans) == (
        1,
        "",
        f"gapath-log: no display; see it in a browser: gapath-log view --web {plans}, "
        f"or make a picture: gapath-log picture {plans}\n",
    )


def listening(ports):
    """Local addresses, as the kernel writes them, where something listens on these ports."""
    found = []
    for family in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{family}").read_text().splitlines()[1:]:
            _, local, _, state, *_ = line.split()
            address, port = local.split(":")
            if state == "0A" and int(port, 16) in ports:
                found.append(address)
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_the_web_viewer_serves_this_machine_and_leaves_nothing(plans):
    # of a shell's background job Control-C would be ignored
    begin = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from gapath.__main__ import log; sys.exit(log())"
    )
    command = [sys.executable, "-c", begin, "view", "--web", str(plans)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=QUIET) as process:
        try:
            address = process.stdout.readline().strip()
            assert "Control-C" in process.stdout.readline()
            assert b"Rerun" in urllib.request.urlopen(address, timeout=20).read()
            ports = {int(port) for port in re.findall(r"127\.0\.0\.1(?::|%3A)(\d+)", address)}
            assert len(ports) == 2
            assert listening(ports) == ["0100007F", "0100007F"]  # 127.0.0.1
        finally:
            process.send_signal(signal.SIGINT)
            try:
                code = process.wait(30)
            finally:
                process.kill()
    assert code == 128 + signal.SIGINT
    until = time.monotonic() + 10
    while listening(ports) and time.monotonic() < until:
        time.sleep(0.05)
    assert listening(ports) == []


def test_a_web_viewer_that_fails_is_told(plans, capsys, monkeypatch, tmp_path):
    fake(tmp_path, monkeypatch, "exit 4")
    code, out, err = call(capsys, "view", "--web", plans)
    assert (code, out) == (1, "")
    assert "failed with exit code 4" in err


def test_two_trials_lie_beside_each_other_on_one_timeline(plans, drives, tmp_path):
    for log, moving in ((plans, "/fitness/best"), (drives, "/map/robot")):
        trial = told_trial(log, 1, mcap.USUAL)
        other = told_trial(log, 0, mcap.USUAL)
        folder = tmp_path / moving.rpartition("/")[2]
        folder.mkdir()
        found = read(record_two((trial, other), folder))
        for side in ("left", "right"):
            alone = read(folder / f"{side}.rrd")
            shown = {
                (entity.removeprefix(f"/{side}"), name): value
                for (entity, name), value in found.items()
                if entity.startswith(f"/{side}/")
            }
            kept = {key: v for key, v in alone.items() if not key[0].startswith("/__")}
            assert shown.keys() == kept.keys()
            assert all(str(shown[key]) == str(kept[key]) for key in kept)  # NaN is not equal
            assert any(entity == moving for entity, _ in shown)


def test_a_plan_and_a_drive_have_no_common_time(plans, drives, tmp_path):
    trials = told_trial(plans, 0, mcap.USUAL), told_trial(drives, 0, mcap.USUAL)
    with pytest.raises(InputError, match=r"timelines: got epoch and step, expected two plans, or"):
        record_two(trials, tmp_path)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["a.mcap"] * 3, "FILE: got 3 files, expected one, or two beside each other"),
        (["no.mcap"], "no.mcap: got no such file"),
        (["a.rrd", "a.mcap"], "a.rrd: got a recording, expected two logs"),
    ],
)
def test_what_cannot_be_shown_is_refused(names, expected, tmp_path, capsys):
    for name in ("a.mcap", "a.rrd"):
        (tmp_path / name).write_bytes(b"")
    code, out, err = call(capsys, "view", *(tmp_path / name for name in names))
    assert (code, out) == (2, "")
    assert expected in err and err.count("\n") == 1
