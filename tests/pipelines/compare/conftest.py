import hashlib
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gapath.pipelines.report.cli import main
from gapath.running.naming import Method

from ..conftest import DATE, manifest_of, write_run
from ..synthetic import NOTHING, make_map, make_trials, plan_settings


def compare(outputs: Path, *arguments: str, into: Path | None = None) -> None:
    """Run the command; warnings are errors."""
    where = ["-o", str(into)] if into else []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert main(["compare", str(outputs), *arguments, *where]) == 0


@pytest.fixture(scope="session")
def try_out() -> Callable[..., Path]:
    """Write one run folder of a setting: larger populations find more, and spend more."""

    def make(
        outputs: Path,
        changes: Mapping[str, Any] = NOTHING,
        *,
        preset: str = "ga3",
        map_name: str = "kg18_test3",
        n: int = 60,
        seed: int = 0,
        experiment: str = "mine",
        **columns: Any,
    ) -> Path:
        grid, method = make_map(map_name), Method(preset, changes)
        key = hashlib.sha256(f"{experiment} {map_name} {method.name} {seed}".encode())
        folder = outputs / experiment / key.hexdigest()[:16]
        folder.mkdir(parents=True)
        trials = make_trials(grid, method.name, experiment, seed, n)
        if preset.startswith("ga"):
            population = changes.get("planner.population", 30)
            random = np.random.default_rng([population, seed, int(grid.name[-1])])
            found = random.random(n) < 1 - 12 / (12 + population)
            epochs = np.where(found, random.geometric(0.2, n), 60)
            trials = trials.assign(
                feasible=found, evaluations=epochs * population, epochs=epochs,
                plan_time_s=1e-5 * epochs * population * random.uniform(0.8, 1.2, n),
                cost=np.where(found, 11.5 + random.integers(0, 4, n), 200012.0),
            )  # fmt: skip
        trials = trials.assign(**columns)
        manifest = manifest_of(
            method, "plan", (experiment, folder.name), map=map_name,
            map_digest=grid.digest, seed=seed, trials=n,
        )  # fmt: skip
        write_run(folder, trials, plan_settings(preset, changes), manifest, DATE)
        return folder

    return make


@pytest.fixture(scope="session")
def sweep(tmp_path_factory: pytest.TempPathFactory, try_out: Callable[..., Path]) -> Path:
    """Give the run folders of four populations on two maps; read only."""
    folder = tmp_path_factory.mktemp("sweep")
    for population in (40, 80, 120, 160):
        for name in ("kg18_test1", "kg18_test3"):
            try_out(folder, {"planner.population": population}, map_name=name)
    return folder
