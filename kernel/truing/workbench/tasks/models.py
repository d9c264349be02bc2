"""What can be calculated: installed models, and the example of one."""

from __future__ import annotations

from typing import Any

from truing.example_file import text_to_fill_in
from truing.kernel import Kernel, offer_of


def installed() -> list[dict[str, Any]]:
    """Return name, title and summary of every installed model."""
    return [
        {"name": offer.name, "title": offer.model.title, "summary": offer.model.summary}
        for offer in Kernel.installed().offers.values()
    ]


def example(plugin: str) -> str:
    """Return the inputs file that ``calc init`` writes."""
    return text_to_fill_in(offer_of(plugin, lambda text: None))
