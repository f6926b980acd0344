"""A log from anywhere, its checksums all right: one line each, within bounds, nothing else done."""

import os
import resource
import struct
import subprocess
import sys
import zlib
from dataclasses import replace

import numpy as np
import pytest
import zstandard
from altering import Parts, hostile, put_together, taken_apart
from mcap.records import Metadata
from scale import rounds
from small_runs import RUNS, log_of, told

from gapath.recorders.mcap.file.summary import MAGIC


@pytest.fixture(scope="module", params=RUNS)
def log(request, tmp_path_factory):
    return log_of(request.param, tmp_path_factory.mktemp("runs"))


def test_hostile_numbers_are_one_line(log, tmp_path, capsys):
    every = list(hostile(taken_apart(log)))
    chosen = np.random.default_rng(5).permutation(len(every))[: rounds(60, len(every))]
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
