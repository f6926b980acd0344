"""How long `gapath-report` takes to tell of ten thousand runs with a million trials.

Seconds and peak memory of whole processes, their output thrown away; "CPU s" is what they spent on
all cores. "list" writes every run, "where" those that fulfil a condition, "group" pools the trials
of each population, "sql" reads the files of all trials. They are in the system's cache, as those
of a sweep that has just ended. "report" writes the whole report, pages of all runs included. The
targets: a list in 3 s, groups in 2 s, the report in 30 s, each in 1 GiB.
"""

from functools import partial

from benchmarks.many_runs import many_runs
from benchmarks.measure import REPORT, Calls, Row, interleave, quartiles, spent

QUESTIONS = {
    "list": (),
    "where": ("--where", "map = 'kg18_test3' and planner.population >= 80"),
    "group": ("--group", "planner.population"),
    "sql": ("--sql", "select planner.population, avg(evaluations) from trials group by all"),
}


def measure(quick: bool) -> list[Row]:
    runs, trials = (80, 5) if quick else (10_000, 100)
    with many_runs(runs, trials) as outputs:
        calls: Calls = {
            name: partial(spent, [REPORT, "runs", str(outputs), *words])
            for name, words in QUESTIONS.items()
        }
        calls["report"] = partial(spent, [REPORT, str(outputs)])
        times, results = interleave([calls] * (1 + (2 if quick else 5)))
    return [
        {
            "question": name,
            "runs": runs,
            "trials": runs * trials,
            "seconds": quartiles([time / 1e6 for time in times[name]]),
            "CPU s": quartiles([found[name].cpu_s for found in results]),
            "peak GB": quartiles([found[name].peak_bytes / 1e9 for found in results]),
        }
        for name in calls
    ]
