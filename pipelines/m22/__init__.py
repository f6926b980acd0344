"""Tables and figures of M22."""
