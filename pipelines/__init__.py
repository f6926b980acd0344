"""From run folders to tables, figures and the report; the only place that knows pandas."""
