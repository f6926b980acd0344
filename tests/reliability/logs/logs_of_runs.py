"""Small runs of every kind, and what is said of their logs."""

import hashlib

import pyarrow.parquet as pq
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from gapath.commands import log as log_cli
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


def log_of(name, folder, *more):
    """Do a run; give its log."""
    words = [*SMALL, *(RUNS | PAPERS)[name], "recorder=mcap", f"output={folder}", *more]
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
    return code, printed.out, printed.err
