"""What maps, paths and histories look like, as functions that draw arrays, and in a notebook."""
