"""What a Rerun recording shows of a population, read back from its file, also from a log."""

from dataclasses import replace

import numpy as np
import pytest
import rerun as rr
import rerun.blueprint as rrb
from log_events import example_memetic, write
from recordings import centres, read, record, rerun_command

from gapath.commands import log as log_cli
from gapath.events import Evolved
from gapath.recorders.rerun import scene


@pytest.fixture(autouse=True)
def strict():
    rr.set_strict_mode(True)  # errors are only warnings otherwise
    yield
    rr.set_strict_mode(False)


def population_of(events, trial):
    (found,) = [e.evolution for e in events if isinstance(e, Evolved) and e.trial == trial]
    return found.population, len(found.best)


def check_recording(found, population, epochs):
    assert found["/map/first_path", "LineStrips2D:strips"] == [centres(population.polygon(0))]
    at, texts, levels = {}, [], []
    gained = dict.fromkeys(range(len(population.names)), 0.0)
    expected = {f"/map/population/{who}": [] for who in set(population.individuals.tolist())}
    curves = {name: [] for name in gained}
    changes = list(range(len(population.epochs)))
    for epoch in range(1, epochs + 1):
        moved = set()
        for i in [i for i in changes if population.epochs[i] == epoch]:
            who, operator = int(population.individuals[i]), int(population.operators[i])
            at[who] = centres(population.polygon(i).tolist())
            moved.add(who)
            gained[operator] += population.gains[i]
            gain = population.gains[i]
            text = f"#{epoch} {population.names[operator]}, {who}: {population.costs[i]:g}"
            texts.append((epoch, [text + (f", {gain:.3g} less" if gain else "")]))
            levels.append((epoch, ["INFO" if gain else "DEBUG"]))
        for who in moved:
            expected[f"/map/population/{who}"].append((epoch, [at[who]]))
        for operator, value in gained.items():
            curves[operator].append((epoch, [pytest.approx(value)]))
    for entity, strips in expected.items():
        assert found[entity, "LineStrips2D:strips"] == strips
    assert found["/changes", "TextLog:text"] == texts
    assert found["/changes", "TextLog:level"] == levels
    for operator, values in curves.items():
        key = (f"/gained/{operator}", "Scalars:scalars")
        assert (key in found) is bool(gained[operator])
        assert found.get(key, values) == values


def test_every_individual_and_every_change_read_back(tmp_path):
    events = example_memetic()
    record(tmp_path, events, [0, 2])
    for trial in (0, 2):
        found = read(tmp_path / f"trial-{trial}.rrd")
        population, epochs = population_of(events, trial)
        assert population.gains.any()
        check_recording(found, population, epochs)
        best = np.array([[v[0] for _, v in found["/fitness/best", "Scalars:scalars"]]])
        assert best[0, -1] == population.costs[population.standing(epochs)[-1]].min()
        text = found["/text", "TextDocument:text"][0]
        first, *others = population.shares
        assert f"| first path, first bend | {first:.10g} |" in text
        for name, share in zip(population.names[1:], others, strict=True):
            assert (f"| lowered by {name} | {share:.10g} |" in text) is bool(share)


def test_a_recording_made_of_a_log_is_the_same(tmp_path):
    log = write(example_memetic(), tmp_path)
    assert log_cli.main(["rerun", str(log), "--trials", "1", "-o", str(tmp_path)]) == 0
    direct = tmp_path / "direct"
    direct.mkdir()
    record(direct, example_memetic(), [1])
    assert read(direct / "trial-1.rrd") == read(tmp_path / "trial-1.rrd")
    verified = rerun_command("rrd", "verify", direct / "trial-1.rrd")
    assert verified.returncode == 0, verified.stderr


def views_of(part):
    if isinstance(part, rrb.View):
        return [part]
    return [view for each in part.contents for view in views_of(each)]


def test_no_curve_is_laid_out_that_would_be_empty():
    run, _, evolved = example_memetic(1)[:3]
    evolution = evolved.evolution
    population = evolution.population
    flat = population._replace(gains=np.zeros_like(population.gains))
    alone = evolution._replace(best=evolution.best[:1], mean=evolution.mean[:1])
    for told, expected in (
        (evolution, ["fitness", "gained"]),
        (evolution._replace(population=flat), ["fitness"]),
        (alone, []),
        (alone._replace(population=None), []),
        (evolution._replace(population=None), ["fitness", "obstacles"]),
    ):
        views = views_of(scene.layout(run, [replace(evolved, evolution=told)]).root_container)
        curves = [view.origin for view in views if isinstance(view, rrb.TimeSeriesView)]
        assert curves == expected
        assert type(views[0]) is rrb.Spatial2DView


def test_individuals_have_a_colour_each_and_the_best_one_stands_out(tmp_path):
    events = example_memetic()
    record(tmp_path, events)
    found = read(tmp_path / "trial-0.rrd")
    lines = [entity for entity, part in found if part == "LineStrips2D:colors"]
    others = [entity for entity in lines if entity.startswith("/map/population/")]
    assert len(others) == 3
    colours = {str(found[entity, "LineStrips2D:colors"]) for entity in others}
    assert len(colours | {str(found["/map/best/path", "LineStrips2D:colors"])}) == 4
    for other in others:
        for part in ("LineStrips2D:radii", "LineStrips2D:draw_order"):
            thick, thin = found["/map/best/path", part], found[other, part]
            assert abs(thick[0]) > abs(thin[0])  # in points of the screen it is negative
