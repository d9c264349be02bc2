"""A theory page of the documentation: its tables, and whether it holds a sentence."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

EXPLAINED = Path(__file__).parents[2] / "docs" / "explanation"


@dataclass(frozen=True)
class Page:
    """The page of a plugin."""

    plugin: str

    @cached_property
    def text(self) -> str:
        return (EXPLAINED / f"{self.plugin}.md").read_text(encoding="utf-8")

    @cached_property
    def words(self) -> str:
        """The page in one line."""
        return " ".join(self.text.split())

    def row(self, start: str, after: str = "") -> list[str]:
        """The cells of the first row that starts so, without its first cell; ``after`` some words of the page."""
        lines = self.text[self.text.index(after) :].splitlines()
        line = next(each for each in lines if each.startswith(f"| {start}"))
        return [cell.strip() for cell in line.strip("|").split("|")][1:]

    def says(self, *sentences: str) -> None:
        """Fail where one of these sentences is not on the page."""
        assert [each for each in sentences if each not in self.words] == []


def number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".replace("-", "−")
