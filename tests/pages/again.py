"""The commands and the Python of a page, done once more: what do they print now?"""

import io
import re
import runpy
import shlex
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path

from processes import forked

ROOT = Path(__file__).parents[2]

LEFT_OUT = {
    "make setup": "makes the environment that tests run in",
    "source .venv/bin/activate": "is of the shell",
    "cd examples": "tests run in a copy of that folder",
    "gapath -m map=kg18_test3 planner=ga1,ga2 trials=20 recorder=none hydra/launcher=joblib "
    "hydra.launcher.n_jobs=2 name=cores": "tests/commands/test_sweeps.py does: joblib's processes "
    "and the forks of these tests do not go together",
    "pip install -e .": "the fixture of tests/test_plugin.py installs the package",
}
"""Commands of pages that no test runs, and why."""

_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)

_VARIES = re.compile(
    r"\b[0-9a-f]{6,64}\b"  # keys
    r"|\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d\S*)?"
    r"|\d[\d.,]* (ns|us|ms|s|bytes|kB|MB|files)\b"
)
_DIFF = re.compile(r"^ *outputs/\S+\.diff\n", re.MULTILINE)
"""What a run keeps of a checkout whose files were changed."""


def same(new, shown):
    """Tell whether an output is what a page shows, but for keys, dates, times, sizes and counts.

    A line of three dots in the page stands for any lines.
    """
    new, shown = (re.sub(" +", " ", _VARIES.sub("*", text)) for text in (new, shown))
    parts = map(re.escape, re.split(r"^\.\.\.\n", shown, flags=re.MULTILINE))
    return re.fullmatch("(?:.*\n)*".join(parts), new) is not None


@dataclass
class Again:
    """What came of a page.

    Parameters
    ----------
    text : str
        The page.
    folder : Path
        Where its commands run.
    environment : dict of str to str
        What these find there besides.
    """

    text: str
    folder: Path
    environment: dict[str, str] = field(default_factory=dict)
    failed: dict[str, int] = field(default_factory=dict)
    """Commands whose exit code is not 0."""
    names: dict[str, object] = field(default_factory=dict)
    """What the Python of the page has defined."""

    def outputs(self):
        """Do all of it in order; give each block that shows an output as (shown, now)."""
        printed = None
        for language, block in _BLOCK.findall(self.text):
            if language == "console":
                yield block, self._commands(block)
            elif language in ("", "sh"):
                for line in block.replace("\\\n", "").splitlines():
                    self._command(line)
            elif language == "python":
                printed = self._python(block)
            elif language == "text" and printed:
                yield block, printed
                printed = None

    def _commands(self, block):
        shown = ""
        for line in block.splitlines():
            if line.startswith("$ "):
                shown += f"{line}\n{self._command(line[2:])}"
        return shown

    def _command(self, line):
        words = shlex.split(line, comments=True)
        if not words:
            return ""
        if shlex.join(words) in LEFT_OUT:
            return ""
        words = [name for word in words for name in self._globbed(word)]
        environment = {"COLUMNS": "120", "NO_COLOR": "1", "CI": "1"} | self.environment
        code, *texts = forked.run(words, self.folder, **environment)
        if code != 0:
            self.failed[line] = code
        lines = (line.rstrip() for text in texts for line in text.splitlines())
        return _DIFF.sub("", "".join(f"{line}\n" for line in lines))

    def _globbed(self, word):
        found = self.folder.glob(word) if "*" in word and "/" in word else ()
        return sorted(str(path.relative_to(self.folder)) for path in found) or [word]

    def _python(self, block):
        printed = io.StringIO()
        with chdir(self.folder), redirect_stdout(printed):
            Path("block.py").write_text(block, "utf-8")
            found = runpy.run_path("block.py", init_globals=self.names)
            self.names = {n: v for n, v in found.items() if not n.startswith("__")}
        return printed.getvalue()
