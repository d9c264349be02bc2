"""Declarations: what they say, what they refuse, and with which sentence."""

import math
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest
from sample_models import STAGE, Gear, Stage, Surface

from truing import (
    Condition,
    Effect,
    Float,
    Minimise,
    Model,
    Price,
    Require,
    Section,
    Tolerance,
    Unknown,
    Vary,
    by_choice,
    drawn,
    found,
    given,
    grade,
    inputs,
    lognormal,
    normal,
    off,
    part,
    plus_minus,
    results,
    uniform,
    zone,
)
from truing.declare.fields import input_fields, result_fields
from truing.declare.spreads import Band, Spread, Stream, Target, read_spread, with_width
from truing.errors import DeclarationError, UnitError, UsageError
from truing.fits import tolerance
from truing.setup import default_setup


@inputs
class Bar:
    """A bar in tension, with one input of every kind."""

    force: Float = given("3 kN", "N", symbol="F", note="tension", above=0)
    width: Float = given(20, "mm", symbol="b", above=0, at_most=500)
    height: Float = given(10.0, "mm", symbol="h")
    factor: Float = given(None, "", symbol="k", note="left open unless measured")
    holes: Float = given(2, "", symbol="n", whole=True)
    bays: int = given(4)
    welded: bool = given(False)
    reading: Literal["gross", "net"] = given("gross")
    grain: tuple[float, ...] = given((1.0, 2.5), "mm")
    label: str = given("A")
    warm: Float = given(20, "degC")


@results
class Stress:
    """What the bar bears."""

    stress: Float = found("MPa", symbol="s", formula="force / (width * height)")


def stretch(bar: Bar) -> Stress:
    """Mean stress over the gross section."""
    return Stress(stress=bar.force / (bar.width * bar.height))


def bar_model(**changes: Any) -> Model[Bar, Stress]:
    return Model(name="bar", title="A bar", function=stretch, **changes)


@inputs
class Gears:
    """Two gears, of which one keeps the names of its inputs as they are."""

    sun: Gear = part(Gear, index="1", teeth=18)
    ring: Gear = part(Gear, index="2", suffix="", bore="40 mm")


@results
class Side:
    """What is asked of each gear."""

    pitch: Float = found("mm", symbol="d", formula="2 * bore")


@results
class Sides:
    """Both gears."""

    sun: Side = part(Side, index="1")
    ring: Side = part(Side, index="2", suffix="")


def mesh(gears: Gears) -> Sides:
    """A formula that names the own part first."""
    return Sides(sun=Side(pitch=2 * gears.sun.bore), ring=Side(pitch=2 * gears.ring.bore))


SURFACE = Surface((1.0, 5.0), "1 um")


# Fields


def test_defaults_become_si_and_annotations_say_what_varies() -> None:
    bar = Bar()
    assert (bar.force, bar.width, bar.height) == (3000.0, 0.02, 0.01)
    assert math.isnan(float(bar.factor))
    assert bar.warm == pytest.approx(293.15)
    assert (bar.holes, bar.bays, bar.welded, bar.reading, bar.label) == (2, 4, False, "gross", "A")
    assert bar.grain == (0.001, 0.0025)
    kinds = {"holes": "whole", "bays": "integer", "welded": "switch", "reading": "choice", "grain": "series"}
    kinds |= {"label": "text"}
    assert {name: field.kind for name, field in input_fields(Bar).items() if field.kind != "float"} == kinds
    assert {name for name, field in input_fields(Bar).items() if not field.varies} == kinds.keys() - {"holes"}


def test_parts_are_nested_in_python_and_flat_in_files() -> None:
    model = Model(name="mesh", title="", function=mesh)
    assert {name: field.symbol for name, field in model.input_fields.items()} == {
        "teeth_sun": "z_1", "bore_sun": "d_1", "teeth": "z_2", "bore": "d_2"
    }  # fmt: skip
    assert list(result_fields(Sides)) == ["pitch_sun", "pitch"]
    gears = Gears()
    assert (gears.sun.teeth, gears.sun.bore) == (18, 0.03)
    assert (gears.ring.teeth, gears.ring.bore) == (20, pytest.approx(0.04))
    gears = model.inputs(bore_sun="15 mm", teeth=44.0)
    assert (gears.sun.bore, gears.ring.bore, gears.ring.teeth) == (0.015, pytest.approx(0.04), 44.0)
    assert model.read_inputs(gears)["bore_sun"] == 0.015
    assert model.read_results(mesh(gears)) == {"pitch_sun": 0.03, "pitch": pytest.approx(0.08)}


