"""Run folders: key, manifest, status, locks, files that survive."""
