"""Does the claimed chance of a proposed experiment hold on fresh simulations? For a machine of three plugins.

Run it: ``python tests/benchmarks/bench_experiments.py [--draws 200] [--whole 40] [--only NAME]``. A record that leaves
several causes open is diagnosed, and the experiment that is proposed is simulated afresh, each explanation true in
turn: ``--draws`` times as the claim was made, and ``--whole`` times with the whole diagnosis of the record and the new
readings. There right is an answer that names the true one and nothing that the experiment is to exclude. The claim
holds where the share lies within its interval, and agrees with it where their intervals of 95 % overlap.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from truing.arrays import one_thread
from truing.diagnosis.choice import Chosen
from truing.diagnosis.engine import diagnose
from truing.diagnosis.extended import elsewhere
from truing.diagnosis.records import Records
from truing.diagnosis.result import DiagnosisResult, explanations_of
from truing.experiments.chances import DRAWS, Simulation, joined
from truing.experiments.duels import name_of
from truing.experiments.planning import planned
from truing.experiments.proposal import among, designed_for, grown
from truing.kernel import Kernel
from truing.setup import Setup
from truing.studies.checks import wilson
from truing.testing.hiding import recorded, records_of

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


def of_example(plugin: str, folder: str, data: str) -> tuple[Setup, Records]:
    """The record of an example page."""
    return made(plugin, *((EXAMPLES / folder / name).read_text("utf-8") for name in ("inputs.toml", data)))


def made(plugin: str, inputs: str, measured: str) -> tuple[Setup, Records]:
    """Inputs and records from their texts."""
    setup = recorded(Kernel.installed().offer(plugin).model, inputs=inputs, measured=measured).setup
    return setup, records_of(setup, measured, "measured.csv", with_unit_errors=False)


CASES: dict[str, Callable[[], tuple[Setup, Records]]] = {
    "press_linkage": lambda: of_example("press_linkage", "press_warm_links", "monday.csv"),
    "roller_screw_shift": lambda: of_example("roller_screw_shift", "roller_screw_rubs", "one_way.csv"),
}
PLANNED = {"rv_gearing": (("sun_runout", "sensor_drift"), 'noise = {transmission_error = "0.3 um"}')}
"""Plugins whose experiment is planned before any record: the causes, and how well is read."""


def planned_ahead(name: str, draws: int) -> None:
    """Print what is claimed of a planned experiment, and what fresh simulations of it say."""
    causes, noise = PLANNED[name]
    inputs = f'plugin = "{name}"\n[studies.diagnose]\n{noise}\n'
    setup = recorded(Kernel.installed().offer(name).model, inputs=inputs, measured="").setup
    chances = []
    for seed in range(1 + draws // DRAWS):  # the seed draws the chance, not the experiment
        experiment = planned(replace(setup, seed=setup.seed + 1000 * seed), causes).experiment
        assert experiment is not None
        chances.append(experiment.chance)
    claim, *fresh = chances
    print(f"{name}: {experiment.readings} readings tell {' / '.join(causes)} apart, planned before any record")
    print(f"  claimed {claim.value:.3f} [{claim.low:.3f}, {claim.high:.3f}]")
    say(
        "  as claimed, afresh",
        sum(round(each.value * DRAWS) for each in fresh),
        DRAWS * len(fresh),
        (claim.low, claim.high),
    )


def is_right(answer: DiagnosisResult, truth: str, excluded: set[str]) -> bool:
    """Whether an answer names the true explanation and none that the experiment is to exclude."""
    names = {" + ".join(sorted(names)) for names in explanations_of(answer)}
    return " + ".join(sorted(truth.split(" + "))) in names and not names & excluded


def measured(name: str, draws: int, whole: int) -> None:
    """Print what is claimed for a case, and what fresh simulations say."""
    begin = process_time()
    setup, records = CASES[name]()

    def propose(chosen: Chosen, answer: DiagnosisResult) -> DiagnosisResult:
        stand, found = designed_for(chosen)
        if stand is None or found is None:
            raise SystemExit(f"{name}: no experiment is proposed")
        found, claim = grown(stand, found, chosen.competition, has_record=True)
        apart = {frozenset(pair) for pair in found.pairs}
        machine = stand.machine_of([found.courses], found.readings)
        simulation = Simulation(chosen.competition, stand.several, among(stand, apart), machine, has_record=True)
        pairs = ", ".join(" / ".join(sorted(pair)) for pair in apart)
        print(f"{name}: {found.readings} readings tell {pairs} apart")
        ends = claim.low, claim.high
        print(f"  claimed {claim.value:.3f} [{claim.low:.3f}, {claim.high:.3f}]")
        fresh = simulation.chance(setup.seed + 1000, draws)
        say("  as claimed, afresh", round(fresh.value * draws), draws, ends)
        if whole:
            say("  whole diagnosis", sum(whole_is_right(setup, simulation, draw) for draw in range(whole)), whole, ends)
        return answer

    diagnose(setup, records, propose=propose)
    print(f"  {process_time() - begin:.0f} s of processor time")


def whole_is_right(setup: Setup, simulation: Simulation, draw: int) -> bool:
    """Diagnose the record with new readings in which one explanation is true, and judge."""
    names = [name_of(each.fit) for each in simulation.several]
    truths = sorted({place for pair in simulation.apart for place in pair})
    truth = truths[draw % len(truths)]
    tried = elsewhere(simulation.competition.extended, simulation.machine)
    generator = np.random.default_rng([setup.seed, 2000, draw])
    readings = {name: each[0] for name, each in simulation.readings_of(tried, truth, 1, generator).items()}
    sample = joined(simulation.competition.sample, simulation.machine, has_record=True)
    records = sample.machine.records
    both = {
        name: np.append(values[: len(values) - len(readings[name])], readings[name])
        for name, values in records.measured.items()
    }
    answer = diagnose(setup, replace(records, measured=both))
    others = (place for place in range(len(names)) if frozenset((truth, place)) in simulation.apart)
    return is_right(answer, names[truth], {" + ".join(sorted(names[place].split(" + "))) for place in others})


def say(what: str, right: int, draws: int, claim: tuple[float, float]) -> None:
    """Print a share with its interval, and whether it agrees with the claim."""
    low, high = wilson(right, draws)
    holds = low <= claim[1] and high >= claim[0]
    inside = claim[0] <= right / draws <= claim[1]
    print(f"{what}: {right} of {draws}, {right / draws:.3f} [{low:.3f}, {high:.3f}]: "
          f"{'within the interval' if inside else 'agrees with it' if holds else 'OFF'}")  # fmt: skip


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=200)
    parser.add_argument("--whole", type=int, default=40)
    parser.add_argument("--only", choices=[*CASES, *PLANNED], default="")
    options = parser.parse_args()
    for name in [options.only] if options.only else [*CASES, *PLANNED]:
        with one_thread():
            if name in PLANNED:
                planned_ahead(name, options.draws)
            else:
                measured(name, options.draws, options.whole)


if __name__ == "__main__":
    main()