def test_a_data_file_without_default_is_asked_for() -> None:
    assert STAGE.input_fields["surface"].kind == "file"
    assert STAGE.inputs(surface=SURFACE).surface == SURFACE
    with pytest.raises(UsageError, match="'surface' is read from a data file and has no default"):
        STAGE.inputs()


def test_series_become_arrays_in_si() -> None:
    assert STAGE.inputs(surface=SURFACE).profile.tolist() == [0.0, 1e-6, 0.5e-6]
    for profile in (("3 m", "4 m"), [3.0, 4.0]):
        assert STAGE.inputs(surface=SURFACE, profile=profile).profile.tolist() == [3.0, 4.0]
    assert STAGE.own_result_fields["lag"].along == "lag"


def test_texts_carry_units_and_numbers_are_si() -> None:
    bar = bar_model().inputs(force="5 kN", width=0.03, reading="net", welded=True)
    assert (bar.force, bar.width, bar.reading, bar.welded) == (5000.0, 0.03, "net", True)
    with pytest.raises(UsageError, match=r"bar has no input 'heigth'\. Did you mean 'height'\?"):
        bar_model().inputs(heigth="3 mm")
    with pytest.raises(UsageError, match="'reading' of bar is one of gross, net, not 'nett'"):
        bar_model().inputs(reading="nett")


# Classes that are refused


def test_a_part_replaces_only_what_exists() -> None:
    with pytest.raises(DeclarationError, match=r"part\(Gear\): it has no input 'tooth'\. Did you mean 'teeth'\?"):
        part(Gear, tooth=3)
    with pytest.raises(DeclarationError, match="'surface' is no plain input"):
        part(Stage, surface=SURFACE)
    with pytest.raises(DeclarationError, match="declared neither by @inputs nor by @results"):
        part(dict)


WRONG_CLASSES: list[tuple[Any, dict[str, tuple[Any, Any]], str]] = [
    (inputs, {"it": (Float, given(3.0))}, "input 'it' has no unit"),
    (inputs, {"it": (int, given(3, "mm"))}, "has the unit 'mm', but its annotation allows none"),
    (inputs, {"it": (Literal["a", "b"], given("c"))}, "is by default none of a, b"),
    (inputs, {"it": (dict[str, float], given({}))}, "write Float, int, bool, str"),
    (inputs, {"it": ("Nowhere", given(3.0, ""))}, "annotations must name what the module itself imports"),
    (inputs, {"teeth_sun": (Float, given(3.0, "")), "sun": (Gear, part(Gear))}, "the flat name 'teeth_sun' occurs"),
    (inputs, {"load": (Float, 3.0)}, r"Made: field 'load' is not declared: write given"),
    (inputs, {"load": (None, given(3.0, "N"))}, "'load' is a field but has no type annotation"),
    (results, {"load": (Float, given(3.0, "N"))}, "'load' is declared with the wrong word; results come from found"),
    (results, {"gear": (Gear, part(Gear))}, "the part 'gear' of Gear mixes inputs and results"),
]


@pytest.mark.parametrize(("word", "fields", "sentence"), WRONG_CLASSES)
def test_wrong_classes_are_refused(word: Any, fields: dict[str, tuple[Any, Any]], sentence: str) -> None:
    annotations = {name: annotation for name, (annotation, _) in fields.items() if annotation is not None}
    made = type("Made", (), {"__annotations__": annotations, **{name: each for name, (_, each) in fields.items()}})
    with pytest.raises(DeclarationError, match=sentence):
        input_fields(word(made))


# Spreads: each resolved to the standard deviation that its words mean


def target(nominal: float = 0.1, unit: str = "mm", **others: Any) -> Target:
    return Target("it", nominal, unit, others.__getitem__)


