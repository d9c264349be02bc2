"""Inputs that mean something only together: a convention, the places of an axis, a draw that knows a record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from truing import Float, Model, Tolerance, axis, column, drawn, found, given, inputs, loaded, results
from truing.errors import DeclarationError, InputError
from truing.gauge import one_machine, read_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.measurements import read_rows
from truing.setup import Setup
from truing.studies.sampling import scatter_of


def weight_in(path: Path) -> float:
    """A file that holds one number."""
    return float(path.read_text())


@inputs
class Beam:
    """A beam that is measured at some places; its load was measured too, with a known scatter."""

    load: Float = given(10.0, "N", symbol="F", stated_with="load_case")
    load_case: Literal["middle", "end"] = given("middle")
    slack: Float = given(0.0, "N", symbol="s")
    places: Float = given((0.0, 1.0, 2.0), "m", along="place")
    weighed: str = given("well", note="how the load was weighed")
    record: float | None = loaded(weight_in, default=None, note="of the balance")


@results
class Course:
    """The moment along the beam."""

    place: Float = axis("m", follows="places")
    moment: Float = found("N*m", along="place")


def beam(given_: Beam) -> Course:
    """Load times the square of the place: a straight line between far points would be wrong."""
    return Course(place=given_.places, moment=column(given_.load + given_.slack) * np.square(given_.places))


def scale(rng: Any, count: int, *, weighed: str) -> dict[str, Any]:
    """A bad balance scatters, a good one does not."""
    return {"slack": rng.normal(0.0, 0.5, count)} if weighed == "badly" else {}


BEAM = Model(
    name="beam",
    title="Beam",
    function=beam,
    errors=[Tolerance("balance", drawn(scale, of=["weighed"]), on=["slack"])],
)
OFFER = Offer("beam", BEAM, Origin("beam", "1.0", "", "", "module:beam"))


def setup(text: str) -> Setup:
    return setup_from_text(text, OFFER, file="beam.toml", folder=Path())


def test_an_input_whose_meaning_is_missing_is_refused_with_its_line() -> None:
    with pytest.raises(InputError) as caught:
        setup('[inputs]\nload = "3 N"\nslack = "1 kg"\n')
    first, second = str(caught.value).splitlines()
    assert first == "beam.toml:2: load means nothing without load_case; state load_case (middle, end) beside it"
    assert second.startswith("beam.toml:3: slack")


@pytest.mark.parametrize("text", ["", '[inputs]\nload_case = "end"\n', '[inputs]\nload = "3 N"\nload_case = "end"\n'])
def test_what_is_explained_or_not_stated_is_taken(text: str) -> None:
    assert setup(text).inputs.load_case in {"end", "middle"}


def test_a_wrong_meaning_is_one_fault_and_not_two() -> None:
    with pytest.raises(InputError) as caught:
        setup('[inputs]\nload = "3 N"\nload_case = "ende"\n')
    assert len(str(caught.value).splitlines()) == 1


@inputs
class Misspelt:
    """The companion is not there."""

    load: Float = given(10.0, "N", stated_with="loadcase")
    load_case: str = given("middle")


@inputs
class Alone:
    """It explains itself."""

    load: Float = given(10.0, "N", stated_with="load")


@results
class Lost:
    """An axis of what is no series."""

    place: Float = axis("m", follows="load")


def of_misspelt(given_: Misspelt) -> Lost:
    return Lost(place=np.zeros(1))


def of_alone(given_: Alone) -> Lost:
    return Lost(place=np.zeros(1))


@pytest.mark.parametrize(
    ("function", "sentence"),
    [
        (of_misspelt, "'load' is stated with 'loadcase', which is no other input"),
        (of_alone, "'load' is stated with 'load', which is no other input"),
        (of_alone, "the axis 'place' follows 'load', which is no input series"),
    ],
)
def test_what_goes_together_must_be_there(function: Any, sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence):
        Model(name="lost", title="Lost", function=function)


def test_a_result_is_calculated_where_it_was_measured(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("place [m],load [N]\n0.3,10\n7.5,10\n0.3,20\n,10\n")
    machine = one_machine(setup(""))
    shown = read_by_gauge(machine, read_rows(tmp_path / "rows.csv", OFFER, machine)).results["moment"]
    np.testing.assert_allclose(shown, [0.9, 562.5, 1.8, np.nan], rtol=1e-12)


def test_a_draw_sees_the_inputs_it_asks_for() -> None:
    assert scatter_of(setup("")).causes == ()
    badly = setup('[inputs]\nweighed = "badly"\n')
    assert badly.distributions()["balance"]["slack"].sd == pytest.approx(0.5, rel=0.02)
    drawn_ = scatter_of(badly).draw(1, 0, 4000)["slack"]
    assert np.std(drawn_) == pytest.approx(0.5, rel=0.05)
    changed = replace(badly, inputs=replace(badly.inputs, weighed="well"))
    assert scatter_of(changed).causes == ()


def by_record(rng: Any, count: int, *, record: float | None) -> dict[str, Any]:
    """A balance that wrote down how much it scatters."""
    return {} if record is None else {"slack": rng.normal(0.0, record, count)}


def test_a_draw_sees_a_file_and_that_there_is_none(tmp_path: Path) -> None:
    (tmp_path / "balance.txt").write_text("0.25")
    errors = [Tolerance("balance", drawn(by_record, of=["record"]), on=["slack"])]
    offer = Offer("beam", Model(name="beam", title="Beam", function=beam, errors=errors), OFFER.origin)
    assert setup_from_text("", offer, file="beam.toml", folder=tmp_path).distributions() == {}
    text = '[inputs]\nrecord = { file = "balance.txt" }\n'
    with_file = setup_from_text(text, offer, file="beam.toml", folder=tmp_path)
    assert with_file.distributions()["balance"]["slack"].sd == pytest.approx(0.25, rel=0.02)


def test_a_draw_asks_for_inputs_that_exist() -> None:
    with pytest.raises(DeclarationError, match="tolerance 'balance' names 'weight', which is no input"):
        Model(
            name="odd", title="Odd", function=beam,
            errors=[Tolerance("balance", drawn(scale, of=["weight"]), on=["slack"])],
        )  # fmt: skip
