import pytest

from gapath.pipelines.sweeps.pictures import curves, heat, many, shares


@pytest.fixture
def undrawn(monkeypatch):
    """Lay figures out, but do not draw them, which takes most of the time."""
    for module in (curves, heat, many, shares):
        monkeypatch.setattr(module, "render", lambda canvas: (b"svg", b"png"))
