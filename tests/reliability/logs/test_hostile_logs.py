"""A log from anywhere, its checksums all right: one line each, within bounds, nothing else done."""

import os
import struct
import subprocess
import sys
import zlib
from dataclasses import replace

import numpy as np
import pytest
import zstandard
from altering import telling
from logs_of_runs import RUNS, log_of, told
from mcap.records import Metadata
from scale import rounds
from senseless import hostile
from taking_apart import Parts, older, put_together, taken_apart

from gapath.recorders.mcap.file.summary import MAGIC


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    return log_of("plan", tmp_path_factory.mktemp("plan"))


SETTINGS = {
    "a secret": ("seed", '"${oc.env:SECRET}"'),
    "a secret in a name": ("seed", "0\n${oc.env:SECRET}: 1"),
    "a tag": ("seed", "!!python/object/apply:os.system ['true']"),
    "an anchor": ("seed", "&a 0"),
    "an alias": ("seed", "*a"),
    "a list": ("seed", "[" * 9000 + "]" * 9000),
    "a mapping": ("seed", '{"a": 1}'),
    "a merge": ("seed", '0\n<<: "a"'),
    "a deep name": ("seed", "0\n" + ".".join("a" * 5000) + ": 1"),
    "a far index": ("seed", "0\nplanner.a[99999999]: 1"),
    "a long one": ("seed", '"' + "x" * (2 << 20) + '"'),
    "many digits": ("seed", "9" * 4000),
    "no planner": ("planner.kind", None),
    "another task": ("task", '"../plan"'),
    "a task that is none": ("task", "7"),
    "a file": ("map.kind", '"image"\nmap.path: "/dev/zero"'),
    "much work": ("planner.max_epochs", "1000000"),
    "no number": ("planner.population", "NaN"),
    "too much": ("planner.population", "1e999"),
    "nothing": ("planner.population", "null"),
    "a name that is obeyed": ("name", '"\\u001b[2J"'),
}


