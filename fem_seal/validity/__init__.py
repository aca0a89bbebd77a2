"""Where a result leaves the range of its theory: one check for each way out."""
