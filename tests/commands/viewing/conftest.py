"""Logs to look at."""

import pytest
from recorders.log_events import example, example_drives, write


@pytest.fixture
def plans(tmp_path):
    (tmp_path / "plans").mkdir()
    return write(example(), tmp_path / "plans")


@pytest.fixture
def drives(tmp_path):
    (tmp_path / "drives").mkdir()
    return write(example_drives(), tmp_path / "drives")
