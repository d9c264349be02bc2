"""Records in which something is hidden: what stands in them, held against the laws by hand, and what is refused."""

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pin_wear import PIN_WEAR, Pin, Wear

from truing import Condition, Effect, Float, Model, Sweep, Unknown, Vary, axis, column, found, given, inputs, results
from truing.errors import InputError
from truing.testing import Calc, Hidden, hide

OVER = {"load": "50..200 N", "time": "1..400 h", "probe_temperature": "15..40 degC"}
NOISE = {"depth": "1 um"}


def hidden(effect: str | None = "warm_probe", size: Any = "1 um/K", **more: Any) -> Hidden:
    return hide(effect, size, **{"noise": NOISE, "model": PIN_WEAR, "over": OVER, **more})


def read(text: str) -> dict[str, Any]:
    """The columns of a CSV by name, as numbers where they are numbers."""
    rows = list(csv.DictReader(io.StringIO(text)))
    columns = {name.partition(" [")[0]: [row[name] for row in rows] for name in rows[0]}
    return {name: _numbers(cells) for name, cells in columns.items()}


def _numbers(cells: list[str]) -> Any:
    try:
        return np.array([float(cell) for cell in cells])
    except ValueError:
        return cells


def worn_um(load: Any, hours: Any, hardness: float = 2.1e9) -> Any:
    """Archard by hand: 3e-8 F v t / (A H) at 0.5 m/s on any area that takes the load."""
    return 3e-8 * load / 28e-6 * 0.5 * hours * 3600 / hardness * 1e6


def left_of(text: str, slope: float = 0.0) -> Any:
    it = read(text)
    return it["depth"] - worn_um(it["load"], it["time"]) - slope * (it["probe_temperature"] - 20)


def test_a_record_is_the_law_with_the_effect_and_the_noise() -> None:
    it = hidden(rows=400)
    for text, count in ((it.measured, 400), (it.held_out, 200)):
        left = left_of(text, slope=1.0)
        assert len(left) == count
        assert abs(np.mean(left)) < 4 / np.sqrt(count)
        assert np.std(left) == pytest.approx(1.0, abs=4 / np.sqrt(2 * count))
    assert it.noise["depth"] == pytest.approx(float(np.sqrt(np.mean(left**2))) * 1e-6, rel=1e-2)
    assert it.truth == {"slope": pytest.approx(1e-6)}
    assert it.measured.splitlines()[0] == "load [N],time [h],probe_temperature [degC],depth [um]"


def test_ranges_are_filled_evenly_and_time_rises() -> None:
    it = read(hidden(rows=64).measured)
    for name, low, high in (("load", 50, 200), ("probe_temperature", 15, 40)):
        assert np.all((low <= it[name]) & (it[name] <= high))
        assert np.all(np.histogram(it[name], bins=8, range=(low, high))[0] >= 5)
    assert np.all(np.diff(it["time"]) > 0)
    assert abs(np.corrcoef(it["load"], it["probe_temperature"])[0, 1]) < 0.2


def test_the_seed_is_the_record() -> None:
    one, again, other = hidden(seed=0), hidden(seed=0), hidden(seed=1)
    assert (one.measured, one.held_out) == (again.measured, again.held_out)
    assert not set(one.measured.splitlines()[1:]) & set(other.measured.splitlines()[1:])
    assert not set(one.measured.splitlines()[1:]) & set(one.held_out.splitlines()[1:])


def test_noise_is_the_same_whatever_is_hidden() -> None:
    nothing = hidden(None, None)
    assert left_of(nothing.measured) == pytest.approx(left_of(hidden().measured, slope=1.0), abs=2e-3)
    assert (nothing.effect, nothing.truth) == (None, {})


def test_noise_in_percent_is_of_the_span_of_the_readings() -> None:
    it = hidden(None, None, noise={"depth": "2 %"}, rows=1000)
    columns = read(it.measured)
    span = np.ptp(worn_um(columns["load"], columns["time"]))
    assert np.std(left_of(it.measured)) == pytest.approx(0.02 * span, rel=0.1)


