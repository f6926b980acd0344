"""Helpers that every test may use."""

import contextlib
import os
import shutil
import sys
from pathlib import Path

import pytest
from hypothesis import settings

TESTS = Path(__file__).parent
# twins, strategies and commands; what harnesses share; the benchmarks, which are not installed
sys.path[:0] = map(
    str,
    (
        TESTS,
        TESTS / "twins",
        TESTS / "reliability",
        TESTS / "recorders",
        TESTS / "kernels" / "cuda",
        TESTS.parent,
    ),
)
sys.path.append(str(TESTS / "plugin"))  # not before that package where it is installed

settings.register_profile("gapath", deadline=None, derandomize=True, max_examples=100)
settings.register_profile("many", deadline=None, max_examples=2000)
settings.load_profile("gapath")


@pytest.fixture
def data():
    """The folder of real maps, which is not part of the project."""
    place = Path(os.environ.get("GAPATH_DATA", Path(__file__).parents[2] / "shared" / "data"))
    if not place.is_dir():
        pytest.skip("no real maps: set GAPATH_DATA or put them into ../shared/data")
    return place


@pytest.fixture
def gapath(monkeypatch, capfd, tmp_path):
    """Run the command in this process; gives exit code, output and error output."""

    def call(*arguments, output=tmp_path / "out"):
        extra = [f"output={output}"] if output else []
        from gapath.commands import run as cli  # not before a test asks for it: it imports Hydra

        monkeypatch.setattr(sys, "argv", ["gapath", *map(str, arguments), *extra])
        try:
            cli.main()
            code = 0
        except SystemExit as stop:
            code = stop.code or 0
        return code, *capfd.readouterr()

    monkeypatch.chdir(tmp_path)
    return call


@pytest.fixture
def failing_after(monkeypatch):
    """Within the context, fail when so many trials are in a run's journal."""

    @contextlib.contextmanager
    def context(trials):
        from gapath.running import progress  # as above

        add, left = progress.Journal.add, [trials]

        def last(journal, trial):
            add(journal, trial)
            left[0] -= 1
            if not left[0]:
                raise RuntimeError("cut short")

        with monkeypatch.context() as patch:
            patch.setattr(progress.Journal, "add", last)
            yield

    return context


def pytest_addoption(parser):
    parser.addoption("--update-golden", action="store_true", help="accept today's results")
    parser.addoption("--figures", action="store_true", help="show what tests say they tried")


def pytest_terminal_summary(terminalreporter, config):
    if config.getoption("--figures"):
        for report in map(terminalreporter.getreports, ("passed", "failed")):
            for test in report:
                terminalreporter.write(test.capstdout)


@pytest.fixture
def update_golden(request):
    return request.config.getoption("--update-golden")


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium, for pages as people see them."""
    names = ("chromium", "chromium-browser", "google-chrome", "chrome")
    path = next(filter(None, map(shutil.which, names)), None)
    if path is None:
        assert not os.environ.get("CI"), "no Chromium on the path; .ci/run installs it"
        pytest.skip("no Chromium on the path (Debian: apt-get install chromium)")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as driver:
        options = ["--no-sandbox"] if os.geteuid() == 0 else []
        browser = driver.chromium.launch(executable_path=path, args=options)
        yield browser
        browser.close()
