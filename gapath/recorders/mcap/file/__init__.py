"""What lies in a log, byte by byte: its records, and its end."""
