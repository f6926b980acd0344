"""How long a harness runs: briefly among all tests, at length by `make reliability`."""

import os


def rounds(short, long):
    """Give the second where GAPATH_RELIABILITY=long is set, else the first."""
    return long if os.environ.get("GAPATH_RELIABILITY") == "long" else short
