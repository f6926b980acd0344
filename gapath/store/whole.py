"""Whether a run has to be done, or is there already, whole."""

from gapath.errors import InputError
from gapath.store.inputs import unchanged
from gapath.store.records import TRIALS, Manifest
from gapath.store.runfolder import RunFolder
from gapath.store.status import WHOLE, Status


def is_whole(folder: RunFolder) -> bool:
    """Tell whether a run was finished, and its files and those it read late are as they were."""
    try:
        known = Manifest.read(folder.path)
        whole = TRIALS in known.files and all(
            folder.sha256(name) == entry.sha256 for name, entry in known.files.items()
        )
        return whole and Status.read(folder.path).state in WHOLE and unchanged(known.late_inputs)
    except (OSError, InputError):
        return False
