"""Long records: the search looks at some thousand rows, drawn evenly over the record; what it came to is fitted to all.

One row is drawn of every stretch of equal length, so that no wave of the record is folded into another one by a regular
step. The decision is that of these rows, and so is what is said of sizes that would be visible and of how far apart two
explanations lie, as if every row stood for as many as it was drawn from; estimates, intervals and gains are those of
all rows.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from truing.diagnosis.choice import Chosen, Rival
from truing.diagnosis.competition import competition_of
from truing.diagnosis.extended import Extended
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import Calibration
from truing.diagnosis.records import Records
from truing.diagnosis.sample import sample_of

LONG = 2500
"""A record of more readings is searched on about so many of them."""
RANKED = 8
"""So many of the best explanations are fitted to all rows beside the chosen one and its rivals."""


def searched(records: Records, *, seed: int) -> Records:
    """Return the rows that a search looks at: all of a record that is not long."""
    readings = sum(int(np.isfinite(values).sum()) for values in records.measured.values())
    if readings <= LONG or records.rows.series:
        return records
    rows = len(records) * LONG // readings
    edges = np.linspace(0, len(records), rows + 1).astype(np.intp)
    generator = np.random.Generator(np.random.SFC64(seed))
    return records.part(edges[:-1] + (generator.random(rows) * np.diff(edges)).astype(np.intp))


def on_all_rows(chosen: Chosen, machine: Calibration) -> Chosen:
    """Return what a search of some rows came to, fitted to all rows of a machine."""
    few = chosen.competition
    if len(few.sample.machine.records) == len(machine.records):
        return chosen
    sample = sample_of(machine, first_noise(machine), ~machine.records.held_out)
    competition = competition_of(Extended(machine), few.causes, sample)
    competition.stage, competition.extended.grain = "fits to all rows", few.extended.grain
    competition.extended.budget = few.extended.budget.of_rows(len(machine.records) / len(few.sample.machine.records))
    competition.tries = dict(few.tries)
    few.gains_seen = {}  # much, and needed no more
    rivals_there = [few.known[rival.fit.key] for rival in chosen.rivals]
    wanted = [few.known[chosen.best.key], *rivals_there, *few.ranked()[:RANKED]]
    for fit in {fit.key: fit for fit in wanted}.values():
        competition.fitted(fit.causes, fit.values, None)
    competition.renew()
    competition.refresh()
    best = competition.known.get(chosen.best.key, competition.null)
    ends = [
        competition.exact(competition.known[rival.fit.key])
        for rival in chosen.rivals
        if rival.fit.key in competition.known
    ]
    rivals = tuple(Rival(fit, max(0.0, competition.score(fit) - competition.score(best))) for fit in ends)
    return replace(chosen, competition=competition, best=competition.exact(best), rivals=rivals, of_some_rows=chosen)
