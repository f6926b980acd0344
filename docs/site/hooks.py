"""What mkdocs does not do by itself: what lies outside of docs/, and notebooks with what they show.

A page of docs/ keeps its place in the site. Whatever else a page leads to is there under project/,
at its place in the project: Markdown as a page, text as a page that shows it, anything else as it
is. So each link leads somewhere here as it does in the project's folder.
"""

import os
import re
import sys
import tempfile
from pathlib import Path, PurePosixPath

import nbformat
from jupyter_client.manager import AsyncKernelManager
from mkdocs.structure.files import File
from nbclient import NotebookClient

ROOT = Path(__file__).parents[2]
PAGES = ["CONTRIBUTING.md", "CHANGELOG.md", "examples/README.md"]
"""Pages that are in the site even where no other leads to them."""
NOTEBOOKS = ["examples/plan.ipynb", "examples/sweep.ipynb", "examples/drive.ipynb"]
LANGUAGES = {".py": "python", ".sql": "sql", ".toml": "toml", ".yaml": "yaml"}
"""Text that has a page of its own, by the ending of its file's name."""

_FENCED = re.compile(r"(^(```+).*?^\2$)", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(?<=\]\()([^)\s#:]+)(?=[#)])")

_shown = {}
"""What cells of notebooks put out, as HTML: the place that the page keeps for it -> HTML."""


def place_of(path):
    """Give the place in the site of a file of the project, as mkdocs names sources."""
    path = PurePosixPath(path)
    if path.parts[0] == "docs":
        return str(path.relative_to("docs"))
    if path.suffix == ".ipynb":
        return f"tutorial/{path.stem}.md"
    return f"project/{path}{'.md' if path.suffix in LANGUAGES else ''}"


def led_to(path, text):
    """Give the files of the project that a page links to, as (link, file)."""
    for part in _FENCED.split(text)[::3]:
        for link in _LINK.findall(part):
            target = (ROOT / path).parent / link
            if target.is_file():
                yield link, target.resolve().relative_to(ROOT)


def relinked(path, text):
    """Give a page of the project with its links as they are in the site."""
    here = PurePosixPath(place_of(path)).parent
    there = {link: os.path.relpath(place_of(file), here) for link, file in led_to(path, text)}
    parts = _FENCED.split(text)
    del parts[2::3]  # the fences by themselves
    for i in range(0, len(parts), 2):
        parts[i] = _LINK.sub(lambda found: there.get(found[1], found[1]), parts[i])
    return "".join(parts)


def executed(path):
    """Run a notebook in an empty folder, and give it as a page: cells, and what they show."""
    notebook = nbformat.read(ROOT / path, as_version=4)
    with tempfile.TemporaryDirectory(prefix="gapath-") as folder:
        kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=f"{folder}/kernel")
        where = {"metadata": {"path": folder}}
        NotebookClient(notebook, km=kernel, resources=where).execute(cleanup_kc=True)
    parts = []
    for number, cell in enumerate(notebook.cells):
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for index, output in enumerate(cell.outputs):
            parts.append(shown(output, f"out-{PurePosixPath(path).stem}-{number}-{index}"))
    name = PurePosixPath(path).name
    parts.append(f"This page is the notebook [{name}](../project/{path}).")
    return "\n\n".join(parts)


def shown(output, name):
    """Give an output of a cell as Markdown; HTML comes when the page is made."""
    if output.output_type == "stream":
        return f"```text\n{output.text.rstrip()}\n```"
    if "text/html" in output.data:
        html = output.data["text/html"]
    elif "image/png" in output.data:
        html = f'<img alt="" src="data:image/png;base64,{output.data["image/png"].strip()}">'
    else:
        return f"```text\n{output.data['text/plain']}\n```"
    _shown[name] = html
    return f'<div class="output" id="{name}"></div>'


def on_files(files, config):
    """Add what pages lead to outside of docs/, and the notebooks."""
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for path in NOTEBOOKS:
        files.append(File.generated(config, place_of(path), content=executed(path)))
        files.append(File.generated(config, f"project/{path}", abs_src_path=str(ROOT / path)))
    own = [file for file in files.documentation_pages() if not file.generated_by]
    pages = [Path("docs", file.src_uri) for file in own]
    pages += map(Path, PAGES)
    seen = {*pages}
    for page in pages:  # which grows
        text = (ROOT / page).read_text("utf-8")
        if page.parts[0] != "docs":
            files.append(File.generated(config, place_of(page), content=relinked(page, text)))
        for _, file in led_to(page, text):
            if file in seen or file.parts[0] == "docs" or file.suffix == ".ipynb":
                continue
            seen.add(file)
            if file.suffix == ".md":
                pages.append(file)
            else:
                files.append(added(file, config))
    return files


def added(file, config):
    """Give a file of the project that is no page: text as a page that shows it."""
    language = LANGUAGES.get(file.suffix)
    if language is None:
        return File.generated(config, place_of(file), abs_src_path=str(ROOT / file))
    text = (ROOT / file).read_text("utf-8").rstrip()
    content = f"---\nsearch:\n  exclude: true\n---\n\n# {file}\n\n````{language}\n{text}\n````\n"
    return File.generated(config, place_of(file), content=content)


def on_page_markdown(markdown, page, config, files):
    """Let the links of a page of docs/ lead to where the site has these files."""
    if page.file.generated_by:
        return markdown
    return relinked(Path("docs", page.file.src_uri), markdown)


def on_page_content(html, page, config, files):
    """Put in what cells show."""
    for name, content in _shown.items():
        place = f'<div class="output" id="{name}"></div>'
        html = html.replace(place, f'<div class="output">{content}</div>')
    return html
