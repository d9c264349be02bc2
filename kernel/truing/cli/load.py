"""From a word on the command line to a model: an installed plugin's name, or a Python file."""

from __future__ import annotations

from pathlib import Path

from truing.cli.console import Settings, say
from truing.errors import UnknownPluginError
from truing.kernel import Kernel, Offer


def find_offer(word: str, settings: Settings, *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins were left out."""
    kernel = Kernel.installed(strict=strict)
    if word.endswith(".py"):
        origin = kernel.add_file(Path(word))
        wanted = origin.name
    else:
        wanted = word
    offers = kernel.offers
    own = [broken for broken in kernel.broken if broken.plugin == wanted and wanted not in offers]
    if not settings.quiet:
        for broken in kernel.broken:
            if broken not in own:
                say(f"warning: {broken}")
    if word.endswith(".py"):
        own_models = [offer for offer in offers.values() if offer.origin.name == wanted]
        if len(own_models) == 1:
            return own_models[0]
        if len(own_models) > 1:
            names = ", ".join(offer.model.name for offer in own_models)
            raise UnknownPluginError(f"{word} offers several models ({names}); a file that is run offers one")
    return kernel.offer(wanted)
