"""calc plugins: what is installed, from where, which version, what broke while loading."""

from __future__ import annotations

import typer

from truing.cli.console import columns, one_line, out, out_json, say, verb
from truing.kernel import Kernel, entry_points


@verb
def plugins(
    context: typer.Context,
    names: bool = typer.Option(False, "--names", help="Names only, from metadata; nothing is loaded."),
    as_json: bool = typer.Option(False, "--json", help="One JSON document on stdout."),
    strict: bool = typer.Option(False, "--strict", help="End at the first broken plugin."),
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
    for offer in offers.values():
        rows.append((offer.name, offer.origin.version, offer.origin.distribution or offer.origin.file, one_line(offer.model.title)))
    out(columns(rows))
    for offer in offers.values():
        for item in offer.added:
            out(f"  {offer.name}: {item.plugin} {item.version} adds '{item.what}'")
    for broken in kernel.broken:
        say(f"warning: {broken}")
    return 0


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
            {"plugin": item.plugin, "version": item.version, "file": item.file, "line": item.line, "reason": item.reason}
            for item in kernel.broken
        ],
    }
