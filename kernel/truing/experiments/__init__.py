"""What to measure next, as an experiment that can be run: what is held, what is varied, how long, with which chance."""

BUDGET = 12
"""So many readings an experiment has where nobody says how many there may be."""
