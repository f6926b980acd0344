"""From a question to whether groups of runs differ: `gapath-report compare`."""