def test_noise_may_be_correlated_within_a_run() -> None:
    left = left_of(hidden(None, None, correlation=0.8, rows=1000, runs=2).measured)
    lag = [np.corrcoef(part[1:], part[:-1])[0, 1] for part in (left[:1000], left[1000:])]
    assert lag == pytest.approx([0.8, 0.8], abs=0.08)
    assert np.std(left) == pytest.approx(1.0, abs=0.2)


def test_the_machine_may_be_drawn_from_the_tolerances() -> None:
    it = hidden(None, None, machine=7, rows=1000)
    assert set(it.machine) == {"load", "hardness"}
    columns, hardness = read(it.measured), it.machine["hardness"]
    assert abs(hardness / 2.1e9 - 1) > 0.01
    left = columns["depth"] - worn_um(columns["load"], columns["time"], hardness)
    assert np.std(left) == pytest.approx(1.0, abs=0.1)
    assert it.setup.nominal("hardness") == pytest.approx(2.1e9)
    assert hidden(None, None, machine=8).machine["hardness"] != hardness


def test_an_effect_may_be_made_by_a_function_of_the_author() -> None:
    def measured_curve(pin: Pin, base: Wear, *, slope: Float, probe_temperature: Float) -> Wear:
        """Twice the linear law: what the effect's own function would never make."""
        return replace(base, depth=base.depth + 2 * slope * (probe_temperature - 293.15))

    it = hidden(by=measured_curve, rows=1000)
    assert np.std(left_of(it.measured, slope=2.0)) == pytest.approx(1.0, abs=0.1)
    assert it.truth == {"slope": pytest.approx(1e-6)}


def test_what_nobody_registered_may_be_hidden() -> None:
    def wave(pin: Pin, base: Wear, *, probe_temperature: Float) -> Wear:
        return replace(base, depth=base.depth + 5e-6 * np.sin(probe_temperature))

    it = hidden(None, None, by=wave, rows=400)
    own = read(it.measured)["probe_temperature"] + 273.15
    assert np.std(left_of(it.measured) - 5 * np.sin(own)) == pytest.approx(1.0, abs=0.15)
    assert it.is_strange


def test_without_a_size_it_is_half_of_what_the_bounds_allow() -> None:
    it = hidden("running_in", None)
    assert it.truth == {"extra": pytest.approx(25e-6), "length": pytest.approx(np.sqrt(10 * 5e3))}
    assert hidden("sensor_offset", "5 um").truth == {"depth": pytest.approx(5e-6)}  # the part of what is measured


# Records along an axis, words, defaults


@inputs
class Creep:
    load: Float = given(10.0, "N", above=0)
    grease: str = given("thin")
    times: Float = given((0.0, 50.0, 100.0), "h", along="time")
    drag: Float = given(0.0, "um")


@results
class Track:
    time: Float = axis("h", follows="times")
    way: Float = found("um", along="time")


def creep(it: Creep) -> Track:
    return Track(time=it.times, way=column(it.load * 1e-8) * np.asarray(it.times) / 3600 - column(it.drag))


def dragging(it: Creep, *, slope: Float, room: Float) -> Creep:
    return replace(it, drag=it.drag + slope * (room - 293.15))


ROOM = Condition("room", "degC", reference=20, low=10, high=30)
CREEP = Model(
    name="creep", title="Creep", function=creep, objectives=[Vary("load", "5 N", "20 N")],
    errors=[Effect("dragging", on_inputs=dragging, needs=[ROOM], unknowns=[Unknown("slope", -1, 1, "um/K")])],
)  # fmt: skip


def test_a_result_along_an_axis_is_measured_along_it_a_record_per_run() -> None:
    it = hide("dragging", "0.1 um/K", "0.01 um", model=CREEP, rows=11, runs=3)
    columns = read(it.measured)
    assert it.measured.splitlines()[0] == "run,load [N],room [degC],time [h],way [um]"
    for run in (1, 2, 3):
        own = {name: values[columns["run"] == run] for name, values in columns.items()}
        assert own["time"] == pytest.approx(np.linspace(0, 100, 11))
        assert len({*own["load"]}) == len({*own["room"]}) == 1
        made = own["load"] * 1e-2 * own["time"] - 0.1 * (own["room"] - 20)
        assert own["way"] == pytest.approx(made, abs=0.05)
    assert len({*columns["load"]}) == 3
    assert np.all((columns["load"] >= 5) & (columns["load"] <= 20))
    assert np.all((columns["room"] >= 10) & (columns["room"] <= 30))


