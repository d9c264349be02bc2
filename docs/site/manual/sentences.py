"""The page of the sentences that a diagnosis says, from their table.

``python docs/site/manual/sentences.py`` writes the page.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from truing.diagnosis.sentences import CHAPTERS

PAGE = Path(__file__).parents[2] / "reference" / "sentences.md"
HEAD = """# What the sentences of a diagnosis mean

Sheet and terminal say what was found in sentences of these kinds. What stands in *italics* is filled in. The statistics
behind them are folded away below each chapter of the sheet, and stand in
[`diagnosis.json`](files/diagnosis.md) exactly; how they are made is told in
[How a diagnosis works](../explanation/diagnosis.md).
"""


def page() -> str:
    """Write the page: a table for each chapter."""
    return "\n".join([HEAD, *_chapters()])


def _chapters() -> Iterator[str]:
    for title, kinds in CHAPTERS.items():
        yield f"## {title}\n"
        yield "| it says | it means |"
        yield "|---|---|"
        yield from (f"| {_shown(kind.text)} | {kind.meaning} |" for kind in kinds.values())
        yield ""


def _shown(text: str) -> str:
    return re.sub(r"{(\w+)}", r"*\1*", text)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
