"""No operation can fail badly: errors, interrupts and death at every file operation of every verb.

Each case runs in a fork, where an audit hook counts the file operations and lets the i-th one fail. Afterwards the old
files are there or the new ones, whole; what is said is one sentence and true; the next run clears up what a death left.
"""

from __future__ import annotations

import errno
import json
import os
import random
import resource
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from forked import End, filled, forked, stop_watching

from shared import ROOT
from truing import atomic
from truing.atomic import recover

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs os.fork, which Windows has not")

OPERATIONS = {
    "open", "os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.link", "os.symlink", "os.truncate", "os.chmod",
    "os.utime", "os.scandir", "os.listdir", "shutil.rmtree", "shutil.copyfile", "tempfile.mkstemp", "tempfile.mkdtemp",
    "fcntl.flock",
}  # fmt: skip
DIED = 77
ERRORS = ("ENOSPC", "EIO", "EACCES", "EINTR")
FAULTS = (*ERRORS, "Ctrl-C", "death")
HIDDEN = (".part", ".old")
INSTALLED = (sys.base_prefix, sys.prefix, str(ROOT / "kernel"), str(ROOT / "plugins"), str(ROOT / "templates"))


@dataclass(frozen=True)
class Case:
    """A verb and what lies there before; ``results`` are the files and folders that it writes."""

    words: str
    results: tuple[str, ...] = ()
    before: Callable[[Path], object] = lambda place: None
    patched: Callable[[], object] = lambda: None
    is_filled: bool = False
    """An empty folder is filled file by file: a death leaves some of them."""


def _older(*names: str) -> Callable[[Path], object]:
    def put(place: Path) -> None:
        for name in names:
            source = place / "older" / name
            target = place / name
            target.parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if source.is_dir() else shutil.copy)(source, target)

    return put


def _without_exchange() -> None:
    atomic._exchange = lambda: None


CASES = {
    "run": Case("run bar.py -q", ("runs/bar",)),
    "run again": Case("run bar.py -q", ("runs/bar",), _older("runs/bar")),
    "run again without exchange": Case("run bar.py -q", ("runs/bar",), _older("runs/bar"), _without_exchange),
    "run, resume": Case("run bar.py -q --resume", ("runs/bar",), _older("runs/bar")),
    "run, cases, excel": Case("run bar.py -q --cases rows.csv --excel --xlsx", ("runs/bar",)),
    "watch": Case("watch bar.py -i bar.toml -q", ("runs/bar",), _older("runs/bar"), stop_watching),
    "diagnose": Case("diagnose bar.py --data measured.csv -q", ("runs/measured",), _older("runs/measured")),
    "init": Case("init bar.py -q -o deep/made.toml", ("deep/made.toml", "deep/bar.schema.json")),
    "init again": Case("init bar.py -q -o made.toml --force", ("made.toml", "bar.schema.json"),
                       _older("made.toml", "bar.schema.json")),
    "init again without exchange": Case("init bar.py -q -o made.toml --force", ("made.toml", "bar.schema.json"),
                                        _older("made.toml", "bar.schema.json"), _without_exchange),
    "init, workbook": Case("init bar.py -q -o made.xlsx", ("made.xlsx",)),
    "table": Case("table bar.py -q -i bar.toml --rows rows.csv -o out.csv", ("out.csv",), _older("out.csv")),
    "index": Case("index older -q -o out.html", ("out.html",), _older("out.html")),
    "new": Case("new mine -q", ("mine",)),
    "new here": Case("new mine -q -o empty", ("empty",), lambda place: (place / "empty").mkdir(), is_filled=True),
    "new, one file": Case("new mine -q --single-file", ("mine.py",)),
    "completion": Case("completion bash --install -q", ("share", ".bashrc"), _older(".bashrc")),
    "describe": Case("describe bar.py"),
    "explain": Case("explain bar.py stress"),
    "verify": Case("verify bar.py"),
    "compare": Case("compare older/runs/bar older/runs/bar"),
    "plugins": Case("plugins --names"),
}  # fmt: skip

Files = dict[str, bytes]


