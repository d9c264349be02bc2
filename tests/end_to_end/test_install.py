"""Everything installed anew: our wheel and two strangers' projects in a fresh environment, by pip alone."""

import json
import os
import sys
import zipfile
from pathlib import Path

import pytest

from shared import GUESTS, ROOT, Answer, copied_guest, process

pytestmark = pytest.mark.install
OURS = {path.name for path in (ROOT / "plugins").iterdir() if (path / "__init__.py").is_file()}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build our wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    done = process(command, folder)
    assert done.code == 0, done.err + done.out
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def fresh(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a fresh environment with the wheel and both strangers in it; returns its folder of commands."""
    folder = tmp_path_factory.mktemp("fresh")
    environment = folder / "environment"
    assert process([sys.executable, "-m", "venv", str(environment)], folder).code == 0
    commands = environment / ("Scripts" if os.name == "nt" else "bin")
    sources = [str(copied_guest(name, folder)) for name in GUESTS]
    pip = [str(commands / "python"), "-m", "pip", "--disable-pip-version-check"]
    done = process([*pip, "install", "--quiet", str(wheel), *sources], folder)
    assert done.code == 0, done.err
    check = process([*pip, "check"], folder)
    assert check.code == 0, check.out
    return commands


def calc(commands: Path, folder: Path, *arguments: str) -> Answer:
    return process([str(commands / "calc"), *arguments], folder)


def test_the_wheel_holds_our_packages_and_no_others(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"truing", *OURS}
    for package in ("truing", *OURS):
        assert f"{package}/py.typed" in names
    assert not [name for name in names if "test_" in name or "__pycache__" in name or name.endswith((".md", ".pyc"))]


def test_the_wheel_holds_templates_and_examples(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    templates = {path.relative_to(ROOT).as_posix() for path in (ROOT / "templates").rglob("*") if path.is_file()}
    assert {f"truing/{name}" for name in templates if "__pycache__" not in name} <= names
    examples = {path.relative_to(ROOT / "plugins").as_posix() for path in (ROOT / "plugins").glob("*/*.toml")}
    assert examples <= names
    assert examples


def test_the_wheel_names_its_commands_and_plugins(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    (entries,) = (name for name in archive.namelist() if name.endswith("entry_points.txt"))
    text = archive.read(entries).decode()
    assert "calc = truing.cli:main" in text
    for name in ("harmonic_fractal", "press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"):
        assert f"{name} = {name}" in text
    assert "gear_geometry" not in text  # no plugin: what they share
    assert {"gear_geometry/__init__.py", "gear_geometry/involute.py"} <= set(archive.namelist())
    assert any(name.endswith("licenses/LICENSE") for name in archive.namelist())


def test_installed_anew_everything_runs(fresh: Path, tmp_path: Path) -> None:
    """One test for all that needs the fresh environment: making it takes longer than using it."""
    _comes_from_the_wheel(fresh, tmp_path)
    _lists_and_describes(fresh, tmp_path)
    for name in ("screw_joint", "press_linkage"):
        _runs(fresh, tmp_path, name)
    _shares_the_work(fresh, tmp_path)


def _comes_from_the_wheel(fresh: Path, folder: Path) -> None:
    code = "import truing, pathlib; print(pathlib.Path(truing.__file__).parent)"
    found = process([str(fresh / "python"), "-c", code], folder).out.strip()
    assert Path(found).is_relative_to(fresh.parent)
    assert (Path(found) / "templates" / "sheet.css").is_file()


def _lists_and_describes(fresh: Path, folder: Path) -> None:
    listed = calc(fresh, folder, "plugins")
    assert listed.code == 0, listed.err
    for name in ("press_linkage", "screw_joint", "frame_settling"):
        assert name in listed.out
    assert "tables.py:6: plugin 'broken_guest' 0.0.7: IndexError" in listed.err
    assert str(ROOT) not in listed.out + listed.err
    assert calc(fresh, folder, "describe", "screw_joint").code == 0
    others = [[str(fresh / "truing")], [str(fresh / "python"), "-m", "truing"]]
    answers = [process([*command, "plugins", "--names"], folder) for command in others]
    ours = ["harmonic_fractal", "press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"]
    assert [answer.out.split() for answer in answers] == [["broken_guest", *ours, "screw_joint"]] * 2


def _runs(fresh: Path, folder: Path, name: str) -> None:
    assert calc(fresh, folder, "init", name, "-o", f"{name}.toml").code == 0
    done = calc(fresh, folder, "run", name, "--inputs", f"{name}.toml")
    assert done.code == 0, done.err
    assert "<math" in (folder / "runs" / name / "sheet.html").read_text(encoding="utf-8")
    results = json.loads((folder / "runs" / name / "results.json").read_text(encoding="utf-8"))
    assert results["plugin"]["name"] == name


def _shares_the_work(fresh: Path, folder: Path) -> None:
    """Results are byte for byte the same with two worker processes."""
    few = ("--set", "studies.reliability.draws=40000", "--output")
    for name, workers in (("one", "1"), ("two", "2")):
        done = calc(fresh, folder, "run", "screw_joint", "--workers", workers, *few, name)
        assert done.code == 0, done.err
    one, two = ((folder / name / "results.json").read_bytes() for name in ("one", "two"))
    assert one == two
