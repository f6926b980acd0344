"""Make Rerun recordings, and read them back."""

import os
import subprocess
import sys

from rerun.chunk import RrdReader

from gapath.recorders.rerun import Recorder

QUIET = {**os.environ, "CI": "1"}  # Rerun's command sends no usage data where CI is set


def record(folder, events, trials=(0,)):
    recorder = Recorder(trials=list(trials))
    recorder.open(str(folder))
    for event in events:
        recorder.record(event)
    return recorder.close()


def read(path):
    """Read a recording back: {(entity, component): value, or [(time, value), ...]}."""
    found = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        assert set(batch.schema.names) & {"log_time", "log_tick"} == set()
        columns = batch.to_pydict()
        times = columns.pop("epoch", columns.pop("step", None))
        for name, values in columns.items():
            if name != "rerun.controls.RowId":
                key = (chunk.entity_path, name)
                if times is None:
                    found[key] = values[0]
                else:
                    found.setdefault(key, []).extend(zip(times, values, strict=True))
    return found


def centres(fields):
    return [[x + 0.5, y + 0.5] for x, y in fields]


def rerun_command(*arguments):
    # `python -m rerun_cli` drops the exit code.
    code = "import sys; from rerun_cli.__main__ import main; sys.exit(main())"
    command = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env=QUIET, timeout=60)
