"""What tests share beside the fixtures of ``truing.testing``: the strangers' plugins."""

import sys
from pathlib import Path

import pytest

from shared import GUESTS, TESTS, copied_guest, process

collect_ignore = ["third_party", "data"]
sys.path += [str(TESTS / "data"), str(TESTS / "data" / "gear_record")]


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
