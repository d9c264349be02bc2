"""What tests share beside the fixtures of ``truing.testing``: the size of torture tests, the strangers' plugins."""

import os
import sys
from pathlib import Path

import pytest
from xdist.scheduler import WorkStealingScheduling

from shared import GUESTS, ROOT, TESTS, copied_guest, process

collect_ignore = ["third_party", "data"]
sys.path += [str(TESTS / "data"), str(TESTS / "data" / "gear_record")]
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # the commands that tests run compile the kernel once, not each
os.environ.setdefault("MYPY_CACHE_DIR", str(ROOT / ".mypy_cache"))  # one check of types reads what another has
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # the workers of the suite share the cores; a test of threads sets its own


SOFT = "what the diagnosis says here is known to be wrong; it is to be put right: "
KNOWN_WRONG = {
    "test_rows_held_out_are_predicted_as_well_as_can_be[interrupted_tooth-bench-autocorrelated-root_stress_ring]": (
        "1.075 of the noise, where 1.07 is asked for"
    ),
    "test_rows_held_out_are_predicted_as_well_as_can_be[relief_error-rig-growing-root_stress_sun+contact_stress]": (
        "0.88 of a gain of 2 % is removed, at p 0.031, where 0.9 is asked for"
    ),
    "test_the_cause_is_named[joint_wear-wide-heavy-1]": (
        "the wear is named, and whether a drift is there as well is left open: chance gives as much in one of ten"
    ),
    "test_what_nobody_registered_is_called_unknown[feed_marks-surface]": (
        "marks every 9 um draw waves of 9, 3, ... um; one of them is called waviness, the other one is unregistered"
    ),
}
"""By the end of a test's name: answers of the diagnosis that are known to be wrong, each with what is wrong."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Expect the answers that are known to be wrong to fail."""
    for item in items:
        reason = next((why for name, why in KNOWN_WRONG.items() if item.nodeid.endswith(name)), "")
        if reason:
            item.add_marker(pytest.mark.xfail(strict=False, reason=SOFT + reason))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the size of the torture tests: ``python -m pytest tests/torture --torture=full``."""
    parser.addoption(
        "--torture", choices=["modest", "full"], default="modest", help="size of the tests in tests/torture"
    )


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> WorkStealingScheduling:
    """Give every worker tests that stand one after another, so that what these share is made once."""
    return WorkStealingScheduling(config, log)


@pytest.fixture(scope="session")
def full_torture(request: pytest.FixtureRequest) -> bool:
    """Return whether the torture tests run at full size; the suite runs them at a modest one."""
    return bool(request.config.getoption("--torture") == "full")


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
