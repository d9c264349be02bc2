"""The four verdicts and their words, apart from what calculates: the command line knows them before it loads that."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

State = Literal["passes", "proposed", "undecided", "fails"]
"""What is said of a limit and of a run: kept as stated, kept by a design that a study proposes, not decided, missed."""

EXIT_CODES: Mapping[State, int] = {"passes": 0, "proposed": 0, "undecided": 1, "fails": 1}
"""Exit codes by verdict, the best first."""
HEADLINES: Mapping[State, str] = {
    "passes": "Passes",
    "proposed": "Passes with the proposed changes, not as stated",
    "undecided": "Undecided",
    "fails": "Fails",
}
SHORT: Mapping[State, str] = {
    "passes": "pass",
    "proposed": "not as stated",
    "undecided": "UNDECIDED",
    "fails": "FAILS",
}
