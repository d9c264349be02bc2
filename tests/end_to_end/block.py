"""A small plugin that tests write beside their inputs, with whatever its calculation shall do."""

from __future__ import annotations

from pathlib import Path

BLOCK = '''"""A block that is pressed on a table and pushed."""

import time
from pathlib import Path

import numpy as np

from truing import (
    Float, Model, Published, Reliability, Require, Tolerance, feasible, found, given, hookimpl, inputs, normal, results,
)
from truing.errors import ConvergenceError

EXAMPLE = Path(__file__).with_name("example.toml")


@inputs
class Block:
    """What goes in."""

    load: Float = given(100.0, "N", symbol="F", note="pressing force", above=0)
    friction: Float = given(0.2, "", symbol="mu", note="coefficient of friction", above=0)


@results
class Slide:
    """What comes out."""

    drag: Float = found("N", symbol="R", formula="friction * load", note="force to push the block")


def block(given_: Block) -> Slide:
    """Multiply."""
    feasible(given_.friction < 1, "the block sticks: friction must be below 1")
    BODY
    return Slide(drag=given_.friction * given_.load)


@hookimpl
def truing_models() -> list[Model[Block, Slide]]:
    """Offer it."""
    return [
        Model(
            name="block", title="Pushed block", function=block, example=EXAMPLE if EXAMPLE.exists() else None,
            errors=[Tolerance("load", normal(sd="3 %"))], MORE
        )
    ]
'''


def write_block(folder: Path, *, body: str = "", more: str = "", name: str = "block.py") -> Path:
    """Write the plugin; ``body`` runs in its function, ``more`` is said of its model."""
    path = folder / name
    path.write_text(BLOCK.replace("BODY", body or "_ = time, np, ConvergenceError").replace("MORE", more))
    return path
