"""What is asked of a solved seal: accuracy, target, opening, form, particles, intervals, verdict."""
