"""One name explained: what a result is made of and what moves it, what an input or an error source does."""

from truing.explain.names import SECTIONS, Kind, kind_of, known_names
from truing.explain.told import told

__all__ = ["SECTIONS", "Kind", "kind_of", "known_names", "told"]
