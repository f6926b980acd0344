"""Run folders, trials and logs, as sections read them."""
