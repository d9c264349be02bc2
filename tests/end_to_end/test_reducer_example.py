"""The measured reducer of the manual: made again byte for byte, and what its page prints is what was hidden."""

from __future__ import annotations

import re

import make_reducer_example
from shown_in_docs import EXAMPLES, ROOT

EXAMPLE = EXAMPLES / "reducer_wears_slowly"
PAGE = ROOT / "docs" / "how-to" / "true_a_reducer.md"


def test_the_shipped_rows_are_those_that_the_script_makes() -> None:
    for name, text in make_reducer_example.files().items():
        assert (EXAMPLE / name).read_bytes() == text.encode()


def test_the_page_shows_two_names_of_one_curve_with_the_hidden_size() -> None:
    """The page is run elsewhere; here what it prints is compared with what was hidden."""
    (stated,) = re.findall(r"\*\*([\d.]+)\*\*", (EXAMPLE / "README.md").read_text(encoding="utf-8"))
    alone, opened = PAGE.read_text(encoding="utf-8").split("## With the wear of a flank")
    assert "One of 5 causes; this record cannot say which." in alone
    assert "One of 2 causes; this record cannot say which." in opened
    assert "is drawn alike by pin rolling or duty share." in opened
    ((low, high),) = re.findall(r"pin rolling, rolling \S+ \(95 %: ([\d.]+) … ([\d.]+)\)", opened)
    assert float(low) < float(stated) < float(high)
