"""The same inputs, seed and versions give the same bytes: again and elsewhere."""

from __future__ import annotations

import getpass
import json
import platform
from pathlib import Path

from shared import Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


def results(folder: Path) -> bytes:
    """Return results.json of a run."""
    return (folder / "results.json").read_bytes()


def test_nothing_of_the_place_or_the_time_is_in_the_results(calc: Calc, tmp_path: Path) -> None:
    for folder in ("here", "elsewhere far away"):
        (tmp_path / folder).mkdir()
        answer = calc("run", PIN, "-q", "-o", "run", cwd=tmp_path / folder)
        assert answer.code == 0, answer.err
    here = results(tmp_path / "here" / "run")
    assert here == results(tmp_path / "elsewhere far away" / "run")
    text = here.decode("utf-8")
    for word in (str(tmp_path), platform.node()):
        assert word not in text
    run = json.loads((tmp_path / "here/run/run.json").read_text("utf-8"))
    assert run["machine"] == platform.node()
    assert run["user"] == getpass.getuser()


def test_another_seed_is_another_sample_and_zero_is_a_seed(calc: Calc, tmp_path: Path) -> None:
    for seed in ("0", "1", "2"):
        assert calc("run", PIN, "-q", "-o", seed, "--set", f"seed={seed}").code == 0
        assert calc("run", PIN, "-q", "-o", f"{seed} again", "--set", f"seed={seed}").code == 0
        assert results(tmp_path / seed) == results(tmp_path / f"{seed} again")
    means = set()
    for seed in ("0", "1", "2"):
        found = json.loads(results(tmp_path / seed))
        assert found["seed"] == int(seed)
        means.add(found["studies"]["reliability"]["pressure"]["mean"])
    assert len(means) == 3


def test_the_order_of_the_inputs_file_changes_nothing(calc: Calc, tmp_path: Path) -> None:
    one = '[inputs]\nload = "84 N"\nspeed = "0.4 m/s"\n[tolerances]\nload = "sd 2 %"\nhardness = "off"\n'
    two = '[tolerances]\nhardness = "off"\nload = "sd 2 %"\n[inputs]\nspeed = "400 mm/s"\nload = "0.084 kN"\n'
    for name, text in (("one", one), ("two", two)):
        (tmp_path / f"{name}.toml").write_text(text)
        assert calc("run", PIN, "-q", "--inputs", f"{name}.toml").code == 0
    found = [json.loads(results(tmp_path / "runs" / name)) for name in ("one", "two")]
    assert found[0]["results"] == found[1]["results"]
    assert found[0]["studies"] == found[1]["studies"]
