"""A surface whose measured depths decide: an input that has no default."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from truing import Float, Model, found, given, hookimpl, inputs, loaded, results


@dataclass(frozen=True)
class Surface:
    """A measured surface."""

    roughness: float


def read_surface(path: Path, factor: float = 1.0) -> Surface:
    """Read the depths, one per line, so many times."""
    return Surface(float(np.std(factor * np.loadtxt(path))))


@inputs
class Contact:
    """What goes in."""

    load: Float = given(3.0, "N", symbol="F", note="pressing force", above=0)
    surface: Surface = loaded(read_surface, note="measured flank")


@results
class Stiffness:
    """What comes out."""

    share: Float = found("", symbol="s", note="load over roughness")


def contact(given_: Contact) -> Stiffness:
    """Divide."""
    return Stiffness(share=given_.load / given_.surface.roughness)


@hookimpl
def truing_models() -> list[Model[Contact, Stiffness]]:
    """Offer it."""
    return [Model(name="worn_surface", title="Worn surface", function=contact)]
