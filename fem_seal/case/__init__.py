"""Tables of the case file with their checks; no solver."""
