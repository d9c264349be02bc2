"""From words on the command line to a calculation: an installed plugin's name or a Python file, and its inputs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from truing.cli.console import Settings
from truing.errors import UnknownPluginError
from truing.kernel import Kernel, Offer, demand_readable

if TYPE_CHECKING:
    from truing.setup import Setup


def find_offer(word: str, settings: Settings, *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins were left out."""
    kernel = Kernel.installed(strict=strict)
    if word.endswith(".py"):
        if not Path(word).is_file():
            raise UnknownPluginError(f"{word}: no such file")
        origin = kernel.add_file(Path(word))
        wanted = origin.name
    else:
        wanted = word
    offers = kernel.offers
    own = [broken for broken in kernel.broken if broken.plugin == wanted and wanted not in offers]
    for broken in kernel.broken:
        if broken not in own:
            settings.say(f"warning: {broken}")
    if word.endswith(".py"):
        own_models = [offer for offer in offers.values() if offer.origin.name == wanted]
        if len(own_models) == 1:
            demand_readable(own_models[0])
            return own_models[0]
        if len(own_models) > 1:
            names = ", ".join(offer.model.name for offer in own_models)
            raise UnknownPluginError(f"{word} offers several models ({names}); a file that is run offers one")
    return kernel.offer(wanted)


def read_or_example(
    offer: Offer, inputs: Path | None, changed: Sequence[str], *, word: str, settings: Settings
) -> Setup:
    """Return what the inputs file says, or the shipped example where none is named; ``word`` named the model."""
    from truing.example_file import example_text
    from truing.inputs_file import read_setup, setup_from_text

    if inputs is not None:
        return read_setup(inputs, offer, overrides=changed)
    settings.say(f"no --inputs: running the shipped example (calc init {word} writes it to a file)")
    shipped = offer.model.example
    file, folder = (str(shipped), shipped.parent) if shipped is not None else ("example.toml", Path.cwd())
    return setup_from_text(example_text(offer), offer, file=file, folder=folder, overrides=changed)
