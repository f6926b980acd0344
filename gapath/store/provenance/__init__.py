"""Where a run comes from: code, machine, what is installed, who asked for it."""
