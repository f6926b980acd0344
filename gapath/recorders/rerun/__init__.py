"""Rerun recordings: one ``trial-<n>.rrd`` for each chosen trial."""

from gapath.recorders.rerun.recording import Recorder

__all__ = ["Recorder"]
