"""Chains of calculations: inputs that are results of others, sampled, differentiated and diagnosed as one."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import chained_pins
import numpy as np
import pytest
from chained_pins import Twist

from truing import Kernel, Model, given, hookimpl, inputs, load
from truing.api.model import LoadedModel
from truing.api.records import read
from truing.declare.chain import chain_of
from truing.declare.taken import from_model
from truing.errors import InfeasibleError, InputError, UsageError
from truing.evaluate import evaluate, evaluate_rows, taken_values
from truing.packed import pack, unpack
from truing.runs.inputs_written import complete_inputs, input_hash
from truing.studies.sampling import AT_ONCE, scatter_of
from truing.testing.kit import failures

TURN = 2 * np.pi / 60
"""A revolution per minute in rad/s: power over this times a speed in rpm is a torque."""
PEG_FILE = """plugin = "peg"

[inputs]
torque = { from = "motor", result = "torque", power = "3 kW" }
angle = { from = "shaft" }

[from.shaft]
stiffness = "6 kN*m"
"""


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    """The calculations of this test and no others."""
    return Kernel([chained_pins])


def loaded(kernel: Kernel, name: str) -> LoadedModel:
    """One of them."""
    return LoadedModel(kernel.offer(name))


def written(folder: Path, text: str, name: str = "inputs.toml") -> Path:
    """A file."""
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def by_hand(power: Any, stiffness: Any, radius: Any, *, loss: Any = 0.0) -> Any:
    """The depth (m) of the peg behind motor and shaft, written down without Truing; the motor turns at 600 rpm."""
    torque = (power - loss) / (TURN * 600)
    return 1e-9 * (100.0 + torque / radius * (1 + torque / stiffness))


def test_a_chain_calculates_what_its_parts_do_by_hand(kernel: Kernel, tmp_path: Path) -> None:
    """The motor is calculated once, though the peg and the shaft both take its torque; the shaft states its speed."""
    setup = loaded(kernel, "peg").setup(written(tmp_path, PEG_FILE))
    answers = setup.model.read_results(evaluate(setup))
    assert answers["depth"] == pytest.approx(by_hand(3000.0, 6000.0, 0.05), rel=1e-12)
    assert answers["motor_torque"] == pytest.approx(3000.0 / (TURN * 600), rel=1e-12)
    assert answers["motor_heat_winding"] == pytest.approx(50.0)
    chain = chain_of(setup.model)
    assert chain is not None
    assert [*chain.sources] == ["motor", "shaft"]
    assert taken_values(setup)["shaft_torque"] == pytest.approx(answers["motor_torque"])


def test_what_scatters_in_a_source_scatters_behind_it_machine_by_machine(kernel: Kernel, tmp_path: Path) -> None:
    """The draws of the chain, put through the formula by hand, give the same depths."""
    setup = loaded(kernel, "peg").setup(written(tmp_path, PEG_FILE))
    drawn = scatter_of(setup).draw(3, 0, 500)
    assert sorted(drawn) == ["motor_power", "radius", "shaft_stiffness"]  # the torque is taken: its own band is off
    rows = evaluate_rows(setup, drawn, 500)
    depths = by_hand(drawn["motor_power"], drawn["shaft_stiffness"], drawn["radius"])
    assert rows.results["depth"] == pytest.approx(depths, rel=1e-12)
    assert np.std(drawn["motor_power"]) == pytest.approx(60.0, rel=0.1)


def test_slopes_go_through_the_links(kernel: Kernel, tmp_path: Path) -> None:
    """Derivatives of the depth equal differences of the formula by hand, and the chance is that of draws by hand."""
    run = loaded(kernel, "peg").run(written(tmp_path, PEG_FILE), progress=False)
    said = run.document["studies"]["sensitivity"]["depth"]
    nominal, step = (3000.0, 6000.0, 0.05), 1e-5
    for place, (name, unit) in enumerate((("motor_power", 1e3), ("shaft_stiffness", 1e3), ("radius", 1e-3))):
        up, down = (
            by_hand(*(value * (1 + sign * step * (index == place)) for index, value in enumerate(nominal)))
            for sign in (1, -1)
        )
        slope = (up - down) / (2 * step * nominal[place]) * unit * 1e6
        assert said[name]["derivative"] == pytest.approx(slope, rel=1e-5)
    rng = np.random.default_rng(1)
    depths = by_hand(
        3000 * (1 + 0.02 * rng.standard_normal(200_000)), 6000.0, 0.05 + 1e-4 * rng.standard_normal(200_000)
    )
    chance = run.document["studies"]["reliability"]["load"]
    low, high = chance["interval95"]
    assert low - 0.01 < np.mean(depths <= 1e-6) < high + 0.01


def test_an_effect_in_the_first_calculation_is_found_in_data_of_the_second(kernel: Kernel, tmp_path: Path) -> None:
    """Bearings of the motor drag; only the wear of the peg is measured, at several powers and oil temperatures."""
    rng = np.random.default_rng(5)
    power, oil = rng.uniform(2000, 4000, 30), rng.uniform(10, 60, 30)
    speed = 600 * TURN
    drag = 4.0 * 0.98 ** (oil - 20)  # N m: another law of temperature than the model's, alike within 2 %
    depth = by_hand(power, 6000.0, 0.05, loss=drag * speed) * 1e6 + 0.001 * rng.standard_normal(30)
    lines = ["motor_power [W],oil [degC],depth [um]"]
    lines += [f"{p!r},{t!r},{d!r}" for p, t, d in zip(power.tolist(), oil.tolist(), depth.tolist(), strict=True)]
    data = written(tmp_path, "\n".join(lines) + "\n", "measured.csv")
    text = PEG_FILE.replace(
        "[from.shaft]", '[conditions]\nmotor_oil = "20 degC"\n\n[columns]\noil = "motor_oil"\n\n[from.shaft]'
    )
    file, model = written(tmp_path, text), loaded(kernel, "peg")
    diagnosis = model.diagnose(read(data, model, file), file, progress=False)
    assert diagnosis.verdict == "named"
    (cause,) = diagnosis.causes
    assert cause.effect == "motor_friction"
    (drag_found,) = diagnosis.document["causes"][0]["unknowns"].values()
    low, high = drag_found["interval95"]
    assert low - 0.1 < 4.0 < high + 0.1
    extended = written(tmp_path, diagnosis.extended.text[0], "extended.toml")  # type: ignore[index]
    assert [on.effect.name for on in model.setup(extended).effects] == ["motor_friction"]


def test_effects_of_source_and_last_act_in_their_order(kernel: Kernel, tmp_path: Path) -> None:
    """An effect of the motor changes the torque that an effect of the peg sees."""
    effects = '\n[effects.motor_friction]\ndrag = "2 N*m"\n\n[effects.bent]\nforce = "10 N"\n'
    setup = loaded(kernel, "peg").setup(written(tmp_path, PEG_FILE + effects))
    torque = 3000.0 / (600 * TURN) - 2.0
    load_by_hand = 100 + 10 * torque / 10 + torque / 0.05 * (1 + torque / 6000)
    assert setup.model.read_results(evaluate(setup))["load"] == pytest.approx(load_by_hand, rel=1e-12)


def test_an_effect_on_the_results_of_a_source_acts_inside(kernel: Kernel, tmp_path: Path) -> None:
    """What takes the torque, the shaft too, sees the one that a slipping coupling lets through, in any order."""
    on = '\n[effects.motor_slipping]\nshare = 0.2\n\n[effects.bent]\nforce = "10 N"\n'
    setup = loaded(kernel, "peg").setup(written(tmp_path, PEG_FILE + on))
    torque = 0.8 * 3000.0 / (600 * TURN)
    load_by_hand = 100 + 10 * torque / 10 + torque / 0.05 * (1 + torque / 6000)
    for each in (setup, replace(setup, effects=setup.effects[::-1])):
        answers = each.model.read_results(evaluate(each))
        assert answers["load"] == pytest.approx(load_by_hand, rel=1e-12)
        assert answers["motor_torque"] == pytest.approx(torque, rel=1e-12)
    assert taken_values(setup)["shaft_torque"] == pytest.approx(torque, rel=1e-12)
    power = np.array([3000.0, 2000.0])
    rows = evaluate_rows(setup, {"motor_power": np.tile(power, 2)}, 4, repeats=2)
    assert rows.results["motor_torque"] == pytest.approx(np.tile(0.8 * power / (600 * TURN), 2), rel=1e-12)
    told = loaded(kernel, "peg").taking(torque=from_model("motor").torque).describe()["effects"]
    assert {each["name"]: each["acts_on"] for each in told}["motor_slipping"] == "results"


def test_an_effect_on_the_results_of_a_source_is_found(kernel: Kernel, tmp_path: Path) -> None:
    """Only the wear of the peg is measured, over the power; the coupling of the motor slips by an eighth."""
    rng, power = np.random.default_rng(7), np.linspace(1500.0, 4000.0, 24)
    depth = by_hand(power * (1 - 0.125), 6000.0, 0.05) * 1e6 + 0.001 * rng.standard_normal(24)
    lines = [
        "motor_power [W],depth [um]",
        *(f"{p!r},{d!r}" for p, d in zip(power.tolist(), depth.tolist(), strict=True)),
    ]
    file, model = written(tmp_path, PEG_FILE), loaded(kernel, "peg")
    data = written(tmp_path, "\n".join(lines) + "\n", "measured.csv")
    diagnosis = model.diagnose(read(data, model, file), file, progress=False)
    assert [cause.effect for cause in diagnosis.causes] == ["motor_slipping"]
    low, high = diagnosis.document["causes"][0]["unknowns"]["share"]["interval95"]
    assert low < 0.125 < high


def test_a_source_is_calculated_once_in_a_call(tmp_path: Path) -> None:
    """However many effects act behind it, the motor is called once; as many rows as there are, in one call."""
    calls: list[Any] = []

    def counted(given_motor: chained_pins.Motor) -> chained_pins.Turning:
        calls.append(np.shape(given_motor.power))
        return chained_pins.motor(given_motor)

    guest = ModuleType("guest")
    models = [replace(chained_pins.MOTOR, function=counted), chained_pins.PEG, chained_pins.SHAFT]
    guest.truing_models = hookimpl(lambda: models)  # type: ignore[attr-defined]
    on = '\n[effects.motor_slipping]\nshare = 0.2\n\n[effects.bent]\nforce = "10 N"\n'
    setup = loaded(Kernel([guest]), "guest.peg").setup(written(tmp_path, PEG_FILE + on))
    evaluate_rows(setup, {"motor_power": np.array([3000.0, 2000.0, 1000.0])}, 3)
    assert calls == [(3,)]


def test_what_is_stated_wins_and_bounds_are_kept(kernel: Kernel, tmp_path: Path) -> None:
    """With --set a number stands in place of a link; a source that gives an impossible one is named."""
    model, file = loaded(kernel, "peg"), written(tmp_path, PEG_FILE)
    stated = model.setup(file, set={"torque": "20 N*m"})
    angle = 3000 / (600 * TURN) / 6000
    assert stated.model.read_results(evaluate(stated))["load"] == pytest.approx(100 + 20 / 0.05 * (1 + angle))
    lost = model.setup(file, set={"motor_loss": "4 kW"})
    with pytest.raises(InfeasibleError, match="the motor loses all its power"):
        evaluate(lost)
    rows = evaluate_rows(lost, {"motor_loss": np.array([0.0, 4000.0])}, 2, wanted=["depth"])
    assert rows.reasons == {1: "the motor loses all its power"}
    assert np.isfinite(rows.results["depth"][0])


def test_the_inputs_file_of_a_run_gives_it_again(kernel: Kernel, tmp_path: Path) -> None:
    """Links are written with what they take; a worker that has the plugin makes the same chain."""
    model = loaded(kernel, "peg")
    setup = model.setup(written(tmp_path, PEG_FILE))
    again = model.setup(written(tmp_path, complete_inputs(setup, tmp_path), "again.toml"))
    assert input_hash(again) == input_hash(setup)
    assert input_hash(model.setup(set={"radius": "50 mm"})) != input_hash(setup)
    carried = unpack(pack(setup))
    assert carried.model.read_results(evaluate(carried)) == setup.model.read_results(evaluate(setup))


def test_a_source_has_its_own_inputs_file(kernel: Kernel, tmp_path: Path) -> None:
    """What stands in the file of the last calculation wins; a fault of the other file has its name and line."""
    motor = '[inputs]\npower = "4 kW"\nspeed = "300 rpm"\n\n[tolerances]\npower = "off"\n\n[studies]\nrun = []\n'
    written(tmp_path, motor, "motor.toml")
    text = PEG_FILE + '\n[from.motor]\ninputs_file = "motor.toml"\nspeed = "600 rpm"\n'
    setup = loaded(kernel, "peg").setup(written(tmp_path, text))
    depth = setup.model.read_results(evaluate(setup))["depth"]
    assert depth == pytest.approx(by_hand(3000.0, 6000.0, 0.05), rel=1e-12)
    assert "motor_power" not in scatter_of(setup).draw(0, 0, 5)
    written(tmp_path, motor.replace("300 rpm", "300 mm"), "motor.toml")
    with pytest.raises(InputError, match=r"motor\.toml:3: motor_speed: '300 mm' is a length"):
        loaded(kernel, "peg").setup(written(tmp_path, text.replace('speed = "600 rpm"\n', "")))


TWO_MOTORS = """plugin = "peg"

