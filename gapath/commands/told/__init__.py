"""What the command tells without doing a run: help, lists, pictures, completions."""
