"""Tables and figures of S04."""
