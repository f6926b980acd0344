"""What generated maps are drawn by."""