SPREADS = [
    (normal(sd="3 %"), 0.003, 0.1),
    (normal(sd="0.02 mm"), 2e-5, 0.1),
    (normal(band="0.12 mm"), 2e-5, 0.1),
    (plus_minus("0.06 mm"), 2e-5, 0.1),
    (plus_minus("6 %"), 0.002, 0.1),
    (uniform("0.06 mm"), 6e-5 / math.sqrt(3), 0.1),
    (lognormal(sd="6 %"), 0.006, 0.1),
    (grade("IT7"), 35e-6 / 6, 0.1),  # ISO 286-1, Table 1: IT7 over 80 up to 120 mm is 35 um
    (zone("0 um", "6 um", grows="up"), 1e-6, 0.1 + 3e-6),
    (zone("-2 um", "10 um"), 2e-6, 0.1 + 4e-6),
]


@pytest.mark.parametrize(("spread", "sd", "mean"), SPREADS, ids=lambda value: getattr(value, "text", None))
def test_spreads_mean_what_they_say(spread: Any, sd: float, mean: float) -> None:
    distribution = spread.resolve(target())
    assert distribution.sd == pytest.approx(sd, rel=1e-12)
    assert distribution.mean == pytest.approx(mean, rel=1e-12)
    values = distribution.draw(Stream(50_000, [(np.random.default_rng(0), slice(0, 50_000))]))
    assert values.mean() == pytest.approx(mean, abs=5 * sd / math.sqrt(50_000))
    assert values.std() == pytest.approx(sd, rel=0.01)
    standard = np.random.default_rng(1).standard_normal(50_000)
    mapped = distribution.from_standard(standard)
    assert mapped.mean() == pytest.approx(mean, abs=5 * sd / math.sqrt(50_000))
    assert mapped.std() == pytest.approx(sd, rel=0.01)
    assert np.all(np.diff(mapped[np.argsort(standard)]) >= 0)


def test_what_a_spread_takes_from_another_input() -> None:
    of_bore = grade("IT6", size="bore")
    assert of_bore.resolve(target(0.0, "mm", bore=0.02)).width == pytest.approx(13e-6)  # over 18 up to 30 mm
    spread = by_choice("reading", gross=plus_minus("0.3 mm"), net=plus_minus("0.6 mm"))
    assert spread.resolve(target(reading="net")).sd == pytest.approx(2e-4)
    assert off().resolve(target()) is None


def together(rng: np.random.Generator, count: int) -> dict[str, Any]:
    """Two inputs that scatter against each other."""
    common = rng.normal(0, 1e-3, count)
    return {"width": common, "height": -common}


def about_zero(rng: np.random.Generator, count: int) -> dict[str, Any]:
    return {"height": 1e-6 * rng.standard_normal(count)}


def shifted(rng: np.random.Generator, count: int) -> dict[str, Any]:
    return {"height": 1e-6 * (0.1 + rng.standard_normal(count))}


def test_drawn_stands_in_by_its_moments() -> None:
    """A mean that is chance is no shift; one of a tenth of a standard deviation is."""
    height = Target("height", 0.01, "mm", {}.__getitem__)
    assert drawn(together).resolve(height).sd == pytest.approx(1e-3, rel=0.05)
    assert drawn(about_zero).resolve(height).mean == 0.01
    assert drawn(shifted).resolve(height).mean - 0.01 == pytest.approx(1e-7, rel=0.2)
    with pytest.raises(DeclarationError, match="together draws width, height, but not 'it'"):
        drawn(together).resolve(target())


REFUSED_SPREADS = [
    (plus_minus("5 %"), target(0.0), "its nominal is 0"),
    (lognormal(sd="0.1 mm"), target(-0.1), "needs a nominal above zero"),
    (plus_minus("-0.1 mm"), target(), "is negative"),
    (normal(sd="-3 %"), target(), "is negative"),
    (zone("5 um", "1 um"), target(), "must lie above its start"),
    (plus_minus("3 N"), target(), "expected a length"),
    (grade("IT7"), target(0.1, "deg"), "is a grade for lengths"),
    (grade("IT77"), target(), "not a tolerance grade"),
]


@pytest.mark.parametrize(("spread", "where", "sentence"), REFUSED_SPREADS)
def test_spreads_that_mean_nothing_are_refused(spread: Any, where: Target, sentence: str) -> None:
    with pytest.raises(UnitError, match=sentence):
        spread.resolve(where)