def test_what_a_study_sweeps_over_varies_in_use() -> None:
    swept = replace(PIN_WEAR, sheet=[], studies=[Sweep(over="time", at="1..400 h")])
    names = list(read(hide("sensor_offset", "5 um", NOISE, model=swept).measured))
    assert names == ["time", "depth"]
    chosen = replace(PIN_WEAR, sheet=[], studies=[], errors=PIN_WEAR.errors[2:])
    columns = read(hide("sensor_offset", "5 um", NOISE, model=chosen).measured)
    assert list(columns) == ["load", "depth"]
    assert np.all((columns["load"] >= 50) & (columns["load"] <= 200))


def test_inputs_may_take_levels_and_words() -> None:
    over = {"load": "5, 10, 20 N", "grease": ["thin", "thick"], "room": "12..28 degC"}
    columns = read(hide(None, noise="0.01 um", model=CREEP, over=over, rows=2, runs=24).measured)
    assert {*columns["load"]} == {5, 10, 20}
    assert {*columns["grease"]} == {"thin", "thick"}


def strokes_worn(it: Pin, *, worn: Float, strokes: Float) -> Pin:
    return replace(it, early_depth=it.early_depth + worn * strokes)


def turned(it: Pin, *, play: Float, way: Float) -> Pin:
    return replace(it, early_depth=it.early_depth + play * way)


def test_history_is_made_of_the_column_it_is_of() -> None:
    way, strokes = Condition("way", "1", derived="direction of load"), Condition("strokes", "1", derived="since_start")
    errors = [
        Effect("turned", on_inputs=turned, needs=[way], unknowns=[Unknown("play", 0, 50, "um")]),
        Effect("strokes_worn", on_inputs=strokes_worn, needs=[strokes], unknowns=[Unknown("worn", 0, 1, "um")]),
    ]
    model = replace(PIN_WEAR, errors=errors)
    it = read(hide("turned", "20 um", NOISE, model=model, over={"load": "50..200 N"}).measured)
    left = it["depth"] - worn_um(it["load"], 200.0)
    assert np.all(np.sign(left[1:]) == np.sign(np.diff(it["load"])))
    it = read(hide("strokes_worn", "0.1 um", NOISE, model=model, over={"strokes": "5000..6000"}).measured)
    assert np.all(np.diff(it["strokes"]) > 0)
    left = it["depth"] - worn_um(120.0, 200.0) - 0.1 * (it["strokes"] - it["strokes"][0])
    assert np.std(left) == pytest.approx(1.0, abs=0.4)


def test_a_record_can_be_written_for_the_command_line(calc: Calc, tmp_path: Path) -> None:
    it = hidden(rows=5, settings={"hardness": "3 GPa"})
    it.write(tmp_path / "bench")
    pin_wear = Path(__file__).parents[1] / "data" / "pin_wear.py"
    answer = calc("table", pin_wear, "--inputs", "inputs.toml", "--rows", "measured.csv", cwd=tmp_path / "bench")
    assert answer.code == 0, answer.err
    columns = read(answer.out)
    assert columns["depth"] == pytest.approx(worn_um(columns["load"], columns["time"], 3e9))
    assert (tmp_path / "bench" / "held_out.csv").read_text(encoding="utf-8") == it.held_out


# What is refused: every fault of a call at once, a sentence each

