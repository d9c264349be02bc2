"""The shell asks for names, as shells do: through variables of the environment, and a real bash with its script."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from shared import Calc
from truing.cli.completion import FILES, Shell

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
Ask = Callable[[str], dict[str, str]]


def asking(line: str, shell: str = "fish") -> dict[str, str]:
    """What the script of a shell puts into the environment when the line is typed so far."""
    word = line.split(" ")[-1]
    return {
        "_CALC_COMPLETE": f"complete_{shell}",
        "_TYPER_COMPLETE_ARGS": line,
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_TYPER_COMPLETE_WORD_TO_COMPLETE": word,
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(line.split(" ")) - 1),
        "COLUMNS": "80",
        "TERMINAL_WIDTH": "80",
    }


@pytest.fixture
def ask(calc: Calc, monkeypatch: pytest.MonkeyPatch) -> Ask:
    """Type a line and press Tab: the names that are offered, each with its help."""

    def answers(line: str) -> dict[str, str]:
        for name, value in asking(line).items():
            monkeypatch.setenv(name, value)
        answer = calc()
        assert (answer.code, answer.err) == (0, "")
        rows = (row.partition("\t") for row in answer.out.splitlines() if row)
        return {name: words for name, _, words in rows}

    return answers


DRIVES = ["harmonic_fractal.made_flank", "harmonic_fractal.run_up", "harmonic_fractal.vibration"]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("calc ini", ["init"]),
        ("calc run pre", ["press_linkage"]),
        ("calc describe rv_", ["rv_gearing", "rv_wear"]),
        ("calc run harmonic_fractal", ["harmonic_fractal", *DRIVES]),
        ("calc table harmonic_fractal.", DRIVES),
        ("calc run press_linkage --set reading=", ["reading=complete", "reading=printed"]),
        ("calc run -q press_linkage -v --set tolerances.kn", ["tolerances.knee_drive_length="]),
        ("calc run harmonic_fractal.made_flank --set studies.flank_file.f", ["studies.flank_file.file="]),
        ("calc run harmonic_fractal --set mating_surface", ["mating_surface.", "mating_surface="]),
        (
            "calc run harmonic_fractal --set mating_surface.spacing_",
            ["mating_surface.spacing_x=", "mating_surface.spacing_y="],
        ),
        ("calc sweep rv_wear work", ["working_time"]),
        ("calc sweep rv_wear backl", []),
        ("calc explain pr", ["press_linkage."]),
        ("calc explain press_linkage.slider_t", ["press_linkage.slider_tilt"]),
        ("calc explain press_linkage slider_t", ["slider_tilt"]),
        ("calc run ./no_such.py --set ", []),
        ("calc run --set ", []),
        ("calc run no_such_plugin --set lo", []),
        ("calc run ./pin", []),
    ],
)
def test_names_on_the_line(ask: Ask, line: str, offered: list[str]) -> None:
    found = ask(line)
    assert (set(offered) <= set(found)) if "tolerances" in line else (sorted(found) == offered)


def test_everything_that_can_be_set(ask: Ask) -> None:
    begin = f"calc run {PIN} --set "
    top = ask(begin)
    assert top["load="] == "F: normal load on the pin; above 0 N"
    assert {"area=", "probe_temperature=", "seed=", "tolerances.", "effects.", "studies.", "units."} <= set(top)
    assert set(ask(begin + "tolerances.")) == {"tolerances.load=", "tolerances.hardness="}
    assert "friction in the guide" in ask(begin + "tolerances.l")["tolerances.load="]
    assert {"effects.running_in.", "effects.sensor_offset."} <= set(ask(begin + "effects."))
    inside = [f"effects.running_in.{name}=" for name in ("extra", "length", "covariance")]
    assert list(ask(begin + "effects.running_in.")) == inside
    assert list(ask(begin + "sheet.detail=")) == ["sheet.detail=short", "sheet.detail=normal", "sheet.detail=full"]
    assert "studies.reliability.draws=" in ask(begin + "area=1 --set studies.reliability.d")
    assert "units.depth=" in ask(begin + "units.")
    assert "studies.diagnose.hold_out=" in ask(begin + "studies.diagnose.")


def test_whatever_is_offered_is_taken(ask: Ask, calc: Calc, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each name offered for ``--set`` is one that the inputs file has: none is refused as unknown."""
    begin = f"calc run {PIN} --set "
    offered = [*ask(begin), *ask(begin + "tolerances."), *ask(begin + "effects.running_in."), *ask(begin + "units.")]
    names = [name for name in offered if name.endswith("=")]
    monkeypatch.delenv("_CALC_COMPLETE")
    answer = calc("run", PIN, *(word for name in names for word in ("--set", f"{name}nonsense")))
    assert answer.code == 2
    assert len(names) > 12
    assert "Did you mean" not in answer.err
    assert "has no " not in answer.err


