"""What to measure next, as an experiment that can be run: what is held, what is varied, how long, with which chance."""
