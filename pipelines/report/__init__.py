"""The command gapath-report and its pages."""
