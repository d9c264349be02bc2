"""From words on the command line to a calculation: an installed plugin's name or a Python file, and its inputs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from truing.cli.console import Settings
from truing.example_file import example_of
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Offer
from truing.kernel.finding import offer_of
from truing.setup import Setup


def find_offer(word: str, settings: Settings, *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins were left out."""
    return offer_of(word, lambda text: settings.say(f"warning: {text}"), strict=strict)


def read_or_example(
    offer: Offer, inputs: Path | None, changed: Sequence[str], *, word: str, settings: Settings
) -> Setup:
    """Return what the inputs file says, or the shipped example where none is named; ``word`` named the model."""
    if inputs is not None:
        return read_setup(inputs, offer, overrides=changed)
    settings.say(f"no --inputs: running the shipped example (calc init {word} writes it to a file)")
    text, file, folder = example_of(offer)
    return setup_from_text(text, offer, file=file, folder=folder, overrides=changed)
