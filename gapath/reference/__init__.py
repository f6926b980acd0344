"""What settings, columns and messages mean, read from where they are declared."""
