"""What stands for what when kernels are changed, place by place."""

import types

import mutants
import pytest


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("a + b", ["a - b"]),
        ("a <= b", ["a < b", "a > b"]),
        ("a and not b", ["a or not b", "b"]),
        ("a == True", ["a != True", "False"]),
        ("x[i, 2]", ["x[i + 1, 2]", "3", "1"]),
        ("a -= 7", ["a += 7", "8", "6"]),
    ],
)
def test_each_place_of_a_line_is_changed(line, expected):
    found = list(mutants.mutants(f"def f(a: int = {{}}):\n    {line}\n"))
    assert [new for *_, new, _ in found] == expected
    assert all(name == "f" and at.startswith("2:") for name, at, *_ in found)


@pytest.mark.parametrize(
    ("returns", "value", "expected"),
    [
        ("int", "a", ["return a + 1"]),
        ("bool", "a", ["return not a"]),
        ("tuple[int, bool]", "a, b", ["return (a + 1, b)", "return (a, not b)"]),
        ("None", "a", []),
    ],
)
def test_results_are_changed_by_the_type_that_is_said(returns, value, expected):
    text = f"@kernel(inner=True)\ndef f(a, b) -> {returns}:\n    return {value}\n"
    assert [new for *_, new, _ in mutants.mutants(text)] == expected


def test_each_tree_differs_in_one_place_and_the_last_is_as_it_was():
    text = "A = 1\n\ndef f(a):\n    while a > A:\n        break\n"
    trees = [mutants.ast.unparse(tree) for *_, tree in mutants.mutants(text)]
    assert trees[0].startswith("A = 2\n") and trees[1].startswith("A = 0\n")
    assert "while a >= A" in trees[2] and "while a <= A" in trees[3] and "continue" in trees[4]
    assert len(trees) == 5 and all(tree.count("\n") == trees[0].count("\n") for tree in trees)


def test_a_function_whose_results_are_kept_is_changed_for_those_who_have_it():
    text = "from functools import cache\n\n@cache\ndef f() -> int:\n    return 5\n"
    module = types.ModuleType("kept")
    module.__file__ = "kept.py"
    mutants.Loader(compile(text, "kept.py", "exec")).exec_module(module)
    function, found = module.f, []
    assert function() == 5
    for *_, tree in mutants.mutants(text):
        mutants.replace(module, tree)
        found.append(function())
    assert found == [6, 6, 4]
