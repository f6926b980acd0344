"""The GPU's evolution in numba's simulator: what the processor comes to, setting by setting."""

import json
from pathlib import Path

import evolving
import numpy as np
from simulator import needs_numba_cuda, simulate

CASES = {
    "usual": {"runs": 7},
    "a population of four": {"settings": {"population": 4}, "seed": 1},
    "a large population": {"settings": {"population": 33, "max_epochs": 3}, "runs": 2},
    "three control points": {"settings": {"control_points": 3}, "seed": 2},
    "many control points": {"settings": {"control_points": 11, "way_points": 9}, "runs": 2},
    "two way points": {"settings": {"way_points": 2}, "obstacles": 0.4},
    "way points of each span": {"settings": {"sampling": "span", "control_points": 6}},
    "every epoch": {"settings": {"min_epochs": 6, "max_epochs": 6, "population": 9}, "runs": 2},
    "the fitter parent alone": {"settings": {"mixing": 1.0}, "seed": 3, "obstacles": 0.5},
    "the other parent alone": {"settings": {"mixing": 0.0}, "seed": 4, "obstacles": 0.5},
    "thirds": {"settings": {"mixing": 1 / 3, "max_epochs": 9}, "seed": 5, "obstacles": 0.5},
    "no mutation": {"settings": {"mutation_probability": 0.0}, "obstacles": 0.5},
    "mutation of every gene": {"settings": {"mutation_probability": 1.0}, "obstacles": 0.5},
    "no jitter": {"settings": {"line_jitter": 0, "line_jitter_probability": 1.0}},
    "jitter of every gene": {"settings": {"line_jitter": 20, "line_jitter_probability": 1.0}},
    "far off the map": {"settings": {"neighbourhood": 65536, "line_jitter": 65536}, "runs": 2},
    "points at the start": {"settings": {"neighbourhood": 0}},
    "a margin": {"settings": {"margin": 3}},
    "a margin beyond the middle": {"settings": {"margin": 65536}},
    "on the map": {"settings": {"clip_to_map": True}, "obstacles": 0.4},
    "one side": {"rule": "one_side", "obstacles": 0.4},
    "no corners": {"rule": "forbid", "obstacles": 0.4},
    "no diagonals": {"rule": "no_diagonals", "obstacles": 0.0},
    "one field": {"map": [1, 1]},
    "a row": {"map": [1, 40]},
    "a column": {"map": [37, 1], "obstacles": 0.0},
    "a long line": {"map": [3, 700], "settings": {"population": 4, "max_epochs": 2}, "runs": 2},
    "a map that is not shared": {"MOST_SHARED": 100, "obstacles": 0.4},
    "launches in pieces": {"MOST_RUNS": 3, "runs": 8},
    "less memory than threads": {"card": {"memory": 3 * 5 * 2 * (4 * 4 + 8) + 12}, "runs": 5},
    "a block": {"card": {"blocks": 1, "threads": 5}, "runs": 9},
    "one run": {"runs": 1},
    "keys that are equal": {
        "map": [5, 8],
        "settings": {"min_epochs": 9, "max_epochs": 9, "population": 24, "neighbourhood": 2},
        "runs": 6,
    },
}


def simulated(cases):
    """What cases come to in a process of the simulator's."""
    done = simulate(evolving.__file__, input=json.dumps(cases))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@needs_numba_cuda
def test_every_setting_comes_to_what_the_processor_does():
    came = dict(zip(CASES, simulated([*CASES.values()]), strict=True))
    assert came == {name: evolving.by_processor(case) for name, case in CASES.items()}
    epochs = np.concatenate([each[0] for each in came.values()])
    assert (epochs == 1).any() and (epochs > 2).any()  # some were done at once, others bred


@needs_numba_cuda
def test_settings_drawn_at_random_come_to_what_the_processor_does():
    random = np.random.default_rng(20)
    cases = []
    for seed in range(30):
        settings = {
            "population": int(random.integers(4, 12)),
            "control_points": int(random.integers(3, 8)),
            "max_epochs": int(random.integers(1, 7)),
            "way_points": int(random.integers(2, 8)),
            "sampling": str(random.choice(["curve", "span"])),
            "mixing": float(random.choice([0.0, 0.5, 0.8, 0.123456, 1.0])),
            "mutation_probability": float(random.random()),
            "line_jitter": int(random.integers(0, 9)),
            "neighbourhood": int(random.integers(0, 9)),
            "margin": int(random.integers(0, 9)),
            "clip_to_map": bool(random.integers(2)),
        }
        rule = str(random.choice(["allow", "one_side", "forbid", "no_diagonals"]))
        shape = random.integers(1, 20, 2).tolist()
        cases.append(
            {"settings": settings, "rule": rule, "map": shape, "seed": seed, "obstacles": 0.3}
        )
    assert simulated(cases) == [evolving.by_processor(case) for case in cases]


@needs_numba_cuda
def test_a_population_that_memory_has_no_room_for_is_refused():
    code = (
        "import evolving\n"
        "from gapath.errors import InputError\n"
        "try: evolving.by_card({'card': {'memory': 99}})\n"
        "except InputError as error: print(error)"
    )
    done = simulate("-c", code, cwd=Path(evolving.__file__).parent)
    assert "planner.population: got 5, expected a population that fits 99 bytes" in done.stdout
