"""Records of a screw drive in which nothing is wrong but the noise, by seed; and what a diagnosis decides on them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from diagnosis_models import CONTACT, SHAFT, Array, Asked, decided, drive_model, wander, warming, wide

GROSS_SHARE, GROSS_SIZE = 0.05, 6.0
NOISES = ("gaussian", "heavy", "wandering", "growing")
DESIGNS = ("wide", "narrow", "warming")


def noise_of(kind: str, rng: np.random.Generator, load: Array) -> Array:
    """Noise of unit standard deviation: normal, t with 3 degrees of freedom, AR(1), or growing with the load."""
    n = len(load)
    if kind == "heavy":
        return np.asarray(rng.standard_t(3, n) / np.sqrt(3))
    if kind == "wandering":
        return wander(rng, n, rng.uniform(0.3, 0.8))
    if kind == "growing":
        spread = 0.3 + np.abs(load) / np.abs(load).max()
        return np.asarray(rng.normal(0, 1, n) * spread / np.sqrt(np.mean(spread**2)))
    return rng.normal(0, 1, n)


def nothing_wrong(noise: str, seed: int) -> dict[str, Array]:
    """A record in which nothing is wrong: a machine within its tolerances, a design and a length by chance, noise."""
    rng = np.random.default_rng([seed, NOISES.index(noise)])
    n, design = int(rng.choice([80, 150, 300])), str(rng.choice(DESIGNS))
    bench = (warming if design == "warming" else wide)(n, seed=seed, turning=True)
    if design == "narrow":
        bench = replace(bench, load=np.abs(bench.load) / 4 + 8, travel=100 + bench.travel / 6)
    contact, shaft = CONTACT * (1 + 0.03 * rng.normal()), SHAFT * (1 + 0.03 * rng.normal())
    return bench.shown(noise_of(noise, rng, bench.load), contact=contact, shaft=shaft)


def gross_errors(seed: int) -> tuple[dict[str, Array], set[int]]:
    """A record in which nothing is wrong but 5 % of the rows, all too high by six standard deviations; and which."""
    rng = np.random.default_rng([18, seed])
    bench = wide(150, seed=seed, turning=True)
    contact, shaft = CONTACT * (1 + 0.03 * rng.normal()), SHAFT * (1 + 0.03 * rng.normal())
    noise = rng.normal(0, 1, len(bench))
    wrong = rng.permutation(len(bench))[: round(GROSS_SHARE * len(bench))]
    noise[wrong] += GROSS_SIZE
    return bench.shown(noise, contact=contact, shaft=shaft), set(wrong.tolist())


def decision_on(columns: dict[str, Array], folder: Path, seed: int) -> tuple[bool, float]:
    """Whether anything was named or called unknown, and the significance of the whole search."""
    asked = Asked(drive_model(), seed=seed)
    chosen = decided(asked.setup, asked.records(folder, columns))
    return bool(chosen.best.causes), chosen.p_any
