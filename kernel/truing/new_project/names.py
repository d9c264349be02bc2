"""Names and titles of new plugins: what may be written in Python, in a package index and on every system."""

from __future__ import annotations

import keyword
import re
import unicodedata
from importlib.util import find_spec

from truing.errors import UsageError
from truing.formulas.symbols import printable
from truing.kernel import Kernel

LONGEST_NAME = 40
WIDEST_TITLE = 70
SPELLING = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
OF_THE_PROJECT = frozenset({"build", "conftest", "dist", "mypy", "pytest", "ruff", "runs", "tests", "venv"})
"""Names that a project uses for something else, whether that is installed here or not."""
OF_WINDOWS = frozenset(
    {"aux", "con", "nul", "prn", *(f"{port}{digit}" for port in ("com", "lpt") for digit in "123456789")}
)
"""Names of devices: Windows makes no file of such a name."""
_GERMAN = {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue"}


def check_name(name: str) -> None:
    """Raise UsageError, with one sentence, unless ``name`` can be the name of a new plugin.

    It is the name of a Python package and of the calculation, and with dashes that of the distribution.
    """
    fault = _fault_of_spelling(name) or _fault_of_meaning(name)
    if fault:
        raise UsageError(fault)


def _fault_of_spelling(name: str) -> str:
    shown = f"'{_short(printable(name))}'"
    if not SPELLING.fullmatch(name):
        better = spelled(name)
        advice = f"write {better}" if better else "write words of letters and digits, such as belt_drive"
        return f"{shown} is no name for a plugin: lower-case words joined by _, a letter first; {advice}"
    if len(name) > LONGEST_NAME:
        return f"{shown} is too long for a name that is typed often: at most {LONGEST_NAME} characters"
    if keyword.iskeyword(name):
        return f"{shown} is a word of Python itself; choose another name"
    if name in OF_WINDOWS:
        return f"{shown} is a device on Windows, where no file can have this name; choose another name"
    if name in OF_THE_PROJECT:
        return f"{shown} has another meaning in a project of this kind; choose another name"
    return ""


def _fault_of_meaning(name: str) -> str:
    kernel = Kernel.installed()
    for offer in kernel.offers.values():
        if name in {offer.origin.name, offer.model.name}:
            return f"'{name}' is a calculation of {offer.origin.distribution or offer.origin.file}; choose another name"
    if name in {broken.plugin for broken in kernel.broken}:
        return f"'{name}' is an installed plugin (one that cannot be loaded: see calc plugins); choose another name"
    spec = find_spec(name)
    if spec is not None and spec.origin is not None:
        where = "Python itself" if spec.origin in {"built-in", "frozen"} else spec.origin
        return f"'{name}' is a module already ({where}); choose another name"
    return ""


def _short(text: str) -> str:
    return text if len(text) <= LONGEST_NAME else text[:LONGEST_NAME] + "..."


def spelled(name: str) -> str:
    """Return the nearest spelling that a name may have, empty where nothing is left of it."""
    plain = "".join(_GERMAN.get(letter, letter) for letter in unicodedata.normalize("NFC", name))
    plain = "".join(letter for letter in unicodedata.normalize("NFKD", plain) if not unicodedata.combining(letter))
    plain = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", plain)
    better = re.sub(r"[^a-z0-9]+", "_", plain.lower()).lstrip("_0123456789").rstrip("_")
    is_good = SPELLING.fullmatch(better) and len(better) <= LONGEST_NAME and not keyword.iskeyword(better)
    return better if is_good else ""


def title_of(name: str) -> str:
    """Return the title of a plugin that is given none: its name in words."""
    return name.replace("_", " ").capitalize()


def check_title(title: str) -> None:
    """Raise UsageError unless ``title`` is one line of printable text that fits into a line of Python."""
    if not title.strip():
        raise UsageError("--title: a title has at least one character")
    if not title.isprintable():
        raise UsageError("--title: a title is one line of printable characters")
    if width(title) > WIDEST_TITLE:
        raise UsageError(f"--title: the title is too long for the head of a sheet: at most {WIDEST_TITLE} characters")


def width(text: str) -> int:
    """Return how many columns a text takes: wide characters take two, and so does what Python needs to escape."""
    return sum(1 + (unicodedata.east_asian_width(letter) in "WF" or letter in "\\'\"") for letter in text)
