"""What is built once: the sdist from a copy of the checkout, the wheel from the sdist."""

import packages
import pytest


@pytest.fixture(scope="session")
def sdist(tmp_path_factory):
    """The sdist, and what its build said."""
    place = tmp_path_factory.mktemp("sdist")
    sources = packages.copy_of_checkout(place / "checkout")
    return packages.build("sdist", sources, place / "dist")


@pytest.fixture(scope="session")
def unpacked(sdist, tmp_path_factory):
    """The folder that the sdist holds."""
    return packages.unpacked(sdist[0], tmp_path_factory.mktemp("unpacked"))


@pytest.fixture(scope="session")
def wheel(unpacked, tmp_path_factory):
    """The wheel, and what its build said."""
    return packages.build("wheel", unpacked, tmp_path_factory.mktemp("wheel") / "dist")


@pytest.fixture(scope="session")
def light(wheel, tmp_path_factory):
    """A folder with gapath and what it needs, but no extra."""
    return packages.light(wheel[0], tmp_path_factory.mktemp("light"))
