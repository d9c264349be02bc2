"""calc plugins: what is installed, from where, which version, what broke while loading."""

from __future__ import annotations

from typing import Annotated

import typer

from truing.cli.console import columns, one_line, out, out_json, settings_of, verb
from truing.cli.words import AsJson
from truing.kernel import Kernel, Offer, entry_points


@verb
def plugins(
    context: typer.Context,
    names: Annotated[bool, typer.Option("--names", help="Names only, from metadata; nothing is loaded.")] = False,
    as_json: AsJson = False,
    strict: Annotated[bool, typer.Option("--strict", help="End at the first broken plugin.")] = False,
) -> int:
    """List what is installed, from where, which version, and what broke while loading."""
    if names:
        for entry in entry_points():
            out(entry.name)
        return 0
    kernel = Kernel.installed(strict=strict)
    offers = kernel.offers
    if as_json:
        out_json(_document(kernel))
        return 0
    rows = [("model", "version", "from", "title")]
    rows += [(offer.name, offer.origin.version, _home(offer), one_line(offer.model.title)) for offer in offers.values()]
    out(columns(rows))
    for offer in offers.values():
        for item in offer.added:
            out(f"  {offer.name}: {item.plugin} {item.version} adds '{item.what}'")
    for broken in kernel.broken:
        settings_of(context).say(f"warning: {broken}")
    return 0


def _home(offer: Offer) -> str:
    return offer.origin.distribution or offer.origin.file


def _document(kernel: Kernel) -> dict[str, object]:
    return {
        "models": [
            {
                "name": offer.name,
                "title": offer.model.title,
                "plugin": offer.origin.name,
                "version": offer.origin.version,
                "distribution": offer.origin.distribution,
                "file": offer.origin.file,
                "added": [{"what": item.what, "plugin": item.plugin, "version": item.version} for item in offer.added],
            }
            for offer in kernel.offers.values()
        ],
        "broken": [
            {
                "plugin": item.plugin,
                "version": item.version,
                "file": item.file,
                "line": item.line,
                "reason": item.reason,
            }
            for item in kernel.broken
        ],
    }
