"""From a word to a model: an installed plugin's name, "plugin.model", or the path of a plugin in one file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from truing.errors import UnknownPluginError
from truing.kernel import Kernel, Offer, demand_readable


def offer_of(word: str, say: Callable[[str], None], *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins beside it were left out.

    Raises UnknownPluginError where there is no such model, PluginError where the plugin that is named is broken.
    """
    kernel = Kernel.installed(strict=strict)
    wanted = word
    if word.endswith(".py"):
        if not Path(word).is_file():
            raise UnknownPluginError(f"{word}: no such file")
        wanted = kernel.add_file(Path(word)).name
    offers = kernel.offers
    for broken in kernel.broken:
        if broken.plugin != wanted or wanted in offers:
            say(str(broken))
    if word.endswith(".py"):
        own = [offer for offer in offers.values() if offer.origin.name == wanted]
        if len(own) == 1:
            demand_readable(own[0])
            return own[0]
        if len(own) > 1:
            names = ", ".join(offer.model.name for offer in own)
            raise UnknownPluginError(f"{word} offers several models ({names}); a file that is run offers one")
    plugin, _, model = wanted.partition(".")
    is_named_whole = wanted not in offers and model in offers and offers[model].origin.name == plugin
    return kernel.offer(model if is_named_whole else wanted)
