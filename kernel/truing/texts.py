"""Text as it may be printed anywhere."""

from __future__ import annotations


def one_line(text: object) -> str:
    """Return a text as one printable line."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
