"""From words on the command line to a calculation: an installed plugin's name or a Python file, and its inputs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from truing.api.model import LoadedModel
from truing.cli.console import Settings
from truing.kernel import Offer, offer_of

LABEL = "--set"
"""What sentences about a value on the command line begin with."""


def find_offer(word: str, settings: Settings, *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins were left out."""
    return offer_of(word, lambda text: settings.say(f"warning: {text}"), strict=strict)


def find_model(
    word: str, settings: Settings, changed: Sequence[str] | None = None, language: str = ""
) -> LoadedModel:  # fmt: skip
    """Return the model that ``word`` names, with what ``--set`` changes in every run, and the language of its sheet."""
    return LoadedModel(find_offer(word, settings), stated_words(changed, language), label=LABEL)


def stated_words(changed: Sequence[str] | None, language: str) -> tuple[str, ...]:
    """Return what the command line states in place of the inputs file, in the words of ``--set``."""
    return (*(changed or ()), *([f"sheet.language={language}"] if language else []))


def say_example(inputs: Path | None, word: str, settings: Settings) -> None:
    """Say that the shipped example runs where no inputs file is named; ``word`` named the model."""
    if inputs is None:
        settings.say(f"no --inputs: running the shipped example (calc init {word} writes it to a file)")
