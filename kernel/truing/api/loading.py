"""Loading a model: the first call of a user."""

from __future__ import annotations

import warnings
from pathlib import Path

from truing.api.model import LoadedModel
from truing.kernel.finding import offer_of


def load(plugin: str | Path) -> LoadedModel:
    """Load a model: an installed plugin by its name, one model of several as "plugin.model", or a file (``.py``).

    Plugins that are broken are left out, with a warning each. Raises UnknownPluginError where there is no such model,
    PluginError where the plugin that is named is broken.
    """
    return LoadedModel(offer_of(str(plugin), lambda text: warnings.warn(text, stacklevel=4)))
