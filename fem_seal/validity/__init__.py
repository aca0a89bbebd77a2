"""Checks of validity: where a result leaves the range of its theory."""
