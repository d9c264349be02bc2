"""What is refused before a file is read: the wrong kind of file, the wrong size, no text at all."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import file_digest
from pathlib import Path

from truing.declare.near_miss import near_miss
from truing.errors import Fault, InputError
from truing.recordings import not_of_its_kind
from truing.units.grammar import shown
from truing.workbooks.reading import BookSheet, file_of, opened_sheet

LARGEST_INPUTS = 2_000_000
_SPREADSHEETS = {".xlsx", ".xls", ".xlsm", ".xlsb", ".ods", ".numbers"}
_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_UTF16 = (b"\xff\xfe", b"\xfe\xff")


@contextmanager
def opened_book(path: Path, *, largest: int, preferred: str = "", stored: bool = True) -> Iterator[BookSheet]:
    """Open a sheet of a workbook, formulas by their stored values or as typed; or raise InputError."""
    file = file_of(path)
    sentence = _refusal(file, largest, "save the workbook anew", _refusal_of_book)
    if sentence:
        raise InputError([Fault(sentence, str(file))])
    with opened_sheet(path, preferred=preferred, stored=stored) as sheet:
        yield sheet


def _refusal_of_book(path: Path, start: bytes, instead: str) -> str:
    if start.startswith(_OLE):
        return "is protected by a password, or a workbook of the old kind; save it as .xlsx without a password"
    if not start.startswith(_ZIP):
        return f"is {'no workbook' if start else 'empty'}; {instead} as .xlsx"
    return ""


def refuse_recording(path: Path, *, largest: int) -> None:
    """Raise InputError with one sentence unless ``path`` is a file of acceptable size that begins as its name says."""
    sentence = _refusal(path, largest, "", lambda file, start, _: not_of_its_kind(file, start))
    if sentence:
        raise InputError([Fault(sentence, str(path))])


def refuse_file(path: Path, *, largest: int, instead: str, is_table: bool) -> None:
    """Raise InputError with one sentence unless ``path`` is a text file of acceptable size.

    Only the first bytes are read. ``instead`` says what to do where the file is empty.
    """
    sentence = _refusal(path, largest, instead, _refusal_of_table if is_table else _refusal_of_inputs)
    if sentence:
        raise InputError([Fault(sentence, str(path), _first_line(path))])


def _first_line(path: Path) -> int | None:
    """Return the line that a fault of a whole file stands in: the first, if there is a file."""
    try:
        return 1 if path.is_file() else None
    except (OSError, ValueError):
        return None


def _refusal(path: Path, largest: int, instead: str, judged: Callable[[Path, bytes, str], str]) -> str:
    try:
        if path.is_dir():
            return "is a folder; name a file"
        if not path.exists():
            return _broken_link(path) or "no such file" + _nearby(path)
        if not path.is_file():
            return "is no ordinary file but a pipe or a device; save it in a file first"
        size = path.stat().st_size
        if size > largest:
            return f"is too large: {size / 1e6:.1f} MB, at most {largest / 1e6:g} MB are read"
        with path.open("rb") as stream:
            start = stream.read(65536)
    except (OSError, ValueError) as error:
        return f"cannot be read: {getattr(error, 'strerror', None) or error}"
    return judged(path, start, instead)


def _refusal_of_table(path: Path, start: bytes, instead: str) -> str:
    return _refusal_of_text(path, start, instead, is_table=True)


def _refusal_of_inputs(path: Path, start: bytes, instead: str) -> str:
    return _refusal_of_text(path, start, instead, is_table=False)


def _refusal_of_text(path: Path, start: bytes, instead: str, *, is_table: bool) -> str:
    if path.suffix.lower() in _SPREADSHEETS or start.startswith((_ZIP, _OLE)):
        return f"is a spreadsheet; save it as .xlsx{' or CSV UTF-8' if is_table else ', or write inputs as TOML text'}"
    if not start.strip():
        return f"is empty; {instead}"
    if start.startswith(_UTF16):
        return "is text in UTF-16; save it as UTF-8"
    if b"\0" in start:
        return f"is a binary file; {'a table is CSV text in UTF-8' if is_table else 'inputs are a TOML text in UTF-8'}"
    return ""


def _broken_link(path: Path) -> str:
    """Say where a symbolic link leads that leads to no file; nothing where the path is no link."""
    if not path.is_symlink():
        return ""
    try:
        path.stat()
    except OSError as error:
        if error.errno == errno.ELOOP:
            return "is a symbolic link that leads back to itself; name the file"
    return f"is a symbolic link to {shown(str(path.readlink()))}, which is not there"


def _nearby(path: Path) -> str:
    try:
        names = [
            neighbour.name
            for _, neighbour in zip(range(1000), path.parent.iterdir(), strict=False)
            if neighbour != path
        ]
    except OSError:
        return ""
    meant = near_miss(path.name, names)
    return "." + meant if meant else ""


def read_text(path: Path, *, instead: str) -> str:
    """Read a whole inputs file as text; raises InputError with one sentence for what is no such file."""
    refuse_file(path, largest=LARGEST_INPUTS, instead=instead, is_table=False)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError([Fault(f"cannot be read: {error.strerror}", str(path), 1)]) from error
    return text_of(content, path)


def text_of(content: bytes, path: Path) -> str:
    """Return what a text file holds; raises InputError with one sentence where it is no UTF-8."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError([Fault("is not UTF-8 text; save it as UTF-8", str(path), line)]) from None


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file, of a workbook as a whole; nothing where it cannot be read."""
    try:
        with file_of(path).open("rb") as stream:
            return file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""
