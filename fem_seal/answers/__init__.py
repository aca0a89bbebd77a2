"""Answers about a solved seal: accuracy, target, opening, form, particles, intervals, verdict."""
