"""Strength of screws by class."""

CLASSES = ["8.8", "10.9", "12.9"]
STRENGTHS = [640.0, 940.0]

STRENGTH = {name: STRENGTHS[place] for place, name in enumerate(CLASSES)}
