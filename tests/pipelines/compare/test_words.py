"""What a comparison says, word by word."""

import pytest

from gapath.pipelines.compare.words import sentences, some
from gapath.pipelines.numbers.comparing.comparison import Comparison, Estimate, Pair
from gapath.pipelines.numbers.comparing.pairwise import Difference


def said(quantity, estimates, *pairs):
    return " ".join(sentences(Comparison(quantity, tuple(estimates), pairs, None), "feasible"))


@pytest.mark.parametrize(
    ("ends", "shown"),
    [
        ([(0.997, 1.0), (0.997, 1.0)], "a and b share the first place: 100 % (99.7 to 100.0)."),
        ([(0.997, 1.0), (0.75, 1.0)], "a and b share the first place: 100 %."),
        ([(0.997, 1.0), (None, None)], "a and b share the first place: 100 %."),
    ],
)
def test_who_share_a_place_have_an_interval_if_it_is_that_of_each(ends, shown):
    estimates = [Estimate(name, 9, 1.0, *each) for name, each in zip("ab", ends, strict=True)]
    assert shown in said("success", estimates)


@pytest.mark.parametrize(
    ("quantity", "difference", "adjusted", "shown"),
    [
        ("time", Difference("Mann-Whitney", 0.82, 4 / 3, 1.08, 1.58), 0.82,
         "(0.75 times, 0.633 to 0.926, p = 0.82 by the ranks of all trials)"),
        ("time", Difference("Mann-Whitney", 0.82, 4 / 3, 0.9, 1.58), 0.82,
         "(0.75 times, 0.633 to 1.11, p = 0.82)"),
        ("cost", Difference("Wilcoxon, signed rank", 0.2, 0.8, 0.7, 0.9), 0.2,
         "(1.25 times, 1.11 to 1.43, p = 0.2 by the ranks of all differences)"),
        ("cost", Difference("Wilcoxon, signed rank", 0.02, 0.8, 0.7, 0.9), 0.12,
         "(1.25 times, 1.11 to 1.43, p = 0.12, p = 0.02 before Holm)"),
        ("expected_time", Difference("bootstrap", 0.06, 0.8, 0.7, 0.99), 0.06,
         "p = 0.06 by the standard error)"),
        ("success", Difference("McNemar, exact", 0.06, 0.1, 0.01, 0.2), 0.06,
         "(10 points, 1 to 20, p = 0.06 by the exact test of pairs)"),
        ("success", Difference("score test", 0.06, 0.1, 0.01, 0.2), 0.06, "by the score test)"),
        ("success", Difference("Fisher, exact", 0.06, 0.1, 0.01, 0.2), 0.06, "by the exact test)"),
        ("success", Difference("Fisher, exact", 0.06, 0.1, -0.01, 0.2), 0.06, "p = 0.06)"),
        ("time", Difference("Wilcoxon, signed rank", 0.01, 0.8, 0.7, 0.9), 0.01, "1.43, p = 0.01)"),
    ],
)  # fmt: skip
def test_an_interval_that_leaves_equality_out_is_explained(quantity, difference, adjusted, shown):
    estimates = [Estimate("a", 9, 1.0), Estimate("b", 9, 2.0)]
    pair = Pair("a", "b", 0, difference, adjusted, False)
    assert shown in said(quantity, estimates, pair)


def test_many_names_are_cut():
    assert some("abcde") == "a, b, c, d and e"
    assert some("abcdefg") == "a, b, c, d, e and 2 more"
