"""What tests share: the command line, here or as a process of its own, and the strangers' plugins."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
ROOT = TESTS.parent
GUESTS = ("screw_joint", "broken_guest")

collect_ignore = ["third_party", "data"]
sys.path += [str(TESTS / "data"), str(TESTS / "data" / "gear_record")]


@dataclass(frozen=True)
class Answer:
    """What a command answered: exit code, results, and everything else that was said."""

    code: int
    out: str
    err: str


Calc = Callable[..., Answer]


@pytest.fixture
def calc(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Calc:
    """Run ``calc`` in this process, in an empty folder unless ``cwd`` names one."""

    def run(*arguments: str | Path, cwd: Path = tmp_path) -> Answer:
        from truing.cli import main

        monkeypatch.chdir(cwd)
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return Answer(code, said.out, said.err)

    return run


@pytest.fixture
def calc_process(tmp_path: Path) -> Calc:
    """Run ``calc`` as a process of its own; ``path`` is where it finds further packages."""

    def run(*arguments: str | Path, cwd: Path = tmp_path, path: Path | None = None) -> Answer:
        more = {"PYTHONPATH": str(path)} if path is not None else {}
        return process([sys.executable, "-m", "truing", *map(str, arguments)], cwd, more)

    return run


def process(command: list[str], cwd: Path, more: Mapping[str, str] | None = None) -> Answer:
    """Run a command, speaking UTF-8, outside of the project's folder."""
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "COLUMNS"}}
    done = subprocess.run(
        command,
        cwd=cwd,
        env={**environment, "PYTHONUTF8": "1", **(more or {})},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=900,
        check=False,
    )
    return Answer(done.returncode, done.stdout, done.stderr)


def copied_guest(name: str, folder: Path) -> Path:
    """Copy a stranger's project, so that building it leaves nothing behind."""
    target = folder / name
    shutil.copytree(TESTS / "third_party" / name, target, ignore=shutil.ignore_patterns("__pycache__"))
    return target


@pytest.fixture(scope="session")
def strangers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the strangers' plugins, installed as pip installs them, beside this environment."""
    folder = tmp_path_factory.mktemp("strangers")
    sources = [str(copied_guest(name, folder / "sources")) for name in GUESTS]
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    target = folder / "installed"
    done = process([sys.executable, "-m", "pip", "install", *options, "--target", str(target), *sources], folder)
    assert done.code == 0, done.err
    return target
