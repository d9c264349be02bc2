"""A setup as plain data, for a worker process that loads the plugin by its name; models are never pickled."""

from __future__ import annotations

import io
import pickle
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from truing.declare.chain import Link, chain_of
from truing.declare.fields import make
from truing.declare.model import Model
from truing.errors import PluginError
from truing.kernel import Kernel, Origin, chained_offer, kernel_for
from truing.kernel.loading import code_hash
from truing.setup import Setup, SwitchedOn

SCRIPT = "__main__"
"""The module that is the user's script, or notebook."""
_LOADING = threading.Lock()  # a worker may have several threads, and a plugin is loaded once


@dataclass(frozen=True)
class Packed:
    """What a worker needs to make the setup again: which plugin, which model, and everything else as bytes."""

    ref: str
    plugin: str
    model: str
    content: bytes
    links: tuple[Link, ...] = ()
    """What inputs of a chain are taken from."""
    code: str = ""
    """The hash of a plugin in one file: a worker may find another one there, or have loaded it before it changed."""


def pack(setup: Setup, *, studies: bool = False) -> Packed:
    """Turn a setup into plain data; spreads are packed only where they differ from the declared ones.

    With ``studies`` those that run travel too; what each gives is found again by its name.
    """
    declared = {name: tolerance.spread for name, tolerance in setup.model.tolerances.items()}
    running: Sequence[Any] = setup.studies if studies else ()
    content = {
        "inputs": setup.model.read_inputs(setup.inputs),
        "spreads": {name: spread for name, spread in setup.spreads.items() if spread != declared.get(name)},
        "correlations": setup.correlations,
        "conditions": dict(setup.conditions),
        "effects": [_plain_effect(active) for active in setup.effects],
        "calibrated": dict(setup.calibrated),
        "seed": setup.seed,
        "units": dict(setup.units),
        "studies": [replace(study, gives=None) for study in running],
    }
    origin, chain = setup.origin, chain_of(setup.model)
    links = () if chain is None else chain.links
    return Packed(origin.ref, origin.name, setup.model.name, _plain(content), links, _file_hash(origin.ref))


def _plain(content: Any) -> bytes:
    """Pickle so that equal contents are equal bytes: nothing is referred to by where it lies in memory."""
    stream = io.BytesIO()
    pickler = pickle.Pickler(stream, protocol=5)
    pickler.fast = True
    pickler.dump(content)
    return stream.getvalue()


def unpack(packed: Packed) -> Setup:
    """Make the setup again from the plugin that ``ref`` names. Raises PluginError where it offers no such model."""
    with _LOADING:
        if packed.code != _loaded_hash(packed.ref):
            raise PluginError(
                f"a worker has another {packed.ref.partition(':')[2]}; bring the same file there and start it again"
            )
        model, origin = _model(packed.ref, packed.plugin, packed.model, packed.links)
    content = pickle.loads(packed.content)  # after the plugin was loaded: its classes can be found now
    spreads = {name: tolerance.spread for name, tolerance in model.tolerances.items()}
    values = {model.input_fields[name].path: value for name, value in content["inputs"].items()}
    return Setup(
        model=model,
        origin=origin,
        inputs=make(model.input_type, values),
        spreads={**spreads, **content["spreads"]},
        correlations=content["correlations"],
        conditions=content["conditions"],
        effects=tuple(
            SwitchedOn(model.known_effects[name], values, sds, covariance)
            for name, values, sds, covariance in content["effects"]
        ),
        calibrated=content["calibrated"],
        seed=content["seed"],
        units=content["units"],
        studies=tuple(_with_gives(study, model) for study in content["studies"]),
    )


def travels(setup: Setup) -> bool:
    """Tell whether a setup can be packed with its studies.

    Nothing in it may be a function made on the fly, or of the user's script, which no worker executes.
    """
    try:
        return SCRIPT.encode() not in pack(setup, studies=True).content
    except Exception:
        return False


def _with_gives(study: Any, model: Model[Any, Any]) -> Any:
    declared = {study.name: study.gives for study in model.studies}
    return replace(study, gives=declared.get(study.name))


def _plain_effect(
    active: SwitchedOn,
) -> tuple[str, dict[str, float], dict[str, float], tuple[tuple[float, ...], ...]]:
    return active.effect.name, dict(active.values), dict(active.sds), active.covariance


def _file_hash(ref: str) -> str:
    kind, _, path = ref.partition(":")
    return code_hash(path) if kind == "file" else ""


@lru_cache(maxsize=8)
def _loaded_hash(ref: str) -> str:
    """Return the hash of a plugin's file as it was when this process loaded it."""
    return _file_hash(ref)


@lru_cache(maxsize=8)
def _kernel(ref: str) -> Kernel:
    return kernel_for(ref)


@lru_cache(maxsize=8)
def _model(ref: str, plugin: str, name: str, links: tuple[Link, ...]) -> tuple[Model[Any, Any], Origin]:
    for offer in _kernel(ref).offers.values():
        if offer.model.name == name and offer.origin.name == plugin:
            return chained_offer(offer, links).model, offer.origin
    broken = [str(left_out) for left_out in _kernel(ref).broken if left_out.plugin == plugin]
    raise PluginError(
        f"a worker process found no model '{name}' in {ref}: {broken[0] if broken else 'not offered there'}"
    )