FILE_SPREADS = [
    ("±0.05 mm", plus_minus("0.05 mm")),
    ("+/- 0.05 mm", plus_minus("0.05 mm")),
    ("sd 3 %", normal(sd="3 %")),
    ("band 0.125 mm", normal(band="0.125 mm")),
    ("it6", grade("IT6")),
    ("IT 6", grade("IT6")),
    ("uniform ±0.1 mm", uniform("0.1 mm")),
    ("lognormal sd 6 %", lognormal(sd="6 %")),
    ("off", off()),
    ("zone 0 um .. 6 um", zone("0 um", "6 um")),
    ({"zone": ["0 um", "6 um"]}, zone("0 um", "6 um")),
]


@pytest.mark.parametrize(("text", "spread"), FILE_SPREADS)
def test_spreads_as_files_write_them(text: Any, spread: Any) -> None:
    assert read_spread(text, normal(sd="1 %")) == spread
    assert read_spread(spread.text, normal(sd="1 %")) == spread


def test_what_a_file_does_not_repeat_stays_as_declared() -> None:
    assert read_spread("±0.1 mm", plus_minus("1 mm", at_radius="r")) == plus_minus("0.1 mm", at_radius="r")
    assert read_spread("IT5", by_choice("reading", a=grade("IT7", size="bore"))) == grade("IT5", size="bore")
    assert read_spread({"zone": ["0 um", "9 um"]}, zone("0 um", "1 um", grows="up")) == zone("0 um", "9 um", grows="up")


def test_spreads_that_are_written_wrongly() -> None:
    for text in ("0.05 mm", "sd", "IT99", "zone 3 um", {"zone": ["1 um"]}, {"band": "1 mm"}, "± x mm"):
        with pytest.raises(UnitError):
            read_spread(text, normal(sd="1 %"))
    for arguments in ({"sd": "1 %", "band": "1 mm"}, {}):
        with pytest.raises(DeclarationError, match="takes either sd="):
            normal(**arguments)


def test_setup_resolves_every_tolerance_once_per_input() -> None:
    model = bar_model(
        errors=[
            Tolerance("size", plus_minus("0.3 mm"), on=["width", "height"]),
            Tolerance("force", off()),
            Tolerance("factor", normal(sd="3 %")),
        ]
    )
    found_spreads = default_setup(model).distributions()
    assert {name: set(each) for name, each in found_spreads.items()} == {"size": {"width", "height"}}
    assert default_setup(model, factor=2.0).distributions()["factor"]["factor"].sd == pytest.approx(0.06)


# Effects and unknowns


def wider(bar: Bar, *, extra: Float) -> Bar:
    return replace(bar, width=bar.width + extra)


def heated(bar: Bar, base: Stress, *, slope: Float, room: Float) -> Stress:
    return replace(base, stress=base.stress + slope * (room - 293.15))


def any_keyword(bar: Bar, **values: Float) -> Bar:
    return bar


def tuned(bar: Bar, *, extra: Float, power: float = 2.0) -> Bar:
    return bar


EXTRA = Unknown("extra", 0, 1, "mm")
ROOM = Condition("room", "degC", reference=20)


def test_place_and_function_of_an_effect() -> None:
    effect = Effect("wider", on_inputs=wider, unknowns=[EXTRA])
    assert (effect.place, effect.function) == ("inputs", wider)
    reading = Effect("heated", on_reading=heated, needs=[ROOM], unknowns=[Unknown("slope", -1, 1, "MPa/K")])
    assert (reading.place, reading.needs[0].zero) == ("reading", pytest.approx(293.15))
    for function in (any_keyword, tuned):
        assert Effect("it", on_inputs=function, unknowns=[EXTRA]).function is function


