"""Several pairs of start and target on one map: as a file lists them, or drawn."""
