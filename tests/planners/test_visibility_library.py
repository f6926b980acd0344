"""Our profiles have the distributions of geneticalgorithm2: its runs are kept, ours are made here.

Seeds are fixed, so each p is a fixed number: they were computed once, for the first 500 seeds, and
not looked for. Of the 18 p that count (evaluations follow from generations) the least is 0.150.
Such samples tell apart what the last tests show; by which of the three versions' generations runs
were made moves neither f nor generations by so much. That rests on reading the library alone: that
the first population never holds the last point, that parents are distinct, that the roulette
leaves the elite out or that a mutation between parents may reach the greater one.
"""

import numpy as np
import pytest

from benchmarks.questions.m22.visibility_agreement import (
    MEASURES,
    PROFILES,
    agreement,
    compared,
    measure,
    ours,
    reference,
)
from benchmarks.rivals.visibility_library import SCENES, SETTINGS, digest, looked_up
from benchmarks.scene import Scene
from gapath.kernels.m22.evolution import path_length

LEAST_P = 0.01


def least_p(profile, **settings):
    """The least p of all scenes and measures."""
    found = [agreement(profile, name, **settings) for name in SCENES]
    return min(row["p"] for each in found for row in each.values())


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SCENES)
def test_the_library_ran_on_the_same_graph(profile, name):
    kept = reference(profile)
    assert kept["geneticalgorithm2"] == PROFILES[profile] and kept["settings"] == SETTINGS
    scene = kept["scenes"][name]
    assert scene["lengths_sha256"] == digest(Scene.of(name).lengths), (
        "the scene's graph is another one: export it and run the library again"
        " (benchmarks/rivals/visibility_library.py)"
    )
    assert len(scene["f"]) == len(scene["generations"]) == len(scene["evaluations"]) >= 300
    assert max(scene["generations"]) < 200  # no run was cut off


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", SCENES)
def test_a_profile_is_distributed_as_its_version(profile, name):
    for key, found in agreement(profile, name).items():
        assert found["p"] >= LEAST_P, (key, found)
        assert abs(found["delta"]) < 0.1, (key, found)


@pytest.mark.parametrize("profile", PROFILES)
def test_evaluations_follow_from_generations(profile):
    for name in SCENES:
        kept = reference(profile)["scenes"][name]
        expected = [100 + 70 * (generations - 1) for generations in kept["generations"]]
        assert kept["evaluations"] == expected


@pytest.mark.parametrize(
    ("profile", "settings"),
    [
        ("v64", {"mutation_probability": 0.3}),
        ("v67", {"mutation_probability": 0.3}),
        ("v69", {"mutation_probability": 0.3}),
        ("v69", {"mutation_probability": 0.2}),
        ("v69", {"max_stagnation": 19}),
    ],
)
def test_others_are_told_apart(profile, settings):
    assert least_p(profile, **settings) < LEAST_P / 100


def test_effects_by_hand():
    same = compared([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    assert same == {"KS": 0.0, "p": 1.0, "delta": 0.0}
    assert compared([4.0, 5.0], [1.0, 2.0])["delta"] == 1.0
    assert compared([1.0, 2.0], [2.0, 3.0]) == {"KS": 0.5, "p": 1.0, "delta": -0.75}


def test_the_target_function_of_the_library_is_ours():
    scene = Scene.of(SCENES[0])
    target = looked_up(scene.lengths, scene.penalty)
    random, kinds = np.random.default_rng(0), set()
    for chromosome in random.integers(0, len(scene.lengths), (3000, scene.genes)):
        length = path_length(scene.lengths, chromosome.astype(np.int32), False)
        expected = scene.penalty if length < 0 else length / 65536
        assert target(chromosome.astype(float)) == expected
        kinds.add(length < 0)
    assert kinds == {True, False}


def test_the_table_has_every_version_and_scene():
    table = measure(quick=True)
    assert len(table) == len(PROFILES) * len(SCENES)
    assert all(f"{name}: p" in row for row in table for name in MEASURES)
    found = ours(Scene.of(SCENES[0]), range(3), ga2_profile="v69")
    assert [len(found[name]) for name in MEASURES] == [3, 3, 3]
