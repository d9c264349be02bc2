"""Plugins that tests write beside their inputs: the pin, with whatever its calculation shall do besides."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
OWN = '''"""The wear of a pin, and what this test adds."""

import os
import signal
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pin_wear import PIN_WEAR, Pin, Wear, wear

from truing import Model, Published, hookimpl
from truing.errors import ConvergenceError

EXAMPLE = Path(__file__).with_name("example.toml")
HEAD


def NAME(pin: Pin) -> Wear:
    """Do what the test wants, and calculate the wear."""
BODY
    return wear(pin)


@hookimpl
def truing_models() -> list[Model]:
    """Offer it."""
    example = EXAMPLE if EXAMPLE.exists() else None
    return [replace(PIN_WEAR, name="NAME", function=NAME, example=example, MORE)]
'''


def write_pin(folder: Path, name: str = "own_pin", *, head: str = "", body: str = "pass", more: str = "") -> Path:
    """Write the plugin: ``head`` stands above its function, ``body`` runs in it, ``more`` is said of its model."""
    (folder / PIN.name).write_text(PIN.read_text(encoding="utf-8"), encoding="utf-8")
    text = OWN.replace("HEAD", head).replace("BODY", indent(body, "    ")).replace("MORE", more).replace("NAME", name)
    path = folder / f"{name}.py"
    path.write_text(text, encoding="utf-8")
    return path
