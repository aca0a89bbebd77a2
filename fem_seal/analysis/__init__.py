"""From a case to its numbers: one chain of solves with its accuracy, answers and intervals."""
