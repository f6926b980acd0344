"""Settings as data: flat and nested again, as text and back."""

import json

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError
from gapath.store.settings import (
    flatten,
    nested,
    of_text,
    plain_yaml,
    read_settings,
    tabular,
    text_of,
)

names = st.from_regex(r"[a-z_]{1,6}", fullmatch=True)
values = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=8)
)
trees = st.recursive(
    values, lambda part: st.lists(part, max_size=3) | st.dictionaries(names, part, max_size=3)
)


@given(st.dictionaries(names, trees, max_size=4))
def test_flat_settings_become_the_nested_ones_again(tree):
    assert nested(flatten(tree)) == tree


@given(st.dictionaries(names, trees, max_size=4))
def test_text_and_yaml_give_the_settings_back(tree):
    flat = flatten(tree)
    assert of_text(text_of(flat)) == flat


def walked(tree, prefix=""):
    """Columns of nested settings, the slow way."""
    for name, item in tree.items():
        if isinstance(item, dict) and item:
            yield from walked(item, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", json.dumps(item) if isinstance(item, dict | list) else item


@given(st.dictionaries(names, trees, max_size=4))
def test_columns_have_a_value_each_and_lists_as_json(tree):
    assert list(tabular(flatten(tree)).items()) == list(walked(tree))


def test_names_by_hand():
    tree = {"map": {"start": [3, 4]}, "replan": [{"base": "ga3"}, {}], "choice": [], "x": None}
    assert flatten(tree) == {
        "map.start[0]": 3,
        "map.start[1]": 4,
        "replan[0].base": "ga3",
        "replan[1].": None,
        "choice[]": None,
        "x": None,
    }
    assert text_of({"planner.population": 80, "name": "a: b"}) == (
        'planner.population: 80\nname: "a: b"\n'
    )


def test_the_text_is_yaml():
    flat = {"a.b": 1, "a.c[0]": "x: y\n#", "d": None, "e": True, "f": 0.5}
    assert yaml.safe_load(text_of(flat)) == flat


@pytest.mark.parametrize(
    "text",
    ["planner", "a: [1, 2]", "a: {}", "a: !!python/name:os.system", "a: ${oc.env:HOME}", "a: &b 1",
     "a: 1\na: 2", "a: " + 9000 * "["],
)  # fmt: skip
def test_text_that_is_no_plain_setting_is_refused(text):
    with pytest.raises(InputError, match="expected name: value"):
        of_text(text)


@pytest.mark.parametrize(
    "text",
    ["a: 1", "a:  1\n", "a: 1 \n", "a: 1e2\n", 'a: "${oc.env:HOME}"\n', "${a}: 1\n", "\n",
     f"a: {'9' * 5000}\n", f"{'.'.join('a' * 40)}: 1\n", f'a: "{"x" * 2**20}"\n', "# a\n"],
)  # fmt: skip
def test_text_that_is_written_otherwise_is_refused(text):
    with pytest.raises(InputError, match=r"^settings: got "):
        of_text(text)


@pytest.mark.parametrize(
    "flat",
    [{"a[1]": 1}, {"a": 1, "a.b": 2}, {"a.b": 1, "a[0]": 2}, {"a..b": 1}, {"": 1}, {"a[x]": 1},
     {"a[0]": 1, "a[2]": 2}],
)  # fmt: skip
def test_names_that_do_not_fit_are_refused(flat):
    with pytest.raises(InputError):
        nested(flat)


@pytest.mark.parametrize("content", ["- 1\n", "a: !!python/name:os.system\n", "a: 2020-01-01\n"])
def test_a_configuration_that_is_none_is_refused(content, tmp_path):
    path = tmp_path / "config.yaml"
    path.write_text(content)
    with pytest.raises(InputError):
        read_settings(path)


@pytest.mark.parametrize(
    "number", ["0x" + "9" * 399, "9" * 5000, "1:" * 200 + "1", "-0b" + "1" * 398]
)
def test_whole_numbers_that_nobody_could_show_are_refused(number):
    with pytest.raises(InputError, match=r"^a\.yaml: got .* \(a whole number of \d+ characters\)"):
        plain_yaml(f"a: [&b {number}, *b]", "a.yaml", "a YAML")
    shown = plain_yaml(f"a: {number[:399]}", "a.yaml", "a YAML")
    assert len(str(shown)) < 1000


def test_whole_numbers_may_be_tagged_and_long_text_may_be_of_digits():
    for number in ("9" * 401, "0x " + "9" * 5000):
        with pytest.raises(InputError, match=r"a whole number of \d+ characters"):
            plain_yaml(f"a: !!int '{number}'", "a.yaml", "a YAML")
    for text in (f"'{'9' * 5000}'", f"!!str {'9' * 5000}", "deadbeef" * 99):
        assert isinstance(plain_yaml(f"a: {text}", "a.yaml", "a YAML")["a"], str)
