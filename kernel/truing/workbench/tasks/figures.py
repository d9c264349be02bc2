"""Figures while one edits."""

from __future__ import annotations


def first(plugin: str, file: str, folder: str, text: str) -> str:
    """Return the figure of page one as SVG, or nothing where the model has none."""
    return ""
