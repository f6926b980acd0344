"""The site of the pages: no warning, no request, a search that finds, and no page too wide."""

import hashlib
import os
import re
import subprocess
import sys

import pytest
from bound import ROOT

import gapath

pytest.importorskip("mkdocs")

CONFIG = ROOT / "docs" / "site" / "mkdocs.yml"
WIDE, PHONE = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
PAGES = [
    "index",
    "start",
    "tutorial/plan",
    "how-to/my-map",
    "results",
    "api",
    "maps",
    "project/CONTRIBUTING",
]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Build it as `make docs` does: a warning is an error."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "-f", CONFIG, "-d", folder]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder


def test_every_public_name_has_its_docstring_there(site):
    text = (site / "api.html").read_text("utf-8")
    for name in gapath.__all__:
        assert name == "__version__" or f'id="gapath.{name}"' in text, name


def test_what_pages_lead_to_outside_of_their_folder_is_there(site):
    text = (site / "project" / "conf" / "map" / "rosmap.yaml.html").read_text("utf-8")
    assert "resolution" in text or "free_weight" in text
    assert (site / "project" / "CONTRIBUTING.html").is_file()
    assert (site / "project" / "examples" / "plan.ipynb").is_file()


def test_the_tutorial_shows_what_its_cells_show(site):
    text = (site / "tutorial" / "plan.html").read_text("utf-8")
    assert text.count("data:image/png") > 5
    assert re.search(r"\d\.\d% above the optimum", text)


def test_the_script_that_is_kept_is_as_it_was_published():
    kept = CONFIG.parent / "vendor"
    digest = hashlib.sha256((kept / "iframe-worker.js").read_bytes()).hexdigest()
    assert digest in (kept / "README.md").read_text("utf-8")


@pytest.fixture
def opened(browser, site):
    """Open a page as a file; whatever it asks of another place, or says, must be nothing."""
    contexts, heard = [], []

    def open_(name, size=WIDE):
        context = browser.new_context(viewport=size)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: heard.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: heard.append(str(error)))
        page.on("request", lambda request: heard.append(request.url)
                if not request.url.startswith(("file:", "data:", "blob:")) else None)  # fmt: skip
        page.goto((site / f"{name}.html").as_uri())
        return page

    yield open_
    for context in contexts:
        context.close()
    assert heard == []


@pytest.mark.parametrize("size", [WIDE, PHONE], ids=["1280", "390"])
@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_no_wider_than_the_screen(opened, name, size):
    page = opened(name, size)
    assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]


@pytest.mark.parametrize(
    ("words", "found"),
    [("corner cutting", "Maps"), ("load_map", "API"), ("to metres", "Plan on my own map")],
)
def test_the_search_finds(opened, words, found):
    page = opened("index")
    page.keyboard.press("/")
    page.keyboard.type(words)
    results = page.locator(".md-search-result__list")
    results.locator("li").first.wait_for()
    assert found in results.inner_text()
