"""What tests share: the command line, here or as a process of its own, and the strangers' plugins."""

import sys
from pathlib import Path

import pytest

from shared import GUESTS, TESTS, Answer, Calc, copied_guest, process

collect_ignore = ["third_party", "data"]
sys.path += [str(TESTS / "data"), str(TESTS / "data" / "gear_record")]


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