def test_bounds_tell_amplitude_from_shape() -> None:
    bounds = [((0, 5), True), ((-1, 1), True), ((1, 10), False)]
    assert [Unknown("a", *ends).is_amplitude for ends, _ in bounds] == [said for _, said in bounds]
    assert not Unknown("order", 0, 3, whole=True).is_amplitude
    for low, high in [(1, 1), (2, 1), (math.nan, 1), (0, math.inf)]:
        with pytest.raises(DeclarationError, match="two finite numbers, lower first"):
            Unknown("a", low, high)
    with pytest.raises(DeclarationError, match="unknown 'a': it is a whole number, so its bounds are"):
        Unknown("a", 0.5, 3, whole=True)
    with pytest.raises(DeclarationError, match="unknown 'a': a place along 'time' is no whole number"):
        Unknown("a", 1, 3, whole=True, along="time")


PLACE = Unknown("place", 0, 9, along="room")
FOUR = [Unknown(name, -1, 1) for name in "abcd"]
WRONG_EFFECTS: list[tuple[dict[str, Any], str]] = [
    ({"unknowns": [EXTRA]}, "acts at one place"),
    ({"on_inputs": wider, "on_results": heated, "unknowns": [EXTRA]}, "acts at one place"),
    ({"on_inputs": wider, "unknowns": []}, "has 0 unknowns"),
    ({"on_inputs": wider, "unknowns": FOUR}, "has 4 unknowns; one to three can be found"),
    ({"on_inputs": wider, "unknowns": [Unknown("extra", 1, 2)]}, "has no amplitude"),
    ({"on_inputs": wider, "unknowns": [EXTRA, EXTRA]}, "names an unknown or condition twice"),
    ({"on_inputs": wider, "unknowns": [Unknown("etxra", 0, 1)]}, "wider takes the keywords extra, but its unknowns"),
    ({"on_inputs": wider, "unknowns": [EXTRA], "needs": [ROOM]}, "takes the keywords extra"),
    ({"on_reading": heated, "unknowns": [Unknown("slope", 0, 1)]}, "takes the keywords slope, room"),
    ({"on_reading": wider, "unknowns": [EXTRA]}, "takes the keywords none"),
    ({"on_inputs": wider, "unknowns": [EXTRA], "parts": [["etxra"]]}, "a part of effect 'it' names 'etxra'"),
    ({"on_inputs": wider, "unknowns": [EXTRA], "parts": [["extra"], ["extra"]]}, "'extra' stands in two parts"),
    ({"on_inputs": any_keyword, "unknowns": [EXTRA, Unknown("more", 0, 1)], "parts": [["extra"]]},
     "the unknown 'more' stands in no part"),
    ({"on_inputs": any_keyword, "unknowns": [EXTRA, Unknown("more", 1, 2)], "parts": [["extra"], ["more"]]},
     "the part more of effect 'it' has no amplitude"),
    ({"on_inputs": any_keyword, "unknowns": [EXTRA, PLACE]}, "'place' lies along 'room', which it does not see"),
]  # fmt: skip


def test_effects_with_places_and_with_more_than_three_unknowns_in_parts() -> None:
    assert Effect("it", on_inputs=any_keyword, unknowns=[EXTRA, PLACE], needs=[ROOM]).unknowns[1] is PLACE
    assert Effect("it", on_inputs=any_keyword, unknowns=[EXTRA, PLACE], reads=["room"]).reads == ("room",)
    assert len(Effect("it", on_inputs=any_keyword, unknowns=FOUR, parts=["ab", "cd"]).groups()) == 2


@pytest.mark.parametrize(("arguments", "sentence"), WRONG_EFFECTS)
def test_effects_that_do_not_fit_their_function(arguments: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence):
        Effect("it", **arguments)


# Goals


BOUNDS = {"low": "1 mm", "high": "2 mm"}


def test_vary_takes_bounds_or_a_formula_and_require_one_limit() -> None:
    wrong = [{}, {"low": "1 mm"}, {**BOUNDS, "by": "b"}, {"low": "1 mm", "by": "b"}, {"step": "1 mm", "by": "b"}]
    for arguments in wrong:
        with pytest.raises(DeclarationError, match="takes either low and high or by="):
            Vary("width", **arguments)
    for arguments in ({}, {"at_most": "1 MPa", "at_least": "0 MPa"}):
        with pytest.raises(DeclarationError, match="takes one of at_most, at_least and within"):
            Require("stress", **arguments)
    with pytest.raises(DeclarationError, match="must lie between 0 and 1"):
        Require("stress", at_most="1 MPa", reliability=99.0)
    limit = Require("stress", within="1 MPa", reliability="factor")
    assert (limit.kind, limit.limit, limit.reliability) == ("within", "1 MPa", "factor")


