"""A stranger's plugin beside ours: every verb takes it, it adds to ours, and a broken one disturbs nobody."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from shared import ROOT, TESTS, Answer, Calc, copied_guest, process
from truing.testing import CalcProcess

BROKEN = "plugin 'broken_guest' 0.0.7: IndexError: list index out of range"


@pytest.fixture
def stranger(calc: Calc, strangers: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Answer]:
    """Run ``calc`` with the strangers installed."""
    monkeypatch.syspath_prepend(strangers)
    return calc


def test_plugins_lists_the_stranger_and_names_the_broken_guest_once(
    stranger: Callable[..., Answer], strangers: Path
) -> None:
    answer = stranger("plugins")
    assert answer.code == 0
    row = next(line for line in answer.out.splitlines() if line.startswith("screw_joint"))
    assert "2.3.0" in row
    assert "screw-joint" in row
    assert "A preloaded screw joint" in row
    assert "press_linkage: screw_joint 2.3.0 adds 'frame_settling'" in answer.out
    assert "broken_guest" not in answer.out
    named = [line for line in answer.err.splitlines() if "broken_guest" in line]
    assert named == [f"warning: {strangers / 'broken_guest' / 'tables.py'}:6: {BROKEN}"]


def test_plugins_as_json(stranger: Callable[..., Answer]) -> None:
    document = json.loads(stranger("plugins", "--json").out)
    (joint,) = (model for model in document["models"] if model["name"] == "screw_joint")
    assert (joint["version"], joint["distribution"]) == ("2.3.0", "screw-joint")
    (press,) = (model for model in document["models"] if model["name"] == "press_linkage")
    assert press["added"] == [
        {"what": what, "plugin": "screw_joint", "version": "2.3.0"}
        for what in ("frame_settling", "slider_tilt", "Screwed joints of the frame")
    ]
    (broken,) = document["broken"]
    assert (broken["plugin"], broken["version"], broken["line"]) == ("broken_guest", "0.0.7", 6)


def test_a_process_of_its_own_finds_them_where_it_is_told(calc_process: CalcProcess, strangers: Path) -> None:
    alone, beside = (calc_process("plugins", "--names", path=path).out.split() for path in (None, strangers))
    assert set(beside) - set(alone) == {"broken_guest", "screw_joint"}


def test_strict_ends_at_the_broken_guest(stranger: Callable[..., Answer]) -> None:
    answer = stranger("plugins", "--strict")
    assert answer.code == 3
    assert BROKEN in answer.err


def run_folder(stranger: Callable[..., Answer], folder: Path, *arguments: str) -> Any:
    """Run without a fault and return results.json."""
    answer = stranger("run", *arguments, "--output", folder)
    assert answer.code in {0, 1}, answer.err
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def test_init_and_run(stranger: Callable[..., Answer], tmp_path: Path) -> None:
    assert stranger("init", "screw_joint", "-o", tmp_path / "joint.toml").code == 0
    answer = stranger("run", "screw_joint", "--inputs", "joint.toml")
    assert answer.code == 0, answer.err
    assert BROKEN in answer.err
    folder = tmp_path / "runs" / "joint"
    assert {"inputs.toml", "results.json", "run.json", "sheet.html", "sheet.md"} <= {p.name for p in folder.iterdir()}
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert (results["plugin"]["name"], results["plugin"]["version"]) == ("screw_joint", "2.3.0")
    assert results["results"]["preload"]["value"] == pytest.approx(43.0, rel=0.02)  # VDI 2230-1, Table A1
    assert {check["name"]: check["passed"] for check in results["checks"]} == {
        "equivalent_stress": True,
        "clamp_left": True,
    }


def test_the_effects_of_the_stranger_change_its_results(stranger: Callable[..., Answer], tmp_path: Path) -> None:
    few = ("screw_joint", "--set", "studies.run=[]")
    base = run_folder(stranger, tmp_path / "base", *few)
    on = ("--set", "effects.settling.depth=5 um", "--set", "effects.settling.life=1000", "--set", "load_cycles=1e9")
    worn = run_folder(stranger, tmp_path / "worn", *few, *on)
    by_hand = run_folder(stranger, tmp_path / "by_hand", *few, "--set", "extra_settling=5 um")
    assert worn["results"]["clamp_left"]["value"] == pytest.approx(by_hand["results"]["clamp_left"]["value"], rel=1e-9)
    assert worn["results"]["clamp_left"]["value"] < base["results"]["clamp_left"]["value"] - 0.5
    assert worn["results"]["preload"] == base["results"]["preload"]


def test_the_guests_effect_acts_on_our_model(
    stranger: Callable[..., Answer], tabled: Callable[..., list[dict[str, float]]], tmp_path: Path
) -> None:
    settled = ("--set", "effects.frame_settling.lift=100 um", "--set", "hours_since_assembly=1000 h")
    on = run_folder(stranger, tmp_path / "on", "press_linkage", "--set", "studies.run=[]", *settled)
    both = [f"ground_pivot_radius_deviation_{side}=-0.1 mm" for side in (1, 2)]
    still = "crank_angle [deg]\n0\n"
    (by_hand,), (base,) = tabled("press_linkage", still, *both), tabled("press_linkage", still)
    heights = [on["results"]["slider_position"]["value"], by_hand["slider_position"], base["slider_position"]]
    assert heights[0] == pytest.approx(heights[1], rel=1e-12)
    assert abs(heights[0] - heights[2]) > 1e-5
    assert {item["plugin"] for item in on["added"]} == {"screw_joint"}
    assert "frame_settling" in {item["what"] for item in on["added"]}
    sheet = (tmp_path / "on" / "sheet.html").read_text(encoding="utf-8")
    assert "Screwed joints of the frame" in sheet


def test_a_single_file_with_a_mistake_is_named_with_its_line(calc: Calc, tmp_path: Path) -> None:
    text = (TESTS / "data" / "pin_wear.py").read_text(encoding="utf-8")
    line = text.splitlines().index("PIN_WEAR = Model(") + 1
    broken = text.replace('Minimise("depth")', 'Minimise("dept")')
    (tmp_path / "my_calculation.py").write_text(broken, encoding="utf-8")
    answer = calc("run", "./my_calculation.py")
    assert answer.code == 3
    assert f"my_calculation.py:{line}: plugin 'my_calculation'" in answer.err
    assert "Did you mean 'depth'?" in answer.err
    assert answer.err.count("\n") == 1


def test_the_strangers_own_tests_pass(strangers: Path, tmp_path: Path) -> None:
    project = copied_guest("screw_joint", tmp_path)
    (project / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
    answer = process(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"],
        project,
        {"PYTHONPATH": str(strangers)},
    )
    assert answer.code == 0, answer.out
    assert "skipped" not in answer.out


def test_the_stranger_passes_the_type_checker() -> None:
    project = TESTS / "third_party" / "screw_joint"
    options = ["--config-file", str(ROOT / "pyproject.toml"), "--strict"]
    answer = process(
        [sys.executable, "-m", "mypy", *options, str(project / "screw_joint")], ROOT, {"MYPYPATH": str(project)}
    )
    assert answer.code == 0, answer.out
