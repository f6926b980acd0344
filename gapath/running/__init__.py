"""From a configuration to a checked run, to trials, to a folder."""