def test_run_folders(ask: Ask, calc: Calc, tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / "runs" / name).mkdir(parents=True)
        (tmp_path / "runs" / name / "results.json").write_text("{}")
    (tmp_path / "runs" / "other").mkdir()
    assert ask("calc compare ru") == {"runs/": "a folder"}
    assert ask("calc compare runs/one runs/") == {"runs/one": "a run", "runs/two": "a run", "runs/other/": "a folder"}


def test_a_plugin_that_talks_or_breaks_is_not_heard(ask: Ask, tmp_path: Path) -> None:
    text = PIN.read_text(encoding="utf-8")
    (tmp_path / "noisy.py").write_text(
        f"import sys\nprint('hello')\nprint('oh', file=sys.stderr)\n{text}", encoding="utf-8"
    )
    assert "load=" in ask("calc run noisy.py --set lo")
    assert list(ask("calc run noisy.py --set lo")) == ["load="]
    (tmp_path / "broken.py").write_text("raise RuntimeError('broken')\n")
    assert ask("calc run broken.py --set ") == {}


@pytest.mark.parametrize(
    ("shell", "answer"),
    [
        ("bash", "reading=printed"),
        ("zsh", '"reading=printed":"complete\\\\: every installation error'),
        ("powershell", "reading=printed:::complete: every installation error"),
    ],
)
def test_other_shells_ask_the_same(calc: Calc, monkeypatch: pytest.MonkeyPatch, shell: str, answer: str) -> None:
    for name, value in asking("calc run press_linkage --set reading=p", shell).items():
        monkeypatch.setenv(name, value)
    said = calc()
    assert said.code == 0
    assert answer in said.out


def test_names_of_plugins_load_none_of_them() -> None:
    code = "import sys; from truing.cli import main; main([]); print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **asking("calc run ")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.startswith("harmonic_fractal\t")
    assert not {"press_linkage", "numpy", "pint", "pluggy"} & set(done.stdout.splitlines()[-1].split())


@pytest.mark.skipif(shutil.which("bash") is None or os.name == "nt", reason="no bash")
def test_a_real_bash(calc: Calc, tmp_path: Path) -> None:
    """bash breaks words at the equals sign, and its script gives back what stands behind it."""
    script = calc("completion", "bash").out
    (tmp_path / "calc").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m truing "$@"\n')
    (tmp_path / "calc").chmod(0o755)
    ask = """
    press() { COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _calc_completion calc
              printf '%s ' "${COMPREPLY[@]}"; echo; }
    press calc run press_linkage --set 'reading=p'
    COMP_LINE='calc run press_linkage --set reading='; COMP_POINT=${#COMP_LINE}
    COMP_WORDS=(calc run press_linkage --set reading =); COMP_CWORD=5; _calc_completion calc; echo "${COMPREPLY[@]}"
    """
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path}
    done = subprocess.run(
        ["bash", "--norc", "-c", script + ask],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
    )
    assert done.stdout.splitlines() == ["reading=printed ", "complete printed"]
    assert done.stderr == ""


def test_the_script_is_installed_once(calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    for name in ("XDG_DATA_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / ".bashrc").write_text("alias ll=ls")
    script = tmp_path / ".local" / "share" / "truing" / "calc.bash"
    answer = calc("completion", "bash", "--install")
    assert answer.code == 0
    assert answer.err.splitlines()[:2] == [f"wrote {script}", f"added a line to {tmp_path / '.bashrc'}"]
    assert calc("completion", "bash", "--install", "-q").code == 0
    assert (tmp_path / ".bashrc").read_text() == f'alias ll=ls\nsource "{script}"\n'
    assert script.read_text(encoding="utf-8") == calc("completion", "bash").out
    assert calc("completion", "fish", "--install", "-q").code == 0
    assert (tmp_path / ".config" / "fish" / "completions" / "calc.fish").is_file()
    refused = calc("completion", "powershell", "--install")
    assert refused.code == 2
    assert "$PROFILE" in refused.err


def test_the_shell_is_seen_or_asked_for(calc: Calc, monkeypatch: pytest.MonkeyPatch) -> None:
    def unseen() -> None:
        raise OSError

    monkeypatch.setattr("shellingham.detect_shell", unseen)
    monkeypatch.setenv("SHELL", "/usr/bin/zsh")
    assert calc("completion").out.startswith("#compdef calc truing\n")
    monkeypatch.setenv("SHELL", "")
    answer = calc("completion")
    assert (answer.code, answer.err) == (
        2,
        "calc: which shell? name it: calc completion bash | zsh | fish | powershell\n",
    )


def test_every_shell_has_its_script() -> None:
    assert set(FILES) == set(Shell)
