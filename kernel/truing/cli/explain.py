"""calc explain: one result, input, effect or tolerance of a calculation, and what it has to do with the others."""

from __future__ import annotations

from pathlib import Path

import typer

from truing.api.model import LoadedModel
from truing.cli.console import Settings, out, out_json, settings_of
from truing.cli.explain_printed import lines_of
from truing.cli.load import LABEL, find_offer, say_example
from truing.cli.terminal_printer import width_of_page
from truing.errors import UsageError
from truing.explain import SECTIONS, told
from truing.inputs_file.culprit import told_by_line
from truing.kernel import Offer
from truing.progress import progress_bar


def explain(
    context: typer.Context,
    *,
    what: str,
    name: str,
    inputs: Path | None,
    changed: list[str] | None,
    as_json: bool,
) -> int:
    """Explain a result: formula, what it is made from, what moves it; or an input, an effect, a tolerance."""
    settings = settings_of(context)
    offer, wanted = _asked(what, name, settings)
    say_example(inputs, offer.name, settings)
    setup = LoadedModel(offer, tuple(changed or ()), label=LABEL).setup(inputs)
    with progress_bar(not settings.quiet) as progress, told_by_line(setup):
        document = told(setup, offer, wanted, progress=progress)
    if as_json:
        out_json(document)
    else:
        out("\n".join(lines_of(document, width_of_page())))
    return 0


def _asked(what: str, name: str, settings: Settings) -> tuple[Offer, str]:
    """Return the calculation and the name that the words mean."""
    if name:
        return find_offer(what, settings), name
    if what.endswith(".py"):
        raise UsageError(f"explain what of {what}? Write its name behind it: calc explain {what} RESULT")
    plugin, _, last = what.rpartition(".")
    outer, _, section = plugin.rpartition(".")
    if outer and section in SECTIONS:
        plugin, last = outer, f"{section}.{last}"
    if plugin:
        return find_offer(plugin, settings), last
    offer = find_offer(what, settings)
    first = next(iter(offer.model.result_fields))
    raise UsageError(
        f"explain what of {what}? Name it, as in calc explain {what}.{first}; calc describe {what} lists all"
    )
