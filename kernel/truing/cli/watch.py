"""calc watch: the sheet is made anew whenever the inputs, their data files or the plugin's code are saved."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from truing.api.model import LoadedModel
from truing.api.run import Run
from truing.atomic import writings, written
from truing.cli.console import Settings, out, say, sentence_of
from truing.cli.load import LABEL, find_offer
from truing.inputs_file.files import refuse_file
from truing.kernel import Offer
from truing.numbers import counted
from truing.runs.comparison import amount_of, changes, in_order
from truing.runs.folder import demand_place
from truing.studies.checks import EXIT_CODES, SHORT
from truing.texts import one_line
from truing.watching import WatchedFiles, code_files, files_named_in, forget

MOST = 4
"""So many changed results are named."""
LOOKS = 2


def watch(
    settings: Settings,
    *,
    plugin: str,
    inputs: Path,
    changed: list[str] | None,
    cases: Path | None,
    output: Path | None,
    excel: bool,
    workers: int,
    every: float,
) -> int:
    """Run, and run again whenever the inputs file, its data files or the plugin's code change; Ctrl-C ends it."""
    sys.dont_write_bytecode = True  # two savings within one second would otherwise be one to Python
    offer = find_offer(plugin, settings)
    _demand_file(inputs)
    folder = output or Path("runs") / inputs.stem
    demand_place(folder)
    how = {"cases": cases, "workers": workers, "excel": excel, "progress": not settings.quiet}
    watcher = _Watcher(plugin, inputs, tuple(changed or ()), folder, how, settings)
    watched = WatchedFiles(every)
    settings.say(f"watching {inputs} and the code of {offer.name}; Ctrl-C ends it")
    try:
        while True:
            watched.add(watcher.files(offer))
            watcher.run(offer)
            watched.add(watcher.files(offer))
            offer = watcher.loaded_anew(offer, watched.changed())
    except KeyboardInterrupt as end:
        if watcher.calculating:
            end.args = (f"calc: interrupted in the middle of a run; {watcher.what_stays()}",)
            raise
        settings.say(f"calc: watched {counted(watcher.runs, 'run')}; {watcher.what_stays()}")
        return watcher.exit_code


def _demand_file(inputs: Path) -> None:
    if not inputs.is_file():
        refuse_file(inputs, largest=0, instead="", is_table=False)


@dataclass
class _Watcher:
    """What is run again and again, and what the last run said."""

    plugin: str
    inputs: Path
    overrides: tuple[str, ...]
    folder: Path
    how: Mapping[str, Any]
    settings: Settings
    code: set[Path] = field(default_factory=set)
    last: Mapping[str, Any] | None = None
    made_at: str = ""
    warned: set[str] = field(default_factory=set)
    runs: int = 0
    broken: bool = False
    looks: int = LOOKS
    calculating: bool = False
    exit_code: int = 1
    before: int = 0

    def files(self, offer: Offer) -> list[Path]:
        """Return everything whose change asks for another run."""
        if self.looks:  # once as loaded, once after a run, which may import more
            self.looks -= 1
            self.code |= code_files(offer)
        given = [self.inputs, *([self.how["cases"]] if self.how["cases"] else [])]
        return [*given, *files_named_in(self.inputs, offer), *sorted(self.code)]

    def loaded_anew(self, offer: Offer, files: Sequence[Path]) -> Offer:
        """Return the calculation as its code is now; where that is broken say so and keep the last that was whole."""
        self.settings.detail(f"changed: {', '.join(file.name for file in files)}")
        if not self.broken and not self.code & {file.resolve() for file in files}:
            return offer
        forget(self.code)
        try:
            fresh = find_offer(self.plugin, self.settings)
        except Exception as error:
            self.broken = True
            self._complain(error)
            return offer
        self.broken, self.looks = False, LOOKS
        return fresh

    def run(self, offer: Offer) -> None:
        """Run once and say so in one line; what is wrong is said, and the last sheet stays."""
        if self.broken:
            return
        started, self.before, self.calculating = time.monotonic(), writings(), True
        try:
            model = LoadedModel(offer, self.overrides, label=LABEL)
            done = model.run(self.inputs, output=self.folder, **self.how)
        except Exception as error:
            self.calculating = False
            self._complain(error)
            return
        self.calculating = False
        self._report(done, time.monotonic() - started)

    def _report(self, done: Run, seconds: float) -> None:
        self._warn(done)
        self.runs += 1
        what = _words(self.last, done.document, self.folder)
        self.last, self.made_at = done.document, time.strftime("%H:%M:%S")
        self.exit_code = EXIT_CODES[done.verdict]
        if not out(one_line(f"{self.made_at} {seconds:.1f} s {what}")):
            raise KeyboardInterrupt

    def _warn(self, done: Run) -> None:
        """Say the warnings that the last run did not have, and the cases that failed."""
        cases = done.cases.cases if done.cases is not None else ()
        failed = [str(case.fault) for case in cases if case.reason is not None]
        for text in (*(f"warning: {one_line(warning)}" for warning in done.warnings), *failed):
            if text not in self.warned:
                self.settings.say(text)
        self.warned = {*(f"warning: {one_line(warning)}" for warning in done.warnings), *failed}

    def _complain(self, error: Exception) -> None:
        self.exit_code = 1
        if self.settings.traceback:
            traceback.print_exception(error)
        say(sentence_of(error))
        self.settings.say(f"{time.strftime('%H:%M:%S')} not calculated; {self.what_stays()}")

    def what_stays(self) -> str:
        """Say which sheet is there."""
        if self.calculating and written(self.before):
            return "its sheet is complete"
        return f"the sheet of {self.made_at} stays" if self.made_at else "there is no sheet yet"


def _words(before: Mapping[str, Any] | None, after: Mapping[str, Any], folder: Path) -> str:
    """Say in one line what a run changed and which checks fail."""
    checks = [*after["checks"], *(check for case in after.get("cases", []) for check in case["checks"])]
    of = {state: list(dict.fromkeys(check["name"] for check in checks if check["state"] == state)) for state in SHORT}
    said = [f"{SHORT[state]}: {', '.join(of[state])}" for state in ("fails", "undecided", "proposed") if of[state]]
    state = "; ".join(said) or ("all checks pass" if checks else "no checks")
    if before is None:
        return f"{state}; sheet: {folder / 'sheet.html'}"
    return f"{_changes(before, after)}; {state}"


def _changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    """Say which checks flipped and which results moved most."""
    found = in_order(changes(before, after))
    flips = [f"{change.name} {amount_of(change).partition(',')[0]}" for change in found if change.flipped]
    moved = [change for change in found if change.kind == "results"]
    moved.sort(key=lambda change: -abs(change.relative or 0.0))
    said = [f"{change.name} {amount_of(change)}".strip() for change in moved[:MOST]]
    more = [f"and {len(moved) - MOST} more"] if len(moved) > MOST else []
    return ", ".join([*flips, *said, *more]) or ("results as before" if found else "nothing changed")
