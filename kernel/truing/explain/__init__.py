"""One name explained: what a result is made of and what moves it, what an input or an error source does."""

from truing.explain.told import SECTIONS, told

__all__ = ["SECTIONS", "told"]
