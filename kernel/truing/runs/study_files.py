"""The files that studies leave in a run folder beside the sheet: a made surface, a table to work on with."""

from __future__ import annotations

import re
from collections.abc import Mapping

from truing.errors import PluginError
from truing.studies.bench import Outcome, files_of

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}", re.ASCII)


def study_files(outcomes: Mapping[str, Outcome], taken: Mapping[str, str | bytes]) -> dict[str, str | bytes]:
    """Return what the outcomes' ``files`` hold, by file name; an outcome without any leaves none.

    Raises PluginError for a name that is no plain file name, that a run folder or another study uses, and for content
    that is neither text nor bytes.
    """
    found: dict[str, str | bytes] = {}
    for study, outcome in outcomes.items():
        for name, content in files_of(outcome).items():
            if not NAME.fullmatch(name) or name.endswith("."):
                raise PluginError(f"study '{study}' names its file {name!r}; a plain file name is wanted")
            if name.casefold() in {other.casefold() for other in (*taken, *KEPT, *found)}:
                raise PluginError(f"study '{study}' names its file '{name}', which the run folder has already")
            if not isinstance(content, (str, bytes)):
                raise PluginError(
                    f"study '{study}' gives '{name}' as {type(content).__name__}; text or bytes is wanted"
                )
            found[name] = content
    return found


KEPT = (
    "inputs.toml", "results.json", "run.json", "sheet.html", "sheet.md", "sheet.pdf", "arrays.npz", "results.csv",
    "cases.csv",
)  # fmt: skip
"""Names that a run folder uses itself, or may use."""
