"""What each answer adds to files and report."""