@pytest.mark.parametrize(("name", "value"), SETTINGS.values(), ids=SETTINGS)
def test_settings_are_plain_data(name, value, plan, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("SECRET", "this is secret")
    parts, path = taken_apart(plan), tmp_path / "run.mcap"

    def other(line):
        if line.partition(":")[0] == "planner.population" and value == "1000000":
            return "planner.population: 10000\n"
        if not line.startswith(f"{name}: "):
            return line
        return "" if value is None else f"{name}: {value}\n"

    changed = []
    for entry in parts.entries:
        if isinstance(entry, Metadata):
            lines = entry.metadata["settings"].splitlines(keepends=True)
            text = entry.metadata | {"settings": "".join(map(other, lines))}
            entry = replace(entry, metadata=text)
        changed.append(entry)
    put_together(Parts(changed, parts.ends), path)
    for words in (["info"], ["verify"], ["salvage", "-o", tmp_path / "saved.mcap"],
                  ["rerun", "-o", tmp_path]):  # fmt: skip
        code, out, err = told(capsys, words[0], path, *words[1:])
        assert "secret" not in out + err and "\x1b" not in out + err
        assert words[0] != "verify" or code in (1, 2)
        if value == "1000000" and words[0] == "verify":
            assert "or --yes to do it" in err


@pytest.fixture(scope="module", params=RUNS)
def log(request, tmp_path_factory):
    return log_of(request.param, tmp_path_factory.mktemp("runs"))


def test_hostile_numbers_are_one_line(log, tmp_path, capsys):
    every = list(hostile(taken_apart(log)))
    chosen = np.random.default_rng(5).permutation(len(every))[: rounds(12, len(every))]
    path, wrong, tried = tmp_path / "run.mcap", [], 0
    for number in chosen:
        what, parts = every[number]
        put_together(parts, path)
        for words in (["info"], ["verify"], ["salvage"], ["rerun", "--trials", "0"]):
            saved = tmp_path / "saved.mcap"
            extra = ["-o", {"salvage": saved, "rerun": tmp_path}[words[0]]] if words[0] in (
                "salvage", "rerun") else []  # fmt: skip
            try:
                code, out, _ = told(capsys, *words, path, *extra)
                assert code in (0, 1, 2, 3) and (code or words[0] != "verify"), out
            except Exception as error:
                wrong.append(f"{what}: {words[0]}: {type(error).__name__} {error}")
            saved.unlink(missing_ok=True)
            tried += 1
    with capsys.disabled():
        print(f"\n{tried} commands on {len(chosen)} of {len(every)} hostile logs, "
              f"{len(wrong)} tracebacks")  # fmt: skip
    assert not wrong, "\n".join(wrong)


def head_of(log):
    """What lies before the first chunk, and a chunk's record around any bytes."""
    whole = log.read_bytes()
    return whole[: whole.index(struct.pack("<I", 4) + b"zstd") - 37]


def chunk(data, size=None):
    packed = zstandard.compress(data)
    head = struct.pack("<QQQII4sQ", 0, 0, size or len(data), zlib.crc32(data), 4, b"zstd",
                       len(packed))  # fmt: skip
    return record(6, head + packed)


def record(opcode, data=b""):
    return struct.pack("<BQ", opcode, len(data)) + data


SCHEMA = record(3, struct.pack("<H", 1) + b"".join(
    struct.pack("<I", len(text)) + text
    for text in (b"nav_msgs/msg/OccupancyGrid", b"ros2msg", b"x")))  # fmt: skip
CHANNEL = record(4, struct.pack("<HHI4sI3sI", 1, 1, 4, b"/map", 3, b"cdr", 0))


def messages(count, size):
    return b"".join(
        record(5, struct.pack("<HIQQ", 1, number, 0, 0) + bytes(size)) for number in range(count)
    )


def bombs(log):
    """Give files by name: a start of bytes, and how long it is made with zeros."""
    head, begin = head_of(log), SCHEMA + CHANNEL
    large, many = rounds(1 << 27, 1 << 30), rounds(1, 10)
    yield "256 MiB of zeros in a chunk", head + chunk(bytes(1 << 28)), 0
    yield "256 MiB in a message", head + chunk(begin + messages(1, (1 << 28) - 999)), 0
    yield "40 MiB in a message", head + chunk(begin + messages(1, 40 << 20)), 0
    noise = np.random.default_rng(1).bytes(40 << 20)
    yield "40 MiB of noise", head + chunk(begin + messages(1, 40 << 20)[: -len(noise)] + noise), 0
    yield "a chunk that says 2 EiB", head + chunk(bytes(9), 1 << 61), 0
    yield "zeros", b"", large
    yield "zeros behind a head", head, large
    yield "zeros behind magic", MAGIC, large
    yield "zero messages", head + chunk(begin + messages(30_000, 0)) * 99, 0
    yield (
        "16 GiB of zero messages",
        head + chunk(begin) + chunk(messages(4, 1 << 18)) * 1600 * many,
        0,
    )
    yield "empty chunks", head + chunk(begin) * 20_000 * many, 0
    yield "marks of chunks", head + (struct.pack("<I", 4) + b"zstd") * 200_000 * many, large
    yield "heads of chunks", head + (chunk(bytes(9), 9)[:60] * 50_000 * many), large
    yield "a record of 1 GiB", MAGIC + struct.pack("<BQ", 1, large - 99), large
    yield "an attachment of 1 GiB", head + struct.pack("<BQ", 9, large - 9999), large
    yield "attachments", head + record(9, bytes(36)) * 99_999 * many, 0


SCRIPT = """
import re, sys, time
from pathlib import Path
from gapath.commands import log
for path in sorted(Path(sys.argv[1]).iterdir()):
    for words in (["info"], ["verify"], ["salvage", "-o", "saved.mcap"], ["rerun", "-o", "."]):
        begin = time.perf_counter()
        code = log.main([words[0], str(path), *words[1:]])
        took = time.perf_counter() - begin
        most = int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) >> 10
        print("TOOK", path.name, words[0], code, round(took, 2), most, flush=True)
        Path("saved.mcap").unlink(missing_ok=True)
"""


def test_bombs_take_neither_memory_nor_time(plan, tmp_path, capsys):
    folder = tmp_path / "bombs"
    folder.mkdir()
    for name, data, size in bombs(plan):
        with (folder / f"{name}.mcap").open("wb") as file:
            file.write(data)
            file.truncate(max(size, len(data)))
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, folder], cwd=tmp_path, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
    told = [line.split()[-4:] for line in done.stdout.splitlines() if line.startswith("TOOK")]
    slowest = max(float(took) for _, _, took, _ in told)
    most = max(int(most) for *_, most in told)
    with capsys.disabled():
        print(f"\n{len(told)} commands on bombs: at most {slowest} s and {most} MiB")
    assert len(told) == 4 * sum(1 for _ in bombs(plan))
    assert most <= 512 and slowest <= 10, done.stdout


