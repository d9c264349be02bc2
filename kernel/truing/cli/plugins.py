"""calc plugins: what is installed, from where, which version, what broke while loading."""

from __future__ import annotations

from dataclasses import asdict

from truing.cli.console import Settings, aligned, out, out_json
from truing.kernel import Kernel, Offer
from truing.texts import one_line


def plugins(settings: Settings, *, as_json: bool, strict: bool) -> int:
    """List what is installed, from where, which version, and what broke while loading."""
    kernel = Kernel.installed(strict=strict)
    offers = kernel.offers
    if as_json:
        out_json({"models": [_model(offer) for offer in offers.values()], "broken": list(map(asdict, kernel.broken))})
        return 0
    rows = [("model", "version", "from", "title")]
    for offer in offers.values():
        home = offer.origin.distribution or offer.origin.file
        rows.append((offer.name, offer.origin.version, home, one_line(offer.model.title)))
    out("\n".join(aligned(rows)))
    for offer in offers.values():
        for addition in offer.added:
            out(f"  {offer.name}: {addition.plugin} {addition.version} adds '{addition.what}'")
    for broken in kernel.broken:
        settings.say(f"warning: {broken}")
    return 0


def _model(offer: Offer) -> dict[str, object]:
    return {
        "name": offer.name,
        "title": offer.model.title,
        "plugin": offer.origin.name,
        "version": offer.origin.version,
        "distribution": offer.origin.distribution,
        "file": offer.origin.file,
        "added": [asdict(addition) for addition in offer.added],
    }