def files_of(place: Path, names: tuple[str, ...]) -> Files:
    """Return all that lies under these names, leftovers excepted; what may differ between equal runs is left out."""
    found: Files = {}
    for name in names:
        root = place / name
        for path in [root] if root.is_file() else sorted(root.rglob("*")):
            inside = path.relative_to(place).as_posix()
            if path.is_file() and not any(part.endswith(HIDDEN) for part in path.relative_to(place).parts):
                found[inside] = b"" if path.name == "run.json" and _is_json(path) else _content(path, place)
    return found


def _content(path: Path, place: Path) -> bytes:
    return path.read_bytes().replace(os.fsencode(place), b"PLACE")


def _is_json(path: Path) -> bool:
    try:
        json.loads(path.read_bytes())
    except ValueError:
        return False
    return True


def is_whole(found: Files, after: Files) -> bool:
    """Tell whether all new files are there to their last byte; what could not be read may be told otherwise in them."""
    return found.keys() == after.keys() and all(found[name][-16:] == after[name][-16:] for name in after)


def leftovers(place: Path) -> list[str]:
    return sorted(
        path.relative_to(place).as_posix()
        for path in place.rglob("*")
        if path.name.endswith((*HIDDEN, ".partial", ".new"))
    )


@dataclass
class Prepared:
    """A folder that verbs can work in, and what each case does there when nothing fails."""

    template: Path
    scratch: Path
    known: dict[str, tuple[Files, Files, list[str]]] = field(default_factory=dict)
    made: int = 0

    def place(self, case: Case) -> Path:
        """Make a fresh folder for one try."""
        self.made += 1
        place = self.scratch / str(self.made)
        place.mkdir()
        for path in self.template.iterdir():
            (place / path.name).symlink_to(path) if path.name != "older" else shutil.copytree(path, place / "older")
        case.before(place)
        return place

    def of(self, name: str) -> tuple[Files, Files, list[str]]:
        """Return what lies there before and after, and the operations between."""
        if name not in self.known:
            case = CASES[name]
            place = self.place(case)
            before = files_of(place, case.results)
            log = place.parent / f"{place.name}.log"
            end = self.run(case, place, lambda: _count(log))
            assert end.code == 0, end
            after = files_of(place, case.results)
            assert after != before or not case.results
            assert leftovers(place) == []
            self.known[name] = before, after, log.read_text().splitlines()
        return self.known[name]

    @staticmethod
    def run(case: Case, place: Path, inject: Callable[[], object] = lambda: None) -> End:
        def before() -> None:
            os.environ.update(HOME=str(place), XDG_DATA_HOME=str(place / "share"), TMPDIR=str(place))
            case.patched()
            inject()

        return forked(case.words.split(), place, before=before)


def _count(log: Path) -> None:
    handle = os.open(log, os.O_WRONLY | os.O_CREAT)

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        if event in OPERATIONS:
            os.write(handle, f"{event} {arguments[:2]!r}".replace("\n", " ").encode("utf-8", "replace") + b"\n")

    sys.addaudithook(hook)


def _inject(fault: str, place: int) -> Callable[[], None]:
    """Return what lets the operation at a place fail."""
    left = place

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal left
        if event not in OPERATIONS:
            return
        left -= 1
        if left != -1:
            return
        if fault == "death":
            os._exit(DIED)
        if fault == "Ctrl-C":
            raise KeyboardInterrupt
        code = getattr(errno, fault)
        name = arguments[0] if arguments and isinstance(arguments[0], str | bytes) else None
        raise OSError(code, os.strerror(code), name)

    return lambda: sys.addaudithook(hook)


