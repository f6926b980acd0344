"""Whether a run has to be done, or is there already, whole."""

from gapath.errors import InputError
from gapath.store.inputs import Inputs, unchanged
from gapath.store.records import WHOLE, Manifest, Status
from gapath.store.runfolder import RunFolder


def is_whole(folder: RunFolder, inputs: Inputs) -> bool:
    """Tell whether a run was finished and every file is as the manifest says.

    Parameters
    ----------
    folder : RunFolder
        Its folder.
    inputs : mapping
        The files that are in its key; others that it read only while it ran must be as they were.

    Returns
    -------
    bool
        False, too, if anything cannot be read.
    """
    try:
        known = Manifest.read(folder.path)
        late = {path: d for path, d in known.method_inputs.items() if path not in inputs}
        whole = all(folder.sha256(name) == entry.sha256 for name, entry in known.files.items())
        return whole and Status.read(folder.path).state in WHOLE and unchanged(late)
    except (OSError, InputError):
        return False
