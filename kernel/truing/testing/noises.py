"""What the gauge scatters: which results are measured, and how well."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.near_miss import near_miss
from truing.declare.specs import Axis
from truing.errors import TruingError
from truing.setup import Setup
from truing.units import difference_unit, read_quantity, split_quantity


@dataclass(frozen=True)
class RecordNoise:
    """A standard deviation in SI, or a share of the span of what is shown."""

    sd: float = 0.0
    share: float = 0.0

    def size(self, shown: NDArray[np.float64]) -> float:
        """Return the standard deviation for these readings, SI."""
        return self.sd or self.share * float(np.ptp(shown))


def noise_of(setup: Setup, said: Any, measure: str | Sequence[str] | None, faults: list[str]) -> dict[str, RecordNoise]:
    """Return the noise by measured result; what is wrong is added to ``faults``, a sentence each."""
    gauged = gauged_results(setup)
    named = [measure] if isinstance(measure, str) else list(measure or ())
    if said is None:
        like = f"{{'{named[0]}': ...}}" if named else "'0.1 kN'"
        faults.append(f"noise is missing: say how far the gauge scatters, noise={like}, or '1 %' of the span")
        return {}
    if isinstance(said, Mapping):
        texts = dict(said)
    else:
        names = named or _fitting(gauged, said, faults)
        texts = dict.fromkeys(names, said)
    found = {}
    for name, text in texts.items():
        if name not in gauged:
            is_result = name in setup.model.result_fields
            why = "is no result that a gauge can show" if is_result else f"is no result.{near_miss(name, gauged)}"
            faults.append(f"'{name}' {why}")
            continue
        try:
            found[name] = _read(text, gauged[name])
        except TruingError as error:
            faults.append(f"noise of '{name}': {error}")
            continue
        if not (found[name].sd > 0 or found[name].share > 0):
            faults.append(f"noise of '{name}': {text} is no scatter; every gauge has some, by which it is judged")
    missing = [name for name in named if name not in texts]
    if missing:
        faults.append(f"noise says nothing of {', '.join(missing)}, which is to be measured")
    return found


def gauged_results(setup: Setup) -> dict[str, str]:
    """Return the results that can be measured, with their units: numbers and curves."""
    fields = setup.model.own_result_fields
    return {name: item.unit for name, item in fields.items() if not isinstance(item.spec, Axis)}


def _fitting(gauged: Mapping[str, str], said: Any, faults: list[str]) -> list[str]:
    """Return the one result that a noise can be of; of several the only one that is in the very unit of the noise."""
    fits = [name for name, unit in gauged.items() if _is_share(said) or _fits(said, unit)]
    if isinstance(said, str) and len(fits) > 1 and not _is_share(said):
        same = [name for name in fits if gauged[name] == split_quantity(said).unit]
        fits = same if len(same) == 1 else fits
    if len(fits) == 1:
        return fits
    if fits:
        faults.append(f"noise {said!r} may be of {', '.join(fits)}: say which is measured, measure='{fits[0]}'")
    else:
        units = ", ".join(f"{name} in {unit or 'pure numbers'}" for name, unit in gauged.items())
        faults.append(f"noise {said!r} is of the kind of no result: {units}")
    return []


def _is_share(said: Any) -> bool:
    return isinstance(said, str) and said.strip().endswith("%")


def _fits(said: Any, unit: str) -> bool:
    try:
        _read(said, unit)
    except TruingError:
        return False
    return True


def _read(said: Any, unit: str) -> RecordNoise:
    """Read a standard deviation, a difference in the unit of the result, or a share of its span."""
    if _is_share(said):
        noise = RecordNoise(share=read_quantity(said, ""))
    else:
        noise = RecordNoise(sd=read_quantity(said if isinstance(said, str) else repr(said), difference_unit(unit)))
    return noise
