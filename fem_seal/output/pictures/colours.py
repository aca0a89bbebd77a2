"""Colours of the pictures."""

BLUE, ORANGE, GREEN, PURPLE, GREY, INK = "#1f5a99", "#c8501e", "#2f7d5b", "#7a4fa3", "#7b838f", "#1c2430"
FILL = "#dfe8f2"
