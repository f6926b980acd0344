"""What a memetic algorithm's population took in, change by change."""

import numpy as np

from gapath.history.evolution import Population


def test_a_change_has_the_vertices_between_two_ends():
    polygons = [np.array(p, np.int32) for p in ([[0, 0], [4, 2]], [[0, 0], [1, 3], [4, 2]])]
    changes, none, names = np.arange(2, dtype=np.int32), np.zeros(2), ("a", "b")
    ends = np.array([2, 5], np.int32)
    population = Population(
        changes, changes, changes, none, none, ends, np.concatenate(polygons), names, (0.0, 0.0)
    )  # fmt: skip
    assert [population.polygon(i).tolist() for i in range(2)] == [p.tolist() for p in polygons]
