"""A table of bolts: each a chain of elements that stretch elastically and flow, over rough surfaces that are flattened.

Length is balanced by iteration: what the nut has travelled is what bolt, plates and flattened peaks have given.
Steel after Ramberg and Osgood, W. Ramberg, W. R. Osgood, Description of stress-strain curves by three parameters,
NACA TN 902 (1943).
"""

import numpy as np
from scipy.optimize import brentq

from zoo.zoo import Array, Columns, drawn_size, hideable

HIDDEN = hideable(embedding="embedding", yielding="yielding")
NOISE = 0.5
"""Standard deviation of the force washer, kN."""
LEAD, AREA = 1.75, 84.3
"""Travel of the nut in a turn, mm; area of the thread, mm²."""
FULL = 60.0
"""Largest force that is tightened to, kN, as long as nothing flows."""
NEVER = 1e9
"""A proof stress that is never reached, MPa."""


def stretch(force: float, length: float, bolt: dict[str, float]) -> float:
    """How much longer bolt and plates make the way of the nut under a force, kN: mm.

    The bolt is nine elements, the one in the nut a little thinner; stress in MPa, 0.2 % at the proof stress.
    """
    areas = AREA * np.array([1.0] * 8 + [0.985])
    stress = 1e3 * force / areas
    strains = stress / bolt["elasticity"] + 0.002 * (stress / bolt["proof"]) ** bolt["power"]
    plates = bolt["plates"] * 1e3 * force / (AREA * bolt["elasticity"])
    return float(length * (np.mean(strains) + plates))


def flattened(force: float, interfaces: float, depth: float) -> float:
    """Length lost to peaks of the surfaces, mm: nearly all of it at a tenth of the full force."""
    return interfaces * depth * float(1 - np.exp(-force / (0.03 * FULL)))


def preload(angle: float, length: float, interfaces: float, warmer: float, bolt: dict[str, float]) -> float:
    """Force of one bolt, kN, after a turn of the nut by an angle, degrees.

    It grows with its temperature like the plates that it warms: ``warmer`` has next to no effect.
    """
    travel = LEAD * angle / 360 - 1e-7 * warmer * length

    def given_too_much(force: float) -> float:
        return stretch(force, length, bolt) + flattened(force, interfaces, bolt["depth"]) - travel

    return float(brentq(given_too_much, 0.0, 3 * FULL, xtol=1e-9))


def bolt_with(hidden: str | None, generator: np.random.Generator) -> dict[str, float]:
    """A bolt: MPa, mm, pure numbers; sizes are those of the force that is missing at a length of 50 mm."""
    bolt = {
        "elasticity": 205e3 * (1 + 0.01 * generator.standard_normal()),
        "plates": 0.25 + 0.02 * generator.standard_normal(),
        "proof": NEVER,
        "power": generator.uniform(14, 25),
        "depth": 0.0,
    }
    if hidden in ("embedding", "embedding_and_yielding"):
        missing = drawn_size(generator) * NOISE
        bolt["depth"] = missing * stretch(1.0, 30.0, bolt) / 5
    if hidden in ("yielding", "embedding_and_yielding"):
        missing = drawn_size(generator) * NOISE
        travel = stretch(FULL, 50.0, bolt)

        def lacking(logarithm: float) -> float:
            return stretch(FULL - missing, 50.0, bolt | {"proof": float(np.exp(logarithm))}) - travel

        bolt["proof"] = float(np.exp(brentq(lacking, np.log(50.0), np.log(5000.0))))
    return bolt


def table(generator: np.random.Generator, rows: int, bolt: dict[str, float]) -> tuple[Array, Array, Array, Array]:
    """Angles in degrees, clamped lengths in mm, interfaces, and how much warmer the bolts are, K; in no order."""
    lengths = generator.choice([30.0, 40.0, 50.0, 65.0, 80.0], rows)
    interfaces = generator.integers(2, 6, rows).astype(np.float64)
    warmer = generator.uniform(0, 12, rows)
    elastic = bolt | {"proof": NEVER}
    aims = FULL * generator.uniform(0.2, 1.0, rows)
    travels = [stretch(*row, elastic) for row in zip(aims.tolist(), lengths.tolist(), strict=True)]
    return np.round(360 * np.array(travels) / LEAD, 1), lengths, interfaces, warmer


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """One row for each bolt that was tightened and read."""
    bolt = bolt_with(hidden, generator)
    angles, lengths, interfaces, warmer = table(generator, rows, bolt)
    settings = zip(angles.tolist(), lengths.tolist(), interfaces.tolist(), warmer.tolist(), strict=True)
    return {
        "turned [deg]": angles,
        "clamp_length [mm]": lengths,
        "interfaces [-]": interfaces,
        "bolt_warmer [K]": warmer,
        "preload [kN]": np.array([preload(*row, bolt) for row in settings]),
    }
