"""Writes the pages that are made from the sources: ``python -m gapath.reference docs``."""

import sys
from pathlib import Path

from gapath.reference.pages import PAGES

if __name__ == "__main__":
    (folder,) = sys.argv[1:]
    for name, page in PAGES.items():
        Path(folder, name).write_text(page(), "utf-8")
