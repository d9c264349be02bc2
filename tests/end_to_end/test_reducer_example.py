"""The measured reducer of the manual: made again byte for byte, and diagnosed to what its README says."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import make_reducer_example
import pytest
from measured import calc_here, read_document
from shown_in_docs import EXAMPLES

EXAMPLE = EXAMPLES / "reducer_wears_slowly"


def test_the_shipped_rows_are_those_that_the_script_makes() -> None:
    for name, text in make_reducer_example.files().items():
        assert (EXAMPLE / name).read_bytes() == text.encode()


@pytest.mark.parametrize(("file", "left"), [("backlash.csv", 5), ("opened.csv", 2)])
def test_the_wear_of_a_flank_leaves_two_names_of_one_curve(file: str, left: int, tmp_path: Path) -> None:
    (stated,) = re.findall(r"\*\*([\d.]+)\*\*", (EXAMPLE / "README.md").read_text(encoding="utf-8"))
    desk = tmp_path / "desk"
    shutil.copytree(EXAMPLE, desk)
    answer = calc_here(desk, "diagnose", "rv_wear", "--inputs", "inputs.toml", "--data", file)
    assert answer.code == 0
    found = read_document(desk / "runs" / Path(file).stem)
    assert (found["verdict"], len(found["explanations"])) == ("one_of", left)
    if left > 2:
        assert found["next"][0]["measure"] == ["max_wear"]
    else:
        assert found["explanations"] == [["pin_rolling"], ["duty_share"]]
        low, high = found["causes"][0]["unknowns"]["rolling"]["interval95"]
        assert low < float(stated) < high
