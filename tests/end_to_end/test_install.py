"""Everything installed anew: our wheel, two strangers' projects and one of ``calc new`` in a fresh environment."""

import json
import os
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

from shared import ROOT, Answer, build_wheels, process
from truing.new_project import NewPlugin, project, write_project

pytestmark = pytest.mark.install
OURS = {path.name for path in (ROOT / "plugins").iterdir() if (path / "__init__.py").is_file()}
ARM = NewPlugin("gantry_arm", 'Arm of a gantry, 5" wide: „Übung“ \\ 1')
COMPILED_ONCE = {"PYTHONDONTWRITEBYTECODE": ""}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build our wheel, and beside it that of a project that is made anew."""
    folder = tmp_path_factory.mktemp("wheels")
    write_project(folder / ARM.name, project(ARM))
    return build_wheels(folder, [ROOT, folder / ARM.name])[0]


@pytest.fixture(scope="module")
def fresh(wheel: Path, guest_wheels: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a fresh environment with both and two strangers' wheels; returns its folder of commands.

    What they need comes from the environment of the tests, behind the wheels; that it is declared is checked.
    """
    folder = tmp_path_factory.mktemp("fresh")
    environment = folder / "environment"
    assert process([sys.executable, "-m", "venv", "--without-pip", str(environment)], folder).code == 0
    commands = environment / ("Scripts" if os.name == "nt" else "bin")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", str(commands / "python")]
    wheels = [*wheel.parent.glob("*.whl"), *guest_wheels]
    done = process([*pip, "install", "--quiet", "--no-compile", "--no-deps", *map(str, wheels)], folder)
    assert done.code == 0, done.err
    own = Path(sysconfig.get_path("purelib", vars={"base": str(environment), "platbase": str(environment)}))
    (own / "needed.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    check = process([*pip, "check"], folder)
    assert check.code == 0, check.out
    return commands


def command(commands: Path, folder: Path, *words: str) -> Answer:
    return process([str(commands / words[0]), *words[1:]], folder, COMPILED_ONCE)


def calc(commands: Path, folder: Path, *arguments: str) -> Answer:
    return command(commands, folder, "calc", *arguments)


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
    assert {"gear_geometry/__init__.py", "gear_geometry/pairs.py"} <= set(archive.namelist())
    assert any(name.endswith("licenses/LICENSE") for name in archive.namelist())


def test_installed_anew_everything_runs(fresh: Path, wheel: Path, tmp_path: Path) -> None:
    """One test for all that needs the fresh environment: making it takes longer than using it."""
    _comes_from_the_wheel(fresh, tmp_path)
    _lists_what_is_installed(fresh, tmp_path)
    _gives_our_examples(fresh, tmp_path)
    _shares_the_work(fresh, tmp_path)
    _writes_a_project(fresh, tmp_path)
    _passes_its_own_tests(fresh, wheel.parent / ARM.name)


def _comes_from_the_wheel(fresh: Path, folder: Path) -> None:
    code = "import truing, pathlib; print(pathlib.Path(truing.__file__).parent)"
    found = process([str(fresh / "python"), "-c", code], folder).out.strip()
    assert Path(found).is_relative_to(fresh.parent)
    assert (Path(found) / "templates" / "sheet.css").is_file()


def _lists_what_is_installed(fresh: Path, folder: Path) -> None:
    listed = calc(fresh, folder, "plugins")
    assert listed.code == 0, listed.err
    for name in ("press_linkage", "screw_joint", "frame_settling", ARM.title):
        assert name in listed.out
    assert "tables.py:6: plugin 'broken_guest' 0.0.7: IndexError" in listed.err
    assert str(ROOT) not in listed.out + listed.err
    others = [[str(fresh / "truing")], [str(fresh / "python"), "-m", "truing"]]
    answers = [process([*command, "plugins", "--names"], folder) for command in others]
    ours = ["harmonic_fractal", "press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"]
    assert [answer.out.split() for answer in answers] == [["broken_guest", ARM.name, *ours, "screw_joint"]] * 2


def _gives_our_examples(fresh: Path, folder: Path) -> None:
    """That of the press, which lies beside its code; what is run below needs all else that a run of it needs."""
    done = calc(fresh, folder, "init", "press_linkage", "-o", "press.toml")
    assert done.code == 0, done.err
    assert 'plugin = "press_linkage"' in (folder / "press.toml").read_text(encoding="utf-8")


def _shares_the_work(fresh: Path, folder: Path) -> None:
    """A stranger's calculation with two worker processes, which find it too."""
    few = ("--set", "studies.reliability.draws=40000", "--output", "two")
    done = calc(fresh, folder, "run", "screw_joint", "--workers", "2", *few)
    assert done.code == 0, done.err
    assert "<math" in (folder / "two" / "sheet.html").read_text(encoding="utf-8")
    results = json.loads((folder / "two" / "results.json").read_text(encoding="utf-8"))
    assert results["plugin"]["name"] == "screw_joint"
    assert json.loads((folder / "two" / "run.json").read_text("utf-8"))["workers"]["count"] == 2


def _writes_a_project(fresh: Path, folder: Path) -> None:
    """The templates in the wheel are those of the sources."""
    assert calc(fresh, folder, "new", "belt_drive").code == 0
    written = {path.relative_to(folder / "belt_drive").as_posix(): path for path in (folder / "belt_drive").rglob("*")}
    files = {name: path.read_text(encoding="utf-8") for name, path in written.items() if path.is_file()}
    assert files == project(NewPlugin("belt_drive", "Belt drive"))


def _passes_its_own_tests(fresh: Path, folder: Path) -> None:
    """A project of ``calc new``, as written, run and diagnosed from the command line; a tutorial runs all its tests."""
    done = command(fresh, folder, "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", "command_line")
    assert done.code == 0, done.out
    assert " passed" in done.out
    assert not any(word in done.out for word in ("skipped", "warning", "xfailed"))
