"""What differs between two runs, or two diagnoses: in hand, in folders, or of two inputs files that run now."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from truing.api.notebook import html_table, paragraphs
from truing.api.tables import frame_of
from truing.errors import Fault, InputError, TruingError, UsageError
from truing.kernel import offer_of
from truing.report.comparison_page import Side, comparison_page, figures_of
from truing.report.run import demand_ending, write_sheet
from truing.runs.comparison import Change, compared, in_order, words_of
from truing.runs.folder import load_either
from truing.templating import ENGLISH, demand_language
from truing.workbooks.reading import file_of, is_workbook

CHANGE_COLUMNS = ("what", "name", "before", "after", "change")


class Finished(Protocol):
    """A run that can be compared."""

    @property
    def document(self) -> dict[str, Any]:
        """What results.json holds."""

    def side(self, name: str, language: str) -> Side:
        """Return what a page of two runs is written from, its figures in a language; "" is that of the run."""


@dataclass(frozen=True)
class Differences:
    """What differs between two runs, or two diagnoses: checks of another state first. False where nothing does."""

    changes: tuple[Change, ...]
    documents: tuple[Mapping[str, Any], Mapping[str, Any]]
    sides: Callable[[str], tuple[Side, Side]]
    """Makes what the page is written from, in a language: both documents, their figures, and their models."""

    def __repr__(self) -> str:
        return "\n".join("  ".join(words_of(change)) for change in self.changes) or "equal"

    def __bool__(self) -> bool:
        """Whether anything differs."""
        return bool(self.changes)

    def frame(self) -> Any:
        """Return the differences as a dataframe of texts: what, name, before, after, change."""
        rows = [words_of(change) for change in self.changes]
        return frame_of({name: [row[index] for row in rows] for index, name in enumerate(CHANGE_COLUMNS)})

    def sheet(self, path: str | Path, *, language: str = "") -> Path:
        """Write the two side by side, with their figures, as HTML, Markdown, PDF or a Word document, as the name ends.

        ``language`` is "en" (that of "", too) or "de". Figures of a folder stay as they were drawn, and Word cannot
        take them. Raises OutputError, and UsageError for another language.
        """
        demand_language(language)
        demand_ending(Path(path))
        return write_sheet(path, lambda: comparison_page(*self.sides(language), language or ENGLISH))

    def _repr_html_(self) -> str:
        rows = [words_of(change) for change in self.changes]
        return html_table(rows, CHANGE_COLUMNS) if rows else paragraphs(["equal"])


def differences_of(
    before: Mapping[str, Any], after: Mapping[str, Any], sides: Callable[[str], tuple[Side, Side]]
) -> Differences:
    """Compare two documents. Raises UsageError for a run beside a diagnosis."""
    return Differences(tuple(in_order(compared(before, after))), (before, after), sides)


def differences_of_paths(
    before: str | Path, after: str | Path, run: Callable[[str, Path], Finished], *, plugin: str = ""
) -> Differences:  # fmt: skip
    """Compare what lies at two paths: folders of runs or diagnoses, or inputs files, which ``run(plugin, file)`` runs.

    An inputs file names its plugin unless ``plugin`` does. Raises UnknownPluginError for a path that is neither, and
    InputError where an inputs file names no plugin, or cannot be read.
    """
    paths = Path(before), Path(after)
    names = _names(*paths)
    read = [None if is_inputs_file(path) else load_either(path) for path in paths]
    named = [_plugin_of(path, plugin) if document is None else "" for path, document in zip(paths, read, strict=True)]
    done = [run(name, path) if name else None for name, path in zip(named, paths, strict=True)]

    def side(index: int, language: str) -> Side:
        ran, document = done[index], read[index]
        if ran is not None:
            return ran.side(names[index], language)
        return _side_of_folder(paths[index], names[index], document or {}, plugin)

    first, second = (document if ran is None else ran.document for ran, document in zip(done, read, strict=True))
    return differences_of(first or {}, second or {}, lambda language: (side(0, language), side(1, language)))


def is_inputs_file(path: Path) -> bool:
    """Tell whether a path is that of an inputs file, by its ending."""
    return file_of(path).suffix.lower() == ".toml" or is_workbook(path)


def _plugin_of(path: Path, plugin: str) -> str:
    """Return the plugin that runs an inputs file: the one that is named for it, or that the file names."""
    if plugin:
        return plugin
    if is_workbook(path):
        raise UsageError(f"{path}: a workbook is run by the plugin that --plugin names; add it")
    try:
        named = tomllib.loads(path.read_text(encoding="utf-8")).get("plugin")
    except OSError as error:
        raise InputError([Fault(f"cannot be read: {error.strerror or error}", str(path))]) from None
    except ValueError as error:
        raise InputError([Fault(f"is no TOML: {error}", str(path))]) from None
    if not isinstance(named, str) or not named:
        raise InputError([Fault('names no plugin; write plugin = "NAME" above its sections, or add --plugin NAME',
                                str(path), 1)])  # fmt: skip
    return named


def _names(before: Path, after: Path) -> tuple[str, str]:
    """Name two paths by their last parts, or as they were written where these are equal."""
    names = before.absolute().name, after.absolute().name
    return names if names[0] != names[1] else (str(before), str(after))


def _side_of_folder(path: Path, name: str, document: Mapping[str, Any], plugin: str) -> Side:
    """Read the figures of the sheet that lies beside a document; a folder without one has none."""
    folder = path if path.is_dir() else path.parent
    try:
        page = (folder / "sheet.html").read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        page = ""
    named = str((document.get("plugin") or {}).get("model"))
    if not plugin and named.endswith(".py"):  # a file runs only where the user names it: this may come from anywhere
        return Side(name, document, figures_of(page))
    try:  # the names get their notes from the model
        offer = offer_of(plugin or named, lambda _: None)
    except TruingError:
        return Side(name, document, figures_of(page))
    return Side(name, document, figures_of(page), offer.model, offer.origin.file)
