"""What is imported is declared: in the base, or in an extra that was asked for on the way there."""

import ast
from importlib import metadata
from pathlib import PurePosixPath

from packages import EXTRAS, PROJECT, ROOT, names_in, plain

BASE = set(names_in(PROJECT["dependencies"]))
FOR_USERS = ("crate", "image", "report", "view")
"""Extras that gapath imports; the others are plugins of Hydra's, and of numba's."""

ASKED_FOR = {
    "gapath/crates/description.py": "crate",
    "gapath/pictures/canvas.py": "report",
    "gapath/recorders/rerun": "view",
    "gapath/survey": "image",
    "pipelines": "report",
}
"""Where an extra's packages may be imported: who comes there has asked for it (`test_light.py`)."""


def imports(root, top):
    """Third-party packages that are imported below a folder: path, and package."""
    known = {name: plain(of[0]) for name, of in metadata.packages_distributions().items()}
    for path in sorted((root / top).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = []
            if isinstance(node, ast.Import):
                names = [each.name for each in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module]
            for name in {each.partition(".")[0] for each in names} - {"gapath"}:
                if name in known:
                    yield path.relative_to(root).as_posix(), known[name]


def found():
    return {(path, name) for top in ("gapath", "pipelines") for path, name in imports(ROOT, top)}


def extra_of(name):
    return next((extra for extra in FOR_USERS if name in names_in(EXTRAS[extra])), None)


def place_of(path):
    places = [str(place) for place in (PurePosixPath(path), *PurePosixPath(path).parents)]
    return next((place for place in places if place in ASKED_FOR), None)


def test_what_is_declared_is_what_is_imported():
    used = {name for path, name in found() if not path.startswith("gapath/pipelines/")}
    declared = BASE.union(*(names_in(EXTRAS[extra]) for extra in FOR_USERS))
    assert used == declared


def test_an_extra_is_imported_only_where_it_was_asked_for():
    wrong = [
        f"{path}: {name}"
        for path, name in sorted(found())
        if name not in BASE and ASKED_FOR.get(place_of(path)) != extra_of(name)
        and not path.startswith("gapath/pipelines/")  # an sdist's copy of pipelines
    ]  # fmt: skip
    assert wrong == []


def test_every_place_needs_its_extra():
    needed = {place_of(path) for path, name in found() if name not in BASE}
    assert {*ASKED_FOR} <= needed


def test_all_is_all_that_users_can_have_without_a_gpu():
    (text,) = EXTRAS["all"]
    others = set(EXTRAS) - {"all", "bench", "cuda", "dev", "docs"}
    assert text == f"gapath[{','.join(sorted(others))}]"


def test_the_lock_has_what_is_declared():
    pinned = set(names_in((ROOT / "requirements.lock").read_text().splitlines()[1:]))
    of_others = {*names_in(EXTRAS["cluster"]), *names_in(EXTRAS["ray"]), "gapath"}
    declared = BASE.union(*map(names_in, EXTRAS.values()))
    assert declared - of_others <= pinned