[inputs]
torque = { from = "left", result = "torque" }
noise = { from = "right", result = "hum", power = "4 kW" }
force = { from = "first", result = "load" }

[from.left]
plugin = "motor"
power = "3 kW"
speed = "600 rpm"

[from.right]
plugin = "motor"

[from.first]
plugin = "peg"
radius = "20 mm"
torque = { from = "right" }

[tolerances]
left_power = "off"
"""


def test_a_calculation_stands_twice_under_names_of_its_own(kernel: Kernel, tmp_path: Path) -> None:
    """Two motors, each with its own power, tolerance and effects; a peg presses another one."""
    model, file = loaded(kernel, "peg"), written(tmp_path, TWO_MOTORS)
    setup = model.setup(file)
    answers = setup.model.read_results(evaluate(setup))
    left, right = 3000.0 / (TURN * 600), 4000.0 / (TURN * 1200)
    assert answers["left_torque"] == pytest.approx(left, rel=1e-12)
    assert answers["first_load"] == pytest.approx(100 + right / 0.02 * 1.001, rel=1e-12)
    assert answers["load"] == pytest.approx(100 + right / 0.02 * 1.001 + left / 0.05 * 1.001, rel=1e-12)
    assert sorted(scatter_of(setup).draw(0, 0, 3)) == ["first_radius", "radius", "right_power"]
    assert {"left_slipping", "right_slipping", "first_bent"} < {*setup.model.effects}
    changed = model.setup(file, set={"from.left.power": "1 kW", "right_power": "1 kW"})
    assert evaluate(changed).left.torque == pytest.approx(left / 3, rel=1e-12)
    assert evaluate(changed).right.torque == pytest.approx(right / 4, rel=1e-12)
    again = model.setup(written(tmp_path, complete_inputs(setup, tmp_path), "again.toml"))
    assert input_hash(again) == input_hash(setup)
    assert evaluate(unpack(pack(setup))).load == answers["load"]


def test_names_of_their_own_in_python_and_on_the_sheet(kernel: Kernel, tmp_path: Path) -> None:
    """As ``from_model(calculation, name)``; a declaration may say so too. results.json says which calculation it is."""
    left = from_model("motor", "left", power="3 kW", speed="600 rpm")
    taken = loaded(kernel, "peg").taking(torque=left.torque, noise=from_model("motor", "right").hum)
    run = taken.run(set={"studies.run": "[]"}, output=tmp_path / "run", progress=False)
    assert run.si["left_torque"] == pytest.approx(3000.0 / (TURN * 600), rel=1e-12)
    made = [(each["name"], each["model"]) for each in run.document["chain"]["calculations"]]
    assert made == [("left", "motor"), ("right", "motor"), ("peg", "peg")]
    page = (tmp_path / "run" / "sheet.md").read_text(encoding="utf-8")
    heads = [line.partition(" ")[2].partition(" ")[2] for line in page.splitlines() if line.startswith("## ")]
    assert [head for head in heads if "A motor" in head] == ["A motor (left, motor)", "A motor (right, motor)"]

    @inputs
    class Driven:
        torque: float = given(from_model("motor", "left", speed="600 rpm").torque, "N*m")
        stiffness: float = given(from_model("motor", "right").torque, "N*m")

    guest = ModuleType("guest")
    driven = Model(name="driven", title="", function=_with_inputs(Driven))
    guest.truing_models = hookimpl(lambda: [driven])  # type: ignore[attr-defined]
    model = Kernel([chained_pins, guest]).offer("guest.driven").model
    assert model.inputs().left.speed == pytest.approx(10.0)
    assert model.inputs().right.speed == pytest.approx(20.0)
    assert failures(model) == {}


def test_a_name_that_cannot_be_a_source_of_its_own_is_refused(kernel: Kernel, tmp_path: Path) -> None:
    """With what to write instead."""
    for old, new, sentence in (
        ('plugin = "motor"\n\n[from.first]', "\n[from.first]", r'own, say whose: \[from.right\] plugin = "NAME"'),
        ("[from.left]", "[from.lift]", "no input is taken from 'lift'"),
        ('"left"', '"shaft"', "motor cannot be called 'shaft': another calculation has this name"),
        ('"left"', '"1st"', "motor cannot be called '1st': its name begins with a letter"),
        ('from = "left"', 'from = "left", plugin = "peg"', "'left' is peg and motor; give each its own name"),
    ):  # fmt: skip
        text = TWO_MOTORS.replace(old, new)
        for name in ("shaft", "1st"):
            text = text.replace("[from.left]", f"[from.{name}]") if name in new else text
        with pytest.raises(InputError, match=sentence):
            loaded(kernel, "peg").setup(written(tmp_path, text))


FAULTS = """[inputs]
torque = { from = "motor", result = "shaft_power", power = "3 kW" }
angle = { from = "shafd" }
radius = { from = "motor", result = "tork", power = "4 kW" }
teeth = { from = "shaft", result = "angle" }
force = { from = "wheel", result = "speed_left" }
softness = { from = "peg", result = "softness" }

