"""Long use: memory depends neither on how many trials a run has, nor on how many runs were done."""

import gc
import time
import tracemalloc
import weakref
from dataclasses import replace
from pathlib import Path

from hydra.core.hydra_config import HydraConfig
from scale import rounds
from small_run import small_run

from gapath.commands import run as cli
from gapath.running.experiment import execute
from gapath.store import rows

MB = 1 << 20


def resident():
    """MB of memory that this process has now, and at most since `begin`."""
    told = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
    return tuple(int(told[name].split()[0]) / 1024 for name in ("VmRSS", "VmHWM"))


def begin():
    """Forget what was the most so far."""
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")


def trials_of(count, output, recorders=()):
    run = replace(small_run(output, recorders=recorders, trials=count), trials=count)
    return execute(run, "test", progress=False)


def test_memory_does_not_grow_with_trials(tmp_path, monkeypatch):
    monkeypatch.setattr("os.fsync", lambda file: None)
    monkeypatch.setattr(rows, "BATCH", 200)

    def most(count, recorders):
        gc.collect()
        tracemalloc.start()
        done = trials_of(count, tmp_path / f"{count}{recorders}", recorders)
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert len(done.rows["trial"]) == count
        return found

    for recorders in ((), ("mcap",)):
        trials_of(300, tmp_path / f"first{recorders}", recorders)  # what is imported and kept
        few, many = (most(count, recorders) for count in (400, 2000))
        print(f"{recorders}: {few / MB:.2f} MB with 400 trials, {many / MB:.2f} MB with 2000")
        assert many < few + MB / 2


def test_memory_of_many_trials(tmp_path):
    trials_of(10, tmp_path / "first")  # what is imported and kept
    for count in rounds([5000], [10**4, 10**5, 10**6]):
        begin()
        before, start, computed = resident()[0], time.perf_counter(), time.process_time()
        done = trials_of(count, tmp_path / str(count))
        seconds = time.perf_counter() - start
        computed = time.process_time() - computed
        now, most = resident()
        size = (done.folder / "trials.parquet").stat().st_size / MB
        print(
            f"{count} trials: {before:.0f} MB before, {now:.0f} after, {most:.0f} at most; "
            f"{seconds:.0f} s, of computing {1e6 * computed / count:.0f} us a trial; "
            f"rows take {size:.1f} MB"
        )
        assert most < before + 150


def test_a_sweep_keeps_no_job_that_is_done(gapath, monkeypatch):
    configurations, alive = [], []

    def job(config):
        gc.collect()
        alive.extend(each for each in configurations if each())
        hydra = HydraConfig.instance().cfg
        configurations.extend(map(weakref.ref, (config, hydra)))
        return 0

    monkeypatch.setattr(cli, "job", job)
    assert gapath("-m", "map=kg18_test1", "planner=astar", "seed=1,2,3")[0] == 0
    assert len(configurations) == 6 and not alive


def test_memory_does_not_grow_with_runs(gapath, tmp_path, monkeypatch):
    monkeypatch.setattr("os.fsync", lambda file: None)
    count, found = rounds(20, 2000), []  # times two trials, with a log
    execute_ = cli.execute

    def counted(run, command, **more):
        done = execute_(run, command, **more)
        found.append((resident()[0], time.perf_counter()))
        return done

    monkeypatch.setattr(cli, "execute", counted)
    words = ("map=kg18_test1", "planner=astar", "trials=2", f"seed=range(0,{count})")
    code, out, _ = gapath("-m", *words, "recorder=mcap")
    assert code == 0 and out.count(" found, ") == count
    half = count // 2
    for i in (count // 20, half, count):
        memory, now = found[i - 1]
        print(f"run {i}: {memory:.0f} MB, after {now - found[0][1]:.0f} s")
    assert found[-1][0] < found[half][0] + rounds(10, 20)