# The model as a whole


def elsewhere(gears: Gears, *, extra: Float) -> Gears:
    return gears


def any_reading(bar: Bar, base: Stress, **values: Float) -> Stress:
    return base


def in_room(name: str, condition: str, reference: float = 20) -> Effect:
    """An effect that needs a temperature."""
    needs = [Condition(condition, "degC", reference=reference)]
    return Effect(name, on_reading=any_reading, needs=needs, unknowns=[Unknown("slope", -1, 1)])


PAID = Tolerance("width", plus_minus("1 mm"), price=Price("1 / width", width="mm", unit="EUR"))
PAID_ELSEWHERE = Tolerance("force", plus_minus("1 N"), price=Price("1 / width", width="N", unit="CNY"))
WRONG_MODELS: list[tuple[dict[str, Any], str]] = [
    ({"errors": [PAID, PAID_ELSEWHERE]}, "the prices are in CNY and EUR; give all of them in one unit"),
    ({"objectives": [Minimise("tolerance_price")]}, "neither input nor result. No tolerance has a price."),
    ({"objectives": [Require("tolerance_price", at_most="9 EUR")]}, "is no result. No tolerance has a price."),
    (
        {"errors": [PAID], "objectives": [Require("tolerance_price", at_most="9 EUR", reliability=0.9)]},
        "a price does not scatter",
    ),
    ({"errors": [Tolerance("widht", off())]}, "is on 'widht', which is no input. Did you mean 'width'?"),
    ({"errors": [Tolerance("reading", off())]}, "is on 'reading', which cannot scatter"),
    ({"errors": [Tolerance("force", off()), Tolerance("force", off())]}, "two error sources are called 'force'"),
    ({"errors": [Tolerance("width", grade("IT7", size="brdth"))]}, "names 'brdth', which is no input"),
    ({"errors": [Tolerance("width", plus_minus("1 mm", at_radius="r"))]}, "names 'r', which is no input"),
    ({"errors": [Tolerance("width", by_choice("redaing", a=off()))]}, "Did you mean 'reading'?"),
    ({"errors": [Tolerance("width", by_choice("force", a=off()))]}, "'force', which offers no choices"),
    ({"errors": [Tolerance("width", by_choice("reading", net=off()))]}, "'reading' offers gross, net"),
    ({"errors": [Tolerance("width", "3 %")]}, "has the spread '3 %'; write normal"),
    ({"errors": [Tolerance("width", off(), price=Price("3 / breadth", "mm", "EUR"))]}, "it is a formula in width"),
    ({"errors": [Tolerance("width", off(), price=Price("3 / (", "mm", "EUR"))]}, "the price of tolerance 'width'"),
    ({"errors": ["width"]}, "'width' is neither a Tolerance nor an Effect"),
    ({"errors": [Effect("e", on_inputs=elsewhere, unknowns=[EXTRA])]}, "acts on Gears, but the model has Bar"),
    ({"objectives": [Vary("widht", "1 mm", "2 mm")]}, "Vary names 'widht', which is no input. Did you mean 'width'?"),
    ({"objectives": [Vary("reading", "1 mm", "2 mm")]}, "which is no number that may vary"),
    ({"objectives": [Vary("width", by="2 * hight")]}, "follows hight, which is no input. Did you mean 'height'?"),
    ({"objectives": [Minimise("strss")]}, "Minimise names 'strss', which is neither input nor result. Did you mean"),
    ({"objectives": [Require("force", at_most="1 N")]}, "Require names 'force', which is no result"),
    ({"objectives": [Require("stress", at_most="fource")]}, "neither a quantity nor an input or result. Did you mean"),
    ({"objectives": [Require("stress", at_most="1 MPa", reliability="goal")]}, "takes its reliability from 'goal'"),
    ({"objectives": ["stress"]}, "'stress' is no objective"),
    ({"sheet": [Section("Strength", "strss")]}, "section 'Strength' names 'strss', which is no result. Did you mean"),
    ({"errors": [in_room("one", "room"), in_room("two", "room", 25)]}, "the condition 'room' is declared in two ways"),
    ({"errors": [in_room("it", "warm")]}, "the condition 'warm' has the name of an input"),
    (
        {"errors": [Effect("it", on_inputs=any_keyword, unknowns=[EXTRA, PLACE], reads=["room"])]},
        "effect 'it' reads 'room', which is neither input nor axis",
    ),
    (
        {"errors": [Tolerance("widht", off())], "sheet": [Section("Strength", "strss")]},
        "'widht', which is no input. Did you mean 'width'?; section 'Strength' names 'strss'",
    ),
    ({"name": "my bar"}, "may hold letters, digits and underscores only"),
    ({"name": "a.b"}, "may hold letters, digits and underscores only"),
]


