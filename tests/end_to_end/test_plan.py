"""calc plan: an experiment before any data, its file to fill in, and what is refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from test_file_formats import demand

from shared import ROOT, Calc
from truing import Plan, load

SPRING = ROOT / "docs" / "examples" / "coil_spring.py"
BOX = 'studies.diagnose.box={compression="1..10 mm", spring_temperature="20..120 degC"}'
ASKED = ("plan", SPRING, "--causes", "softening,thermal_drift", "--set", BOX, "-q")


def test_a_plan_is_a_sentence_a_file_and_a_document_and_from_python_the_same(calc: Calc, tmp_path: Path) -> None:
    """A spring that softens loses more the farther it is compressed; a gauge that drifts does not."""
    answer = calc(*ASKED, "--noise", "force=0.02 N", "-o", "readings.csv", "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    demand("plan", document)
    experiment = document["experiment"]
    assert set(experiment["tells"]) == {"softening", "thermal_drift"}
    assert all(course["way"] != "held" for course in experiment["courses"].values())
    assert experiment["chance"]["value"] > 0.9
    rows = list(csv.reader((tmp_path / "readings.csv").read_text(encoding="utf-8").splitlines()))
    assert set(rows[0]) == {"compression [mm]", "spring_temperature [degC]", "force [N]"}
    assert len(rows) == 1 + experiment["readings"]
    assert all(row[rows[0].index("force [N]")] == "" for row in rows[1:])
    boxed = {"studies.diagnose.box": BOX.partition("=")[2]}
    plan = load(SPRING).plan(["softening", "thermal_drift"], noise={"force": 0.02}, set=boxed, progress=False)
    assert isinstance(plan, Plan)
    assert plan.document == document
    assert "apart with a chance of" in plan.sentences[0]
    assert plan.sentences[0] in repr(plan)
    assert "Readings to take" in plan._repr_html_()


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        (("--causes", "softenin,sensor_gain", "--noise", "force=1 N"), "has no effect 'softenin'"),
        (("--causes", "softening", "--noise", "force=1 N"), "tells two causes or more apart"),
        (("--causes", "softening,sensor_gain", "--noise", "force=1 N", "--budget", "1"), "a budget of 1 readings"),
        (("--causes", "softening,sensor_gain"), "no noise is known"),
        (("--causes", "softening,sensor_gain", "--noise", "force"), "write RESULT=SD"),
        (("--causes", "softening,sensor_gain", "--noise", "force=1 mm"), "'1 mm' is a length"),
        (("--causes", "softening,sensor_gain", "--noise", "force=0 N"), "is no standard deviation"),
        (("--causes", "softening,sensor_gain", "--noise", "rate=1 GN/mm"), "cannot be seen in rate"),
        (("--causes", "softening,sensor_gain", "--noise", "forse=1 N"), "Did you mean 'force'?"),
    ],
)
def test_what_cannot_be_planned_is_one_sentence(calc: Calc, asked: tuple[str, ...], sentence: str) -> None:
    answer = calc("plan", SPRING, *asked, "-q", "--set", BOX)
    assert (answer.code, answer.out) == (2, "")
    assert sentence in answer.err
    assert len(answer.err.strip().splitlines()) == 1
