"""What gapath is measured against."""
