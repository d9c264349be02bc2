"""What does a record cost: a pendulum with dry friction, with ever more readings of the same swings.

Run it: ``python -m pytest tests/benchmarks/bench_motion.py -s``. A record is one calculation, so that readings cost
what reading and comparing them costs, and no steps: ten times the readings take less than ten times as long.
"""

from itertools import count as count_from
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from timed import least

import truing
from end_to_end.simulated import module_of

HOME = Path(__file__).parents[2] / "docs" / "examples" / "geared_pendulum"
READINGS = (63, 630, 6300)
SECONDS = 4.0
"""Of each record: three swings."""


def test_readings_cost_less_than_in_proportion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One call of the model, the gauge at every row, and a whole diagnosis, by readings."""
    monkeypatch.chdir(tmp_path)
    pendulum, simulate, seconds = truing.load(HOME / "geared_pendulum.py"), module_of(HOME / "simulate.py"), {}
    anew = count_from(1)  # what was followed before is known
    for count in READINGS:
        times = np.linspace(0, SECONDS, count)
        simulate.write(f"{count}.csv", 1.2, 60.5, times.tolist(), 11)
        record = truing.read([tmp_path / f"{count}.csv"], pendulum)
        called = least(lambda times=times: pendulum.run(times=times, coulomb=f"{0.11 + 1e-9 * next(anew)} N*m"))
        found = least(lambda record=record: pendulum.diagnose(record, progress=False), rounds=1)
        seconds[count] = called[0], found[0]
        print(f"{count:6d} readings: one run {called[0]:.3f} s, diagnosis {found[0]:.1f} s")
    for few, many in pairwise(READINGS):
        for place in range(2):
            assert seconds[many][place] < 10 * seconds[few][place]