def _small_disk(size: int) -> Callable[[], None]:
    """Return what lets no file grow beyond a size: a write stops in its middle."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Prepared]:
    """A folder with what the verbs read and older results; by the way all that they need is imported."""
    template = filled(
        tmp_path_factory.mktemp("template"),
        "run bar.py -o older/runs/bar --set load=9kN",
        "run bar.py -o warm --resume --cases rows.csv --excel",
        "diagnose bar.py --data measured.csv -o older/runs/measured --set area=101mm^2",
        "init bar.py -o warm.toml",
        "table bar.py -i bar.toml --rows rows.csv -o warm.csv",
        "index older -o warm.html",
        "new mine -o warm.d",
        "new mine --single-file -o warm.py",
        "completion bash",
        "describe bar.py",
        "explain bar.py stress",
        "verify bar.py",
        "compare older/runs/bar older/runs/bar",
        "plugins --names",
    )
    for path in (*template.glob("warm*"), template / "__pycache__", template / "bar.schema.json"):
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
    older = template / "older"
    for name in ("made.toml", "bar.schema.json", "out.csv"):
        (older / name).write_text("older")
    (older / "out.html").write_text('<meta name="generator" content="calc index">older')
    (older / ".bashrc").write_text("older\n")
    scratch = tmp_path_factory.mktemp("scratch")
    yield Prepared(template, scratch)
    shutil.rmtree(scratch)


def judge(prepared: Prepared, name: str, inject: Callable[[], None], what: str) -> None:
    """Let one operation fail, and look at what is there, what was said, and what the next run does."""
    case = CASES[name]
    before, after, _ = prepared.of(name)
    place = prepared.place(case)
    end = prepared.run(case, place, inject)
    found = files_of(place, case.results)
    told = f"{name}, {what}: {end}"
    died = end.code == DIED
    if died and case.patched is _without_exchange and not found:  # between the two renames: the old one has no name
        _recover(place, case)
        found = files_of(place, case.results)
    is_new = found != before and is_whole(found, after)
    if died and len(case.results) > 1:  # several files: a death leaves some of them new, each whole
        assert found.items() <= before.items() | after.items(), told
        assert found.keys() >= before.keys(), told
    else:
        assert found == before or is_new or (died and case.is_filled and found.items() <= after.items()), told
    if not died:
        _judge_words(end, case, is_new=is_new and bool(case.results), told=told)
    assert bool(leftovers(place)) or "are kept in" not in end.err, told
    if died or leftovers(place):
        assert died or is_new or "--resume" in case.words, (told, leftovers(place))
        exists_already = is_new if name == "init" else "new" in name and found != before
        if not (case.is_filled and found) and not exists_already:
            again = prepared.run(case, place)
            assert again.code == 0, (told, again)
            assert files_of(place, case.results) == after, told
            if name != "completion":  # the line stands in .bashrc already, which is not written again
                assert leftovers(place) == [], told
    shutil.rmtree(place)


def _recover(place: Path, case: Case) -> None:
    for name in case.results:
        recover(place / name)


def _judge_words(end: End, case: Case, *, is_new: bool, told: str) -> None:
    """One sentence, which is true; 0 only where the new is there.

    A watch that has begun goes on until it is ended, then with 1.
    """
    assert "Traceback" not in end.err, told
    if end.code == 0:
        assert is_new or not case.results, told
        return
    if case.words.startswith("watch"):
        assert end.code in {1, 2, 3, 130}, told
        assert end.err.count("\n") <= 1, told
        assert end.err or end.code != 3, told
        assert end.code != 130 or ("complete" in end.err) == is_new, told
        return
    assert end.err.count("\n") == 1, told
    assert end.err.strip(), told
    if end.code == 130:
        assert ("nothing was written" in end.err) or ("are kept in" in end.err) or is_new, told
        assert ("complete" in end.err) == is_new or "are kept in" in end.err, told
    assert end.code in {2, 3, 130}, told


def _own(operations: Sequence[str]) -> list[int]:
    """Return the places of all operations; of those that read what is installed, hundreds, the first of each kind."""
    seen: set[tuple[str, str]] = set()
    own = []
    for place, operation in enumerate(operations):
        event, _, name = operation.partition(" ")
        kind = (event, name.partition(",")[0].rpartition(".")[2])
        if not any(installed in name for installed in INSTALLED):
            own.append(place)
        elif kind not in seen:
            seen.add(kind)
            own.append(place)
    return own


@pytest.mark.parametrize("name", CASES)
def test_every_operation_may_fail(prepared: Prepared, name: str, full_torture: bool) -> None:
    operations = prepared.of(name)[2]
    assert operations
    tries = [(place, fault) for place in _own(operations) for fault in FAULTS]
    if not full_torture:
        tries = random.Random(name).sample(tries, 1)
    for place, fault in tries:
        judge(prepared, name, _inject(fault, place), f"{fault} at {place}: {operations[place]}")


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.results])
def test_a_write_may_stop_in_its_middle(prepared: Prepared, name: str, full_torture: bool) -> None:
    sizes = sorted({0, *(len(content) // 2 for content in prepared.of(name)[1].values())})
    if not full_torture:
        sizes = sizes[-1:] if "again" in name else []
    for size in sizes:
        judge(prepared, name, _small_disk(size), f"no file beyond {size} bytes")
