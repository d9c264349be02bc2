"""Tasks that do to their process what a model might do to it."""

MODULES = ("deeds",)