by_nothing: Callable[..., Any] = lambda inputs, results: results  # noqa: E731
NOTHING = {"effect": None, "size": None}
REFUSED: list[tuple[Mapping[str, Any], str]] = [
    ({"effect": "warm_prob"}, "no effect 'warm_prob'. Did you mean 'warm_probe'?"),
    ({"noise": None}, "noise is missing: say how far the gauge scatters, noise='0.1 kN', or '1 %' of the span"),
    ({"noise": "1 s"}, "noise '1 s' is of the kind of no result: pressure in MPa, distance in km, depth in um"),
    ({"noise": "1 %"}, "noise '1 %' may be of pressure, distance, depth: say which is measured, measure='pressure'"),
    ({"noise": "1 mm"}, "noise '1 mm' may be of distance, depth"),
    ({"noise": {"dept": "1 um"}}, "'dept' is no result. Did you mean 'depth'?"),
    ({"noise": {"safe_share": "1 %"}}, "'safe_share' is no result that a gauge can show"),
    ({"noise": "0 um"}, "0 um is no scatter; every gauge has some"),
    ({"measure": ["depth", "pressure"]}, "noise says nothing of pressure, which is to be measured"),
    ({"size": "1 N"}, "size of 'slope': '1 N' is a force (N), expected a length per kelvin"),
    ({"size": "3 um/K"}, "size of 'slope': 3 um/K lies outside of its bounds, -2 to 2 um/K, where no diagnosis looks"),
    ({"size": "0 um/K"}, "effect 'warm_probe' of size 0 hides nothing; hide(None, ...) does that"),
    ({"size": {"slop": "1 um/K"}}, "effect 'warm_probe' has no unknown 'slop'. Did you mean 'slope'?"),
    ({"effect": "running_in", "size": "3 um"}, 'has the unknowns extra, length: say which is 3 um, size={"extra": '),
    ({"effect": "running_in", "size": {"extra": "3 um"}}, "effect 'running_in': say length as well"),
    ({"effect": "sensor_offset", "size": None}, "say how large 'sensor_offset' is: size={...}"),
    ({"effect": None}, "size is '1 um/K', but no effect is hidden; leave it out"),
    ({**NOTHING, "over": {"load": "-5..50 N"}}, "over, 'load': load is -5 N; it must be above 0 N"),
    ({**NOTHING, "over": {"load": "50..5 N"}}, "over, 'load': it goes from 50 to 5 N: lower end first"),
    ({**NOTHING, "over": {"load": "1..2 m"}}, "over, 'load': the range '1..2 m'"),
    (
        {**NOTHING, "over": {"laod": "1..2 N"}},
        "has no input or condition of that name. Did you mean 'load'?",
    ),
    (
        {"over": {"load": "50..200 N"}},
        "effect 'warm_probe' needs 'probe_temperature', and over does not vary it: add "
        '"probe_temperature": "LOW..HIGH degC" to over',
    ),
    ({"over": None}, "needs 'probe_temperature', and no range is declared for it: add"),
    ({**NOTHING, "over": {}}, "nothing varies: say what is set from row to row"),
    ({"rows": 0}, "rows is 0; at least one"),
    ({"correlation": 1.0}, "correlation is 1; it lies between -1 and 1"),
    ({"settings": {"laod": "3 N"}}, "settings laod=3 N: pin_wear has no input 'laod'. Did you mean 'load'"),
    ({"by": by_nothing}, "by takes inputs, results; it is called with inputs, results and the keywords"),
    ({"settings": {"area": "1e-3 mm^2"}}, "the model has no answer in"),
]


@pytest.mark.parametrize(("changes", "sentence"), REFUSED, ids=[sentence[:40] for _, sentence in REFUSED])
def test_a_fault_is_said_in_a_sentence(changes: Mapping[str, Any], sentence: str) -> None:
    with pytest.raises(InputError) as refusal:
        hidden(**changes)
    assert sentence in str(refusal.value)
    assert len(refusal.value.faults) == 1


def test_all_faults_are_said_at_once() -> None:
    with pytest.raises(InputError) as refusal:
        hidden("warm_prob", noise=None, over={"load": "-5..50 N", "speed": "5..1 m/s"}, rows=0)
    assert len(refusal.value.faults) == 5
    assert all(str(fault).startswith("pin_wear: ") for fault in refusal.value.faults)
