"""Units that were probably written wrong in a header."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from truing.diagnosis.joining import Joined
from truing.diagnosis.records import Slip
from truing.setup import Setup

Answers = Mapping[str, Any]


def suspected_slips(joined: Joined, answers: Answers, setup: Setup) -> tuple[Slip, ...]:
    """Return none."""
    return ()
