"""Small runs of every kind, and what is said of their logs."""

import hashlib
import re
import struct

import numpy as np
import pyarrow.parquet as pq
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from gapath.commands import log as log_cli
from gapath.recorders.mcap import salvage
from gapath.running.config import conf_folder, make_run
from gapath.running.experiment import execute

SMALL = ["map=field_rooms", "map.width=40", "map.height=30"]
RUNS = {
    "plan": ["planner=ga1", "planner.population=6", "planner.max_epochs=3", "trials=2"],
    "memetic": ["planner=memetic_first", "trials=2"],
    "visibility": ["planner=visibility_astar", "planner.robot_radius=1"],
    "scenario": ["task=scenario", "planner=astar", "scenario.drawn=3"],
    "drive": ["task=drive", "navigator=replan_astar", "drive.step_limit=30"],
}
PAPERS = {
    "kg18 drive": ["task=drive", "navigator=kg18", "drive.step_limit=3"],
    "s04": ["planner=sedighi", "planner.pad_to_square=true", "planner.max_epochs=5"],
    "m22": ["planner=visibility_ga", "planner.robot_radius=1", "planner.max_epochs=3"],
}
"""More, for harnesses that are not tried on every log."""

NOT_COMPARED = ("plan_time", "stage_times", "compute_time", "recorder.")

OF_FILES = {
    "image": ["map=image", "map.path={folder}/floor.pgm", "map.start=[0,0]", "map.target=[19,9]",
              "planner=ga1", "planner.population=6", "planner.max_epochs=3"],
    "known": ["task=drive", "map=image", "map.path={folder}/floor.pgm", "map.start=[0,0]",
              "map.target=[19,9]", "navigator=replan_astar", "drive.step_limit=30",
              "drive.known_map={folder}/known.map"],
    "listed": ["task=scenario", "map=movingai", "map.path={folder}/known.map", "planner=astar",
               "map.scenario={folder}/known.map.scen", "corner_cutting=forbid"],
}  # fmt: skip
"""Of maps, known maps and scenarios of somebody's own."""

BROKEN = ("saved", "interrupted")
"""What is whole of a log with a damaged chunk, and of one that was cut off."""


def write_files(folder):
    """Make a picture, a map of the same size, and problems on that."""
    floor = np.full((10, 20), 128, dtype=np.uint8)
    floor[2:8, 9] = 255
    (folder / "floor.pgm").write_bytes(b"P5 20 10 255\n" + floor.tobytes())
    rows = "\n".join("." * 9 + "@" + "." * 10 if 1 < y < 6 else "." * 20 for y in range(10))
    (folder / "known.map").write_text(f"type octile\nheight 10\nwidth 20\nmap\n{rows}\n")
    problems = [(0, 0, 19, 9, 21.0), (3, 9, 12, 1, 12.5)]
    lines = [f"0\tknown.map\t20\t10\t{x}\t{y}\t{u}\t{v}\t{d}" for x, y, u, v, d in problems]
    (folder / "known.map.scen").write_text("version 1\n" + "\n".join(lines) + "\n")


def chunks_of(data):
    """Find where the chunks of a log begin."""
    marks = re.finditer(re.escape(struct.pack("<I", 4) + b"zstd"), data)
    return [at.start() - 37 for at in marks if data[at.start() - 37] == 6]


def broken_log_of(name, folder):
    """Do a run, break its log, and save what is whole."""
    log = log_of("plan", folder, "trials=6")
    data = bytearray(log.read_bytes())
    places = chunks_of(data)
    middle = places[len(places) // 2]
    if name == "saved":
        data[middle + 60] ^= 1
    broken, saved = folder / "broken.mcap", folder / "saved.mcap"
    broken.write_bytes(data if name == "saved" else data[: middle + 9])
    salvage(broken, saved)
    return saved


def log_of(name, folder, *more):
    """Do a run; give its log."""
    if name in BROKEN:
        return broken_log_of(name, folder)
    if name in OF_FILES:
        write_files(folder)
        words = [word.format(folder=folder) for word in OF_FILES[name]]
    else:
        words = [*SMALL, *(RUNS | PAPERS)[name]]
    words += ["recorder=mcap", f"output={folder}", *more]
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        config = compose("config", overrides=words, return_hydra_config=True)
    choices = dict(config.hydra.runtime.choices)
    OmegaConf.set_struct(config, False)
    del config["hydra"]
    return execute(make_run(config, choices), "", progress=False).folder / "run.mcap"


def hashes(log):
    """Hashes of a log as it is, and of its run's rows but for their times."""
    table = pq.read_table(log.parent / "trials.parquet")
    rows = [
        {key: value for key, value in row.items() if not key.startswith(NOT_COMPARED)}
        for row in table.to_pylist()
    ]
    return [hashlib.sha256(part).hexdigest() for part in (log.read_bytes(), repr(rows).encode())]


def told(capsys, *argv):
    """Run the command: its exit code, what it says, and its error output, a line at most."""
    code = log_cli.main([str(word) for word in argv])
    printed = capsys.readouterr()
    assert printed.err.count("\n") <= 1
    assert not any(f"{word}: {word}" in printed.err for word in argv)  # named once
    return code, printed.out, printed.err
