"""What stands in a case file: tables with their checks, no solver and no words for people."""
