"""What does a sample cost through a chain beside the last calculation alone, and what a curve beside one point of it?

Run it on a quiet machine: ``python -m pytest tests/benchmarks/bench_chain.py -s``. The chain is the shipped one: the
first stage of a reducer gives the torque under which its discs wear. The baseline is ``rv_wear`` alone, with the very
torques that the chain has drawn as a column, so that it, too, follows the wear of every machine by itself. With one
torque for all machines that is followed once, which costs next to nothing: this is printed and decides nothing.
"""

from functools import partial
from pathlib import Path

import pytest
from timed import least

import truing
from rv_wear import wear
from truing.declare import remembered
from truing.evaluate import evaluate_rows
from truing.setup import Setup
from truing.studies.sampling import scatter_of

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "reducer_chain" / "inputs.toml"
MACHINES = 8192
WANTED = ["backlash", "max_pressure"]
TORQUE = "rv_gearing_output_torque"


@pytest.fixture(scope="module")
def chain() -> Setup:
    """The shipped example."""
    return truing.load("rv_wear").setup(EXAMPLE)


def calculated(setup: Setup, columns: dict[str, object]) -> None:
    """Calculate these machines, none of which is remembered."""
    wear.forget()
    remembered.forget()
    evaluate_rows(setup, columns, MACHINES, wanted=WANTED)


def test_a_sample_costs_little_more_than_in_the_last_calculation_alone(chain: Setup) -> None:
    """The first stage is a fifth of it; before, as now, the wear of machines that differ in torque is the rest."""
    drawn = dict(scatter_of(chain).draw(3, 0, MACHINES))
    known = evaluate_rows(chain, drawn, MACHINES, wanted=[TORQUE, "rv_gearing_ratio"]).results
    own = {name: values for name, values in drawn.items() if not name.startswith("rv_gearing_")}
    ratio = repr(float(known["rv_gearing_ratio"][0]))
    alone = truing.load("rv_wear").setup(total_ratio=ratio, output_speed="15 r/min", working_time="6000 h")
    torques: dict[str, object] = {**own, "output_torque": known[TORQUE]}
    through, beside, one = least(
        partial(calculated, chain, drawn), partial(calculated, alone, torques), partial(calculated, alone, own)
    )
    each = [f"{seconds / MACHINES * 1e6:.1f} µs" for seconds in (through, beside, one)]
    print(f"\na machine: chain {each[0]}, alone {each[1]} ({through / beside:.2f}), with one torque for all {each[2]}")
    assert through < 1.6 * beside


def test_a_curve_costs_few_times_one_point(chain: Setup) -> None:
    """At 25 working times the machines are followed once; they were 25 times."""
    model = truing.load("rv_wear")

    def run(points: str) -> None:
        wear.forget()
        remembered.forget()
        asked = {"studies.run": '["reliability"]', "studies.reliability.draws": str(MACHINES)}
        model.run(EXAMPLE, set={**asked, "studies.reliability.points": points}, progress=False)

    many, few = least(partial(run, "25"), partial(run, "2"))
    print(f"\nreliability of {MACHINES} machines: 25 points {many:.2f} s, 2 points {few:.2f} s ({many / few:.2f})")
    assert many < 2.5 * few
