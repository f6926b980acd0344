"""The page on logs in other languages: its Python reads a log, without gapath."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from gapath.commands import run as cli

PAGE = (Path(__file__).parents[2] / "docs" / "reading-logs.md").read_text("utf-8")
WITHOUT = "import sys\nsys.modules['gapath'] = None\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    output = tmp_path_factory.mktemp("out")
    words = ["map=kg18_test1", "planner=ga1", "recorder=mcap", "trials=2", "seed=5"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["gapath", *words, f"output={output}"])
        cli.main()
    (log,) = output.glob("plan/*/run.mcap")
    return log.parent


@pytest.mark.parametrize(
    ("number", "lines"),
    [(0, [r"0\.0 0 True \S+ 1", r"0\.1 1 True \S+ 1"]),
     (1, [r"map\.npy \(50, 100\) float64", r"optimal_path\.npy \(\d+, 2\) int32"])],
)  # fmt: skip
def test_its_python_reads_a_log(number, lines, folder):
    pytest.importorskip("mcap_ros2")
    example = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[number]
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT + example],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    printed = done.stdout.replace(".zst", "").splitlines()
    assert len(printed) == len(lines)
    assert all(re.fullmatch(*pair) for pair in zip(lines, printed, strict=True)), printed
