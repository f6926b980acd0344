"""How an epoch of KG18's genetic algorithm grows with its population and its control points.

Map 4, 100 x 50 fields, 100 epochs whether a path is found or not; what is not varied is as in
GA 2: 100 individuals, 4 control points. Microseconds, of `Planner.plan` over its epochs.
"""

from functools import partial

from benchmarks.measure import Row, interleave, make_planner, make_problem, quartiles
from gapath.kernels.rng import stream

VARIED = {
    "population": (25, 100, 400, 1600, 6400),
    "control_points": (3, 4, 6, 8, 12, 16, 24, 32),
}
EPOCHS = 100


def measure(quick: bool) -> list[Row]:
    problem = make_problem("kg18_test4")
    planners = {
        f"{setting} {value}": make_planner(
            "ga2", min_epochs=EPOCHS, max_epochs=EPOCHS, **{setting: value}
        )
        for setting, values in VARIED.items()
        for value in values
    }
    rounds = 1 if quick else 30
    times, _ = interleave(
        [
            {name: partial(each.plan, problem, stream(seed)) for name, each in planners.items()}
            for seed in (0, *range(rounds))
        ]
    )
    return [
        {
            "setting": setting,
            "value": value,
            "us an epoch": quartiles([us / EPOCHS for us in times[f"{setting} {value}"]]),
        }
        for setting, values in VARIED.items()
        for value in values
    ]