@pytest.mark.parametrize(("changes", "sentence"), WRONG_MODELS)
def test_models_that_name_what_does_not_exist(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(DeclarationError) as caught:
        Model(**{"name": "bar", "title": "", "function": stretch, **changes})
    assert sentence in str(caught.value)


def model_with_result(**found_arguments: Any) -> Model[Any, Any]:
    made = type("Made", (), {"__annotations__": {"it": Float}, "it": found("MPa", **found_arguments)})
    answer = results(made)

    def function(bar: Bar) -> Any:
        return answer(it=bar.force)

    function.__annotations__ = {"bar": Bar, "return": answer}
    return Model(name="made", title="", function=function)


WRONG_FORMULAS = [
    ({"formula": "force / widht"}, "formula of 'it' names widht, which is neither input nor result. Did you mean"),
    ({"formula": "it + force"}, "names itself; write an equation with =="),
    ({"formula": "force /"}, "formula of 'it'"),
    ({"formula": "__import__('os')"}, "formula of 'it'"),
    ({"along": "time"}, "runs along 'time', which is no axis"),
]


@pytest.mark.parametrize(("found_arguments", "sentence"), WRONG_FORMULAS)
def test_formulas_and_axes_that_cannot_be_right(found_arguments: dict[str, str], sentence: str) -> None:
    assert model_with_result(formula="it * width == force").name == "made"
    with pytest.raises(DeclarationError) as caught:
        model_with_result(**found_arguments)
    assert sentence in str(caught.value)


def no_annotation(bar, factor=2):  # type: ignore[no-untyped-def]
    return bar


def two_arguments(bar: Bar, other: Bar) -> Stress:
    return stretch(bar)


def test_the_function_takes_one_class_and_returns_one() -> None:
    for function in (no_annotation, two_arguments):
        with pytest.raises(DeclarationError, match="takes one annotated class of inputs and returns one of results"):
            Model(name="bar", title="", function=function)


# A spread of another width keeps its words, its place and its shape, and stands in its text in full.

OTHER = {"radius": 0.25, "kind": "rough"}
LENGTH = Target("length", 0.08, "mm", OTHER.__getitem__)
ANGLE = Target("angle", 0.3, "deg", OTHER.__getitem__)
PURE = Target("share", -2.0, "", OTHER.__getitem__)
PERCENT = Target("share", 0.12, "%", OTHER.__getitem__)
WARMTH = Target("warmth", 300.0, "degC", OTHER.__getitem__)

WIDTHS: list[tuple[Spread, Target, float]] = [
    (normal(sd="0.01 mm"), LENGTH, 6e-5),
    (normal(band="125 um"), LENGTH, 125e-6),
    (normal(sd="3 %"), LENGTH, 6 * 0.03 * 0.08),
    (normal(sd="3 %"), PURE, 6 * 0.03 * 2.0),
    (normal(sd="3 %"), PERCENT, 0.18),
    (plus_minus("0.05 mm"), LENGTH, 1e-4),
    (plus_minus("0.05 mm", at_radius="radius"), ANGLE, 1e-4 / 0.25),
    (uniform("0.05 mm"), LENGTH, 1e-4),
    (lognormal(sd="6 %"), LENGTH, 6 * 0.06 * 0.08),
    (read_spread("uniform sd 0.01 mm", off()), LENGTH, math.sqrt(12) * 1e-5),
    (plus_minus("2 K"), WARMTH, 4.0),
    (zone("0 um", "6.55 um", grows="up"), LENGTH, 6.55e-6),
    (zone("-7 um", "0 um", grows="down"), LENGTH, 7e-6),
    (zone("-3 um", "5 um"), LENGTH, 8e-6),
    (by_choice("kind", fine=normal(band="1 um"), rough=normal(band="9 um")), LENGTH, 9e-6),
    (grade("IT7"), LENGTH, 30e-6),  # ISO 286-1, table 1: 50 mm to 80 mm
]


@pytest.mark.parametrize(("spread", "target", "width"), WIDTHS)
def test_a_spread_of_another_width_keeps_its_shape_and_reads_back(spread: Spread, target: Target, width: float) -> None:
    before = spread.resolve(target)
    assert before is not None
    assert before.width == pytest.approx(width, rel=1e-14)
    for times in (1.0, 1.37, 2.0, 1.2345678901234567, 0.123456789012345):
        changed = with_width(spread, target, times * width)
        after = changed.resolve(target)
        assert after is not None
        assert after.width == pytest.approx(times * width, rel=4e-15)
        assert (after.shape, after.sd) == (before.shape, pytest.approx(times * before.sd, rel=1e-14))
        again = read_spread(changed.text, changed)
        assert (again, again.resolve(target)) == (changed, after)


@pytest.mark.parametrize(("grows", "mean"), [("up", 8e-6), ("down", -2e-6), ("both", 3e-6)])
def test_a_zone_of_twice_the_width_grows_where_it_says(grows: Any, mean: float) -> None:
    """From -2 um to 8 um, 10 um wide, become -2 to 18, -12 to 8, or -7 to 13."""
    found = with_width(zone("-2 um", "8 um", grows=grows), LENGTH, 20e-6).resolve(LENGTH)
    assert found is not None
    assert found.mean - 0.08 == pytest.approx(mean, abs=1e-16)
    assert found.width == pytest.approx(20e-6, rel=1e-14)


def test_a_spread_of_another_width_is_written_in_its_words() -> None:
    for spread, width, text in [
        (plus_minus("0.05 mm"), 2e-4, "±0.1 mm"),
        (uniform("0.05 mm"), 2e-4, "uniform ±0.1 mm"),
        (grade("IT7"), tolerance("IT8", 0.08), "band 0.046 mm"),
    ]:
        assert with_width(spread, LENGTH, width).text == text
    assert with_width(plus_minus("0.05 mm", at_radius="radius"), ANGLE, 1e-3).text == "±0.125 mm"
    changed = with_width(normal(sd="3 %"), LENGTH, 6 * 0.05 * 0.08)
    assert isinstance(changed, Band)
    share, unit = changed.amount.split()
    assert (float(share), unit) == (pytest.approx(5, rel=1e-14), "%")
    with pytest.raises(UnitError, match="its nominal is 0"):
        with_width(normal(sd="3 %"), replace(LENGTH, nominal=0.0), 1e-6)


def test_what_has_no_width_and_a_width_that_is_none_are_refused() -> None:
    for spread in (off(), drawn(together), by_choice("kind", fine=normal(sd="1 um"), rough=off())):
        with pytest.raises(UsageError, match=r"^the spread of 'height' is (off|drawn by together): it has no width"):
            with_width(spread, replace(LENGTH, name="height"), 1e-5)
    for width in (0.0, -1e-6, math.nan, math.inf):
        with pytest.raises(UsageError, match="the width of the tolerance of 'length' must lie above zero"):
            with_width(normal(sd="1 um"), LENGTH, width)


@inputs
class Wheel:
    """A wheel."""

    bore: Float = given(30.0, "mm", note="bore")
    teeth: int = given(18, note="teeth")


@inputs
class Wheels:
    """Two wheels, and a third number with a note that a part has, too."""

    front: Wheel = part(Wheel)
    rear_left: Wheel = part(Wheel)
    pegs: int = given(3, note="pegs")


def test_fields_of_several_parts_say_of_which_they_are() -> None:
    fields = input_fields(Wheels)
    notes = {name: field.spec.note for name, field in fields.items()}
    assert notes == {
        "bore_front": "bore, front", "teeth_front": "teeth, front", "bore_rear_left": "bore, rear left",
        "teeth_rear_left": "teeth, rear left", "pegs": "pegs",
    }  # fmt: skip