@pytest.mark.parametrize("kind", ["fifo", "device", "folder", "link to a device"])
def test_only_regular_files_are_opened(kind, tmp_path, capsys):
    path = tmp_path / "run.mcap"
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "device":
        path = "/dev/zero"
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    for words in (["info"], ["verify"], ["salvage", "-o", tmp_path / "saved.mcap"], ["rerun"]):
        code, out, err = told(capsys, words[0], path, *words[1:])
        assert ((code, out) == (2, "") and "regular" in err) or kind == "folder"


@pytest.mark.parametrize("version", ["4", "5"])
def test_settings_of_recorders_are_said_to_be_their_authors(version, plan, tmp_path, capsys):
    path, parts = tmp_path / "run.mcap", taken_apart(plan)
    (text,) = [e.metadata["settings"] for e in parts.entries if isinstance(e, Metadata)]
    old = taken_apart(older(plan, version, tmp_path / "old.mcap"))
    for setting in ("", 'recorder.mcap.kind: "mcap"\n'):
        settings = text.replace("\nseed:", f"\n{setting}seed:")
        put_together(telling(old, "settings", settings), path)
        code, out, _ = told(capsys, "verify", path)
        assert code == 0 and f"made with log version {version} (7 here)" in out, out
        assert ("the settings of its recorders are its author's" in out) == bool(setting)


@pytest.mark.parametrize(
    "version", ["", "1.0; reproduced", "x" * 100, "1 (2 here)", "\x1b[2J", "ä"]
)
def test_a_version_is_no_sentence(version, plan, tmp_path, capsys):
    path = tmp_path / "run.mcap"
    put_together(telling(taken_apart(plan), "version/numpy", version, trials=False), path)
    code, out, err = told(capsys, "verify", path)
    assert (code, out) == (2, "") and "metadata, version/numpy" in err


@pytest.mark.parametrize("name", ["", "numpy 2.4; reproduced", "x" * 100, "\x1b[2J", "a\nb"])
def test_nor_is_its_name_one(name, plan, tmp_path, capsys):
    path = tmp_path / "run.mcap"
    put_together(telling(taken_apart(plan), f"version/{name}", "1", trials=False), path)
    code, out, err = told(capsys, "verify", path)
    assert (code, out) == (2, "") and "metadata: got version/" in err and err.count("\n") == 1


def test_nobody_has_so_many_versions(plan, tmp_path, capsys):
    path, parts = tmp_path / "run.mcap", taken_apart(plan)
    for i in range(101):
        parts = telling(parts, f"version/x{i}", "1", trials=False)
    put_together(parts, path)
    code, out, err = told(capsys, "verify", path)
    assert (code, out) == (2, "") and "versions, expected fewer" in err


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name: "', 'name: "\\ud800', "settings"),
        ('name: "', 'name: "../x; reproduced ', "settings of the log, name"),
        ("", 20_000 * "planner.x: 0\n", "settings"),
        ("", "".join(f"planner.x[{i}]: 0\n" for i in range(20_000)), "metadata, settings: got"),
        ("", f"planner.x[{'9' * 5000}]: 0\n", "settings of the log, setting planner.x["),
    ],
)
def test_settings_that_no_run_has_are_one_line(old, new, said, plan, tmp_path, capsys):
    path, parts = tmp_path / "run.mcap", taken_apart(plan)
    settings = next(e.metadata["settings"] for e in parts.entries if hasattr(e, "metadata"))
    settings = settings.replace(old, new) if old else settings + new
    put_together(telling(parts, "settings", settings, trials=False), path)
    code, out, err = told(capsys, "verify", path)
    assert (code, out) == (2, "") and said in err and err.count("\n") == 1


def test_a_version_that_is_unknown_is_told_from_none(plan, tmp_path, capsys):
    path = tmp_path / "run.mcap"
    parts = telling(taken_apart(plan), "version/python", "unknown", trials=False)
    put_together(parts, path)
    assert "made with python unknown (" in told(capsys, "verify", path)[1]
    for entry in parts.entries:
        getattr(entry, "metadata", {}).pop("version/python", None)
    put_together(parts, path)
    assert "made with no version of python told" in told(capsys, "verify", path)[1]