[from.wheel]
inertia = "3 mm"
"""


def test_all_faults_of_a_chain_are_told_at_once(kernel: Kernel, tmp_path: Path) -> None:
    """Each by name, with file and line."""
    with pytest.raises(InputError) as raised:
        loaded(kernel, "peg").setup(written(tmp_path, FAULTS))
    told = {fault.line: fault.message for fault in raised.value.faults if "calculated once" not in fault.message}
    assert told == {
        2: "'torque' cannot be 'shaft_power' of motor: that is a power, and 'torque' is a torque",
        3: "'angle' is taken from 'shafd', which no plugin offers. Did you mean 'shaft'?",
        4: "motor has no result 'tork'. Did you mean 'torque'?",
        5: "'teeth' cannot be 'angle' of shaft: 'teeth' is a whole number that does not vary, and only a number can be "
        "taken from another calculation",
        6: "'force' cannot be 'speed_left' of wheel: that is a series along 'time', and 'force' takes one number",
        7: "a circle: 'softness' of peg from peg; leave one of these out",
    }
    twice = [fault for fault in raised.value.faults if "calculated once" in fault.message]
    assert [(fault.line, fault.message) for fault in twice] == [
        (
            4,
            "power of motor is '4 kW' here and '3 kW' in line 2; a source is calculated once, and a second one has a "
            'name of its own: [from.second] plugin = "motor"',
        )
    ]


def test_a_circle_is_refused_by_name(kernel: Kernel, tmp_path: Path) -> None:
    """In a file with its line; of declarations the plugin is named, and every other calculation works."""
    text = PEG_FILE + '\n[from.motor]\nloss = { from = "motor", result = "hum" }\n'
    with pytest.raises(InputError, match=r"inputs.toml:\d+: a circle: 'loss' of motor from motor"):
        loaded(kernel, "peg").setup(written(tmp_path, text))

    @inputs
    class Wound:
        torque: float = given(from_model("shaft").torque_out, "N*m")
        stiffness: float = given(1.0, "N*m")

    guest = ModuleType("guest")
    turned = Model(name="motor_again", title="", function=_with_inputs(Wound))
    guest.truing_models = hookimpl(lambda: [turned])  # type: ignore[attr-defined]
    model = Kernel([chained_pins, guest]).offer("motor_again").model
    assert [*model.input_fields][:3] == ["torque", "stiffness", "motor_power"]
    lonely = Kernel([guest])
    assert [broken.plugin for broken in lonely.broken] == ["guest"]
    assert "'torque' is taken from 'shaft', which no plugin offers" in str(lonely.broken[0])


def _with_inputs(kind: type) -> Any:
    def turn(given_inputs: Any) -> Twist:
        return Twist(angle=given_inputs.torque / given_inputs.stiffness, torque_out=given_inputs.torque)

    turn.__annotations__ = {"given_inputs": kind, "return": Twist}
    return turn


def test_a_chain_in_python_is_that_of_a_file(kernel: Kernel, tmp_path: Path) -> None:
    """``taking`` makes the model, and a value of a call does the same for one run."""
    motor = from_model("motor", power="3 kW", speed="600 rpm")
    peg = loaded(kernel, "peg")
    chain = peg.taking(torque=motor.torque, angle=from_model("shaft", stiffness="6 kN*m").angle)
    assert chain.describe()["inputs"][1]["from"] == {"calculation": "motor", "result": "torque"}
    for run in (
        chain.run(set={"studies.run": "[]"}, progress=False),
        peg.run(torque=motor.torque, angle=from_model("shaft", stiffness="6 kN*m").angle,
                set={"studies.run": "[]"}, progress=False),
    ):  # fmt: skip
        assert run.si["depth"] == pytest.approx(by_hand(3000.0, 6000.0, 0.05), rel=1e-12)
    with pytest.raises(UsageError, match="peg has no input 'tork'"):
        peg.taking(tork=motor.torque)


def test_the_sheet_has_the_graph_and_a_chapter_for_each(kernel: Kernel, tmp_path: Path) -> None:
    """results.json says what is taken, the sheet draws it, and formulas hold the numbers of their own calculation."""
    run = loaded(kernel, "peg").run(written(tmp_path, PEG_FILE), output=tmp_path / "run", progress=False)
    document = json.loads((tmp_path / "run" / "results.json").read_text(encoding="utf-8"))
    assert [link["input"] for link in document["chain"]["links"]] == ["torque", "angle", "shaft_torque"]
    assert [each["name"] for each in document["chain"]["calculations"]] == ["motor", "shaft", "peg"]
    assert document["inputs"]["torque"] == {
        "value": pytest.approx(47.746, rel=1e-4), "unit": "N*m", "from": {"calculation": "motor", "result": "torque"}
    }  # fmt: skip
    assert {check["name"] for check in document["checks"]} == {"load", "motor_torque"}
    page = (tmp_path / "run" / "sheet.md").read_text(encoding="utf-8")
    heads = [line.removeprefix("## ") for line in page.splitlines() if line.startswith("## ")]
    assert [head for head in heads if "A motor" in head or "A peg" in head or "Chain" in head or "Torque" in head] == [
        "4 Chain of calculations", "5 A motor (motor)", "5.1 Torque", "6 A peg (peg)"
    ]  # fmt: skip
    assert run.verdict is not None


def test_a_last_calculation_that_moves_stays_one(kernel: Kernel, tmp_path: Path) -> None:
    """A flywheel is braked by the torque of the motor: its speed falls as by hand, for many machines at once too."""
    setup = loaded(kernel, "wheel").setup(
        written(
            tmp_path, '[inputs]\nbrake = { from = "motor", result = "torque", power = "100 W", speed = "600 rpm" }\n'
        )
    )
    assert setup.model.dynamics is not None
    brake = 100 / (600 * TURN)
    assert evaluate(setup).speed_left == pytest.approx(10 - brake / 2 * np.array([0, 1, 2]), rel=1e-7)
    rows = evaluate_rows(setup, {"motor_power": np.array([100.0, 50.0])}, 2, wanted=["speed_left"])
    assert rows.results["speed_left"][1] == pytest.approx(10 - brake / 4 * np.array([0, 1, 2]), rel=1e-7)


def test_the_names_of_a_chain_are_all_its_calculations(kernel: Kernel) -> None:
    """A declared link needs no file: the shaft is a chain wherever it is asked for."""
    model = kernel.offer("shaft").model
    assert [*model.input_fields] == [
        "torque", "stiffness", "motor_power", "motor_speed", "motor_loss", "motor_resistance_winding",
        "motor_current_winding"
    ]  # fmt: skip
    assert [*model.effects] == ["motor_friction", "motor_rumble", "motor_slipping"]
    assert model.inputs().motor.speed == pytest.approx(10.0)  # 600 rpm, as from_model states it


def test_chains_keep_what_every_model_keeps(kernel: Kernel) -> None:
    """The kit of plugin authors: units of formulas, batches, seeds, processes, files, effects; of two chains."""
    assert failures(kernel.offer("shaft").model) == {}
    taken = {"torque": from_model("motor").torque, "angle": from_model("shaft").angle}
    assert failures(loaded(kernel, "peg").taking(taken).offer.model) == {}


def test_the_gear_stage_loads_the_discs_of_the_reducer() -> None:
    """Two plugins: what rv_wear answers in the chain is what it answers alone with the torque of rv_gearing."""
    settings = {"group": 5, "power": "5.5 kW"}
    gearing = load("rv_gearing").setup(**settings)
    known = gearing.model.read_results(evaluate(gearing))
    taken, wear = from_model("rv_gearing", **settings), load("rv_wear")
    chain = wear.setup(output_torque=taken.output_torque, total_ratio=taken.ratio)
    alone = wear.setup(output_torque=f"{known['output_torque']!r} N*m", total_ratio=f"{known['ratio']!r}")
    both = [setup.model.read_results(evaluate(setup)) for setup in (chain, alone)]
    assert both[0]["backlash"] == pytest.approx(both[1]["backlash"], rel=1e-12)
    assert both[0]["rv_gearing_output_torque"] == pytest.approx(known["output_torque"], rel=1e-12)


def test_a_source_is_calculated_once_for_all_points_of_a_curve() -> None:
    """The radius runs over three values; the motor, which knows nothing of it, is called once for the same machines."""
    calls: list[int] = []

    def counted(given_motor: chained_pins.Motor) -> chained_pins.Turning:
        calls.append(np.size(given_motor.power))
        return chained_pins.motor(given_motor)

    guest = ModuleType("guest")
    models = [replace(chained_pins.MOTOR, function=counted), chained_pins.PEG]
    guest.truing_models = hookimpl(lambda: models)  # type: ignore[attr-defined]
    peg = loaded(Kernel([guest]), "guest.peg").taking(torque=from_model("motor").torque)
    curve = {"over": "radius", "at": "40..60 mm", "points": "3", "draws": "5000"}
    asked = {"studies.run": '["reliability"]'} | {f"studies.reliability.{name}": text for name, text in curve.items()}
    run = peg.run(set=asked, progress=False)
    assert [rows for rows in calls if rows > 500] == [5000, AT_ONCE, 5000 - AT_ONCE]
    said = run.document["studies"]["reliability"]["load"]
    assert said["curve"]["probability"][1] == said["probability"]  # the radius is 50 mm
