"""What calc new writes: a plugin of one's own, as a project or as a single file, born with its tests."""

from __future__ import annotations

import json
import keyword
import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from truing.atomic import place_folder, recover, write_files
from truing.errors import OutputError, UsageError
from truing.formulas.symbols import printable
from truing.kernel import Kernel
from truing.report.markdown_printer import escaped
from truing.templating import rendered

PROJECT = {
    ".github/workflows/tests.yml": "workflow.yml.j2",
    ".gitignore": "gitignore.j2",
    "README.md": "README.md.j2",
    "measured.csv": "measured.csv",
    "pyproject.toml": "pyproject.toml.j2",
    "NAME/__init__.py": "package.py.j2",
    "NAME/physics.py": "physics.py.j2",
    "NAME/py.typed": "py.typed.j2",
    "tests/test_NAME.py": "tests.py.j2",
}
"""The files of a project by their path, and the template of each; NAME stands for the plugin's name."""


@dataclass(frozen=True)
class NewPlugin:
    """What a new plugin is called: its name in Python and on the command line, and the title of its sheet."""

    name: str
    title: str

    @property
    def words(self) -> dict[str, str]:
        """What the templates may print, the title written for every language that quotes it."""
        return {
            "name": self.name,
            "distribution": self.name.replace("_", "-"),
            "title_python": python_text(self.title),
            "title_toml": json.dumps(self.title, ensure_ascii=False),
            "title_markdown": escaped(self.title),
            "truing": ".".join(version("truing").split(".")[:2]),
        }


def python_text(text: str) -> str:
    """Write a printable text as a Python literal, with the quotation mark that needs fewer escapes."""
    mark = "'" if text.count('"') > text.count("'") else '"'
    return mark + text.replace("\\", "\\\\").replace(mark, "\\" + mark) + mark


def project(plan: NewPlugin) -> dict[str, str]:
    """Return the files of a project by their path inside it: package, tests, packaging, README, CI, made rows."""
    return {
        path.replace("NAME", plan.name): rendered(f"plugin/{template}", plan.words)
        for path, template in PROJECT.items()
    }


def single_file(plan: NewPlugin) -> str:
    """Return a plugin as one Python file: physics, model, hook and tests."""
    return rendered("single/calculation.py.j2", plan.words)


def write_project(folder: Path, files: Mapping[str, str]) -> None:
    """Write a project into a folder that is not there yet, or empty.

    Raises OutputError where something lies there, or where nothing can be written; then nothing is.
    """
    try:
        if folder.is_dir():
            recover(folder.absolute() / folder.absolute().name)
            if any(folder.iterdir()):
                raise OutputError(f"{folder}: the folder is there and not empty; name another place with --output")
        elif folder.exists() or folder.is_symlink():
            raise OutputError(f"{folder}: is there already and no folder; name another place with --output")
    except OSError as error:
        raise OutputError(f"{folder}: the project cannot be written: {error.strerror or error}") from error
    place_folder(folder, files, "project")


def write_single_file(path: Path, text: str) -> None:
    """Write one file that is not there yet. Raises OutputError where it is, or where it cannot be written."""
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; name the file with --output")
    if path.exists():
        raise OutputError(f"{path}: is there already; name another file with --output")
    write_files({path: text})


# Names and titles of new plugins: what may be written in Python, in a package index and on every system


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
