"""How long a test runs: briefly among all tests, or at length."""

import os


def rounds(short, long):
    """Give the second where GAPATH_RELIABILITY=long is set, as by `make reliability`."""
    return long if os.environ.get("GAPATH_RELIABILITY") == "long" else short


def whole(short, long):
    """Give the second where GAPATH_TESTS=long is set, as by `make test-long`."""
    return long if os.environ.get("GAPATH_TESTS") == "long" else short
