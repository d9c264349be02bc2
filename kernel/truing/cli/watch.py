"""calc watch: the sheet is made anew whenever the inputs, the data files or the plugin's code are saved."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from truing.api.model import Diagnosis, LoadedModel
from truing.api.records import MeasuredRecord
from truing.api.run import Run
from truing.atomic import writings, written
from truing.cli.console import Settings, out, say, sentence_of
from truing.cli.load import LABEL, find_offer, stated_words
from truing.errors import UsageError
from truing.inputs_file.files import refuse_file
from truing.kernel import Offer
from truing.numbers import counted
from truing.report.diagnosis_words import verdict_word
from truing.runs.comparison import amount_of, compared, in_order
from truing.runs.folder import FolderKind, demand_place
from truing.studies.checks import EXIT_CODES, SHORT
from truing.texts import one_line
from truing.watching import WatchedFiles, code_files, files_named_in, forget
from truing.workbooks.reading import file_of

MOST = 4
"""So many changed results are named."""
LOOKS = 2


def watch(settings: Settings, asked: SimpleNamespace) -> int:
    """Run, or with --data diagnose, again whenever inputs, data files or the plugin's code change; Ctrl-C ends it."""
    sys.dont_write_bytecode = True  # two savings within one second would otherwise be one to Python
    inputs: Path = asked.inputs
    offer = find_offer(asked.plugin, settings)
    measured = tuple(asked.data or ())
    if measured and (asked.cases or asked.excel or asked.workers > 1):
        raise UsageError("--cases, --excel and --workers are for runs; a diagnosis (--data) has none of them")
    for file in (path for path in map(file_of, (inputs, *measured)) if not path.is_file()):
        refuse_file(file, largest=0, instead="", is_table=False)
    folder = asked.output or Path("runs") / file_of((measured or (inputs,))[0]).stem
    how = {"xlsx": asked.xlsx}
    how |= {} if measured else {"cases": asked.cases, "workers": asked.workers, "excel": asked.excel}
    watcher = _Watcher(
        asked.plugin, inputs, measured, stated_words(asked.changed, asked.language), folder, how, settings
    )
    demand_place(folder, watcher.kind)
    watched = WatchedFiles(asked.every)
    settings.say(f"watching {inputs} and the code of {offer.name}; Ctrl-C ends it")
    try:
        while True:
            watched.add(watcher.files(offer))
            watcher.run(offer)
            watched.add(watcher.files(offer))
            offer = watcher.loaded_anew(offer, watched.changed())
    except KeyboardInterrupt as end:
        if watcher.calculating:
            end.args = (f"calc: interrupted in the middle of a {watcher.kind}; {watcher.what_stays()}",)
            raise
        many = counted(watcher.runs, *(("diagnosis", "diagnoses") if measured else ("run",)))
        settings.say(f"calc: watched {many}; {watcher.what_stays()}")
        return watcher.exit_code


@dataclass
class _Watcher:
    """What is run again and again, and what the last run said."""

    plugin: str
    inputs: Path
    measured: tuple[Path, ...]
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

    @property
    def kind(self) -> FolderKind:
        """What is made again and again."""
        return "diagnosis" if self.measured else "run"

    def files(self, offer: Offer) -> list[Path]:
        """Return everything whose change asks for another run."""
        if self.looks:  # once as loaded, once after a run, which may import more
            self.looks -= 1
            self.code |= code_files(offer)
        given = [self.inputs, *self.measured, *filter(None, [self.how.get("cases")])]
        return [*map(file_of, given), *files_named_in(self.inputs, offer), *sorted(self.code)]

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
        model = LoadedModel(offer, self.overrides, label=LABEL)
        how = {"output": self.folder, "progress": not self.settings.quiet, **self.how}
        try:
            if self.measured:
                done: Run | Diagnosis = model.diagnose(MeasuredRecord(self.measured), self.inputs, **how)
            else:
                done = model.run(self.inputs, **how)
        except Exception as error:
            self.calculating = False
            self._complain(error)
            return
        self.calculating = False
        self._report(done, time.monotonic() - started)

    def _report(self, done: Run | Diagnosis, seconds: float) -> None:
        self._warn(done)
        self.runs += 1
        if isinstance(done, Run):
            state = _state(done.document)
        else:
            state = f"{verdict_word(done.result)}. {done.sentences[0]}".rstrip(".")
        sheet = f"{state}; sheet: {self.folder / 'sheet.html'}"
        what = sheet if self.last is None else f"{_changes(self.last, done.document)}; {state}"
        self.last, self.made_at = done.document, time.strftime("%H:%M:%S")
        self.exit_code = EXIT_CODES[done.verdict] if isinstance(done, Run) else 0
        if not out(one_line(f"{self.made_at} {seconds:.1f} s {what}")):
            raise KeyboardInterrupt

    def _warn(self, done: Run | Diagnosis) -> None:
        """Say the warnings that the last one did not have, and the cases that failed."""
        said = [f"warning: {one_line(warning)}" for warning in done.warnings]
        if isinstance(done, Diagnosis):
            said += [f"note: {one_line(note)}" for note in done.notes]
        elif done.cases is not None:
            said += [str(case.fault) for case in done.cases.cases if case.reason is not None]
        for text in said:
            if text not in self.warned:
                self.settings.say(text)
        self.warned = set(said)

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


def _state(document: Mapping[str, Any]) -> str:
    """Say which checks of a run fail."""
    checks = [*document["checks"], *(check for case in document.get("cases", []) for check in case["checks"])]
    of = {state: list(dict.fromkeys(check["name"] for check in checks if check["state"] == state)) for state in SHORT}
    said = [f"{SHORT[state]}: {', '.join(of[state])}" for state in ("fails", "undecided", "proposed") if of[state]]
    return "; ".join(said) or ("all checks pass" if checks else "no checks")


def _changes(before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    """Say which checks flipped and which results moved most, or what a diagnosis names anew."""
    differing = in_order(compared(before, after))
    flips = [f"{change.name} {amount_of(change).partition(',')[0]}" for change in differing if change.flipped]
    moved = [change for change in differing if change.kind in {"results", "causes"}]
    moved.sort(key=lambda change: -abs(change.relative or 0.0))
    said = [f"{change.name} {amount_of(change)}".strip() for change in moved[:MOST]]
    more = [f"and {len(moved) - MOST} more"] if len(moved) > MOST else []
    return ", ".join([*flips, *said, *more]) or ("results as before" if differing else "nothing changed")
