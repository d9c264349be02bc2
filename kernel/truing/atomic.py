"""Files and folders that appear whole or not at all; whatever is interrupted, the old ones or the new are there.

Everything is written beside its place first, under a hidden name that ends in ``.part``. Then the two change places in
one step of the system (Linux, macOS), so that at no moment neither is there. Where the system cannot do that, what was
there is called ``.old`` for the moment between two renames; the next writing to that place brings it back. Leftovers of
processes that are gone are deleted then, too.
"""

from __future__ import annotations

import ctypes
import errno
import hashlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from truing.errors import OutputError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

PART, OLD = ".part", ".old"
LONGEST_NAME = 200
"""Bytes of a name that leave room for what is added to it: 255 is the most that file systems take."""
CANNOT_EXCHANGE = {errno.ENOSYS, errno.EINVAL, errno.EXDEV, errno.ENOTSUP, errno.EPERM}
AT_FDCWD, RENAME_EXCHANGE = -100, 2
RENAME_SWAP = 2


@dataclass(frozen=True)
class Move:
    """What was written beside its place, and the place; ``inode`` is the mark by which it is known in either.

    ``named`` is the file or folder as the user calls it.
    """

    part: Path
    target: Path
    named: Path
    inode: int

    @property
    def is_done(self) -> bool:
        """Whether the new one is in its place: asked of the disk, so that it is true after any interrupt."""
        return _inode(self.target) == self.inode


_moves: list[Move] = []
"""What this process has put in place, or was about to."""


def written(since: int = 0) -> list[Path]:
    """Return the places where something of this process is whole, those put there after the first ``since``."""
    return list(dict.fromkeys(move.named for move in _moves[since:] if move.is_done))


def writings() -> int:
    """Return how often this process has put something in place, or was about to."""
    return len(_moves)


def write_files(files: Mapping[Path, str | bytes]) -> None:
    """Write files so that each appears whole, and all of them or none; those that are there are replaced.

    A death (no error, no interrupt) in the middle of several leaves the first of them new, each of them whole.
    A link is followed. What is no file (a device, a pipe) is written to as it stands. Raises OutputError.
    """
    path = Path()
    try:
        with ExitStack() as stack:
            moves = []
            for path, content in files.items():
                if path.is_dir():
                    raise IsADirectoryError(errno.EISDIR, "it is a folder", str(path))
                if path.exists() and not path.is_file():
                    path.write_bytes(_bytes(content))
                    continue
                stack.enter_context(_made_parents(path.parent))
                moves.append(stack.enter_context(_file_beside(path, content)))
            _put_in_place(moves)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error


@contextmanager
def file_appearing(path: Path, *, replace: bool = False) -> Iterator[BinaryIO]:
    """Give a stream into a file that appears whole when the block ends, and not at all where it raises.

    Where the system has files without a name (Linux), not even a death in between leaves anything. A file that is there
    is replaced only if asked. Raises OutputError.
    """
    try:
        if not replace and os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "it is there already; choose another name", str(path))
        with _made_parents(path.parent), ExitStack() as stack:
            stream = None if replace else stack.enter_context(_nameless(path))
            if stream is not None:
                yield stream
                stream.flush()
                _name(stream, path)
                return
            move = stack.enter_context(_file_beside(path, b""))
            with move.part.open("wb") as stream:
                yield stream
            if not replace and os.path.lexists(path):
                raise FileExistsError(errno.EEXIST, "it is there already; choose another name", str(path))
            _put_in_place([move])
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error


@contextmanager
def _nameless(path: Path) -> Iterator[BinaryIO | None]:
    """Give a stream into a file that has no name yet, or None where the system has none such."""
    try:
        handle = os.open(path.parent, os.O_TMPFILE | os.O_WRONLY, 0o666)
    except (OSError, AttributeError):
        yield None
        return
    with os.fdopen(handle, "wb") as stream:
        yield stream


def _name(stream: BinaryIO, path: Path) -> None:
    """Give an open file without a name its own, which nothing may have. Raises OSError."""
    folder = os.open("/proc/self/fd", os.O_RDONLY)
    try:
        os.link(str(stream.fileno()), path, src_dir_fd=folder, follow_symlinks=True)
    except FileExistsError:
        raise FileExistsError(errno.EEXIST, "it is there already; choose another name", str(path)) from None
    finally:
        os.close(folder)


def place_folder(folder: Path, files: Mapping[str, str | bytes], what: str) -> None:
    """Write files, by their paths inside, into a folder that appears complete or not at all; ``what`` it will be.

    A folder that is there is replaced whole: ask first. An empty one stays where it is and is filled, so that whoever
    works in it goes on doing so; a death in the middle of that leaves whole files, not all of them. Raises OutputError
    where nothing can be written.
    """
    target = _followed(folder)
    try:
        is_filled = target.is_dir() and not any(target.iterdir())
        with _made_parents(target.parent), _folder_beside(target / target.name if is_filled else target) as part:
            for name, content in files.items():
                (part / name).parent.mkdir(parents=True, exist_ok=True)
                (part / name).write_bytes(_bytes(content))
            inner = sorted(part.iterdir()) if is_filled else [part]
            places = [target / path.name if is_filled else target for path in inner]
            _put_in_place([Move(*pair, folder, _inode(pair[0])) for pair in zip(inner, places, strict=True)])
    except OSError as error:
        raise OutputError(f"{folder}: the {what} cannot be written: {error.strerror or error}") from error


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Let one process at a time in that asks for this folder; where folders cannot be locked, all of them."""
    handle = os.open(folder, os.O_RDONLY) if fcntl is not None else -1
    try:
        if fcntl is not None:
            with suppress(OSError):  # some network drives cannot
                fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        if handle >= 0:
            os.close(handle)


def recover(folder: Path) -> None:
    """Bring back what a death between two renames has left without its name; delete what other deaths have left."""
    target = _followed(folder)
    left = list(_leftovers(target))
    if not os.path.lexists(target):
        for path in left:
            if path.suffix == OLD:
                path.rename(target)
                break
    for path in left:
        with suppress(OSError), _held_alone(path):
            _delete(path)


def _bytes(content: str | bytes) -> bytes:
    return content.encode("utf-8") if isinstance(content, str) else content


def _followed(path: Path) -> Path:
    return path.resolve() if path.is_symlink() else path.absolute()


def _inode(path: Path) -> int:
    try:
        return path.lstat().st_ino
    except OSError:
        return -1


@contextmanager
def _made_parents(parent: Path) -> Iterator[None]:
    """Make the folders above; those that were made go again if the writing does not get there."""
    missing = [folder for folder in (parent, *parent.parents) if not folder.exists()]
    for folder in (parent, *parent.parents):
        if folder.exists() and not folder.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, f"{folder} is a file and no folder", str(folder))
    try:
        parent.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for folder in missing:
            with suppress(OSError):
                folder.rmdir()
        raise


@contextmanager
def _file_beside(path: Path, content: str | bytes) -> Iterator[Move]:
    """Write a file beside its place; what is left there afterwards is deleted."""
    target = _followed(path)
    mode = target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~umask()
    recover(target)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=_prefix(target), suffix=PART)
    part = Path(name)
    with _deleted(part, target), os.fdopen(handle, "wb") as stream, _held(part):
        stream.write(_bytes(content))
        stream.close()
        part.chmod(mode)
        yield Move(part, target, path, _inode(part))


@contextmanager
def _folder_beside(target: Path) -> Iterator[Path]:
    """Give a folder beside its place; what is left there afterwards is deleted."""
    recover(target)
    part = Path(tempfile.mkdtemp(dir=target.parent, prefix=_prefix(target), suffix=PART))
    with _deleted(part, target), _held(part):
        part.chmod(0o777 & ~umask())
        yield part


@contextmanager
def _deleted(part: Path, target: Path) -> Iterator[None]:
    """Delete what is left beside a place: what was not finished, or what was there before."""
    try:
        yield
    finally:
        with suppress(OSError):
            _delete(part)
            if os.path.lexists(target):  # else what was there could not even be brought back: the next writing tries
                _delete(_aside(part))


def _delete(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def umask() -> int:
    """Return what this process takes from the permissions of new files; temporary ones are made without them."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


# Moves


def _put_in_place(moves: Sequence[Move]) -> None:
    """Put everything in its place, or nothing; what was there lies under the names of the parts afterwards."""
    _moves.extend(moves)
    try:
        for move in moves:
            _swap(move.part, move.target)
    except BaseException:
        for move in reversed(moves):
            if move.is_done:
                _take_back(move)
        raise


def _take_back(move: Move) -> None:
    aside = _aside(move.part)
    if os.path.lexists(aside) and not os.path.lexists(move.part):
        aside.rename(move.part)
    _swap(move.target, move.part)


def _swap(part: Path, target: Path) -> None:
    """Give ``part`` the name ``target``; what had that name gets the other."""
    if not os.path.lexists(target):
        part.rename(target)
    elif not _exchanged(part, target):
        _exchanged_slowly(part, target)


def _exchanged(one: Path, other: Path) -> bool:
    """Let two files or folders change names in one step; tell whether the system can. Raises OSError."""
    call = _exchange()
    if call is None:
        return False
    sys.audit("os.rename", os.fspath(one), os.fspath(other), -1, -1)
    if call(os.fsencode(one), os.fsencode(other)) == 0:
        return True
    code = ctypes.get_errno()
    if code in CANNOT_EXCHANGE:
        return False
    raise OSError(code, os.strerror(code), os.fspath(one), None, os.fspath(other))


def _exchange() -> Callable[[bytes, bytes], int] | None:
    """Return the system's call that exchanges two names: ``renameat2`` of Linux, ``renamex_np`` of macOS."""
    if os.name != "posix":
        return None
    library: Any = ctypes.CDLL(None, use_errno=True)
    if hasattr(library, "renameat2"):
        return lambda one, other: int(library.renameat2(AT_FDCWD, one, AT_FDCWD, other, RENAME_EXCHANGE))
    if hasattr(library, "renamex_np"):
        return lambda one, other: int(library.renamex_np(one, other, RENAME_SWAP))
    return None


def _exchanged_slowly(part: Path, target: Path) -> None:
    """Do the same in steps: a file is there all the time; a folder is called ``.old`` for a moment."""
    aside = _aside(part)
    try:
        if target.is_dir():
            target.rename(aside)
        else:
            shutil.copy2(target, aside)
        part.replace(target)
    except BaseException:
        if not os.path.lexists(target):
            aside.rename(target)
        raise
    aside.rename(part)


def _aside(part: Path) -> Path:
    return part.with_name(part.name.removesuffix(PART) + OLD)


# Leftovers


def _prefix(target: Path) -> str:
    """Return how the hidden names beside a place begin: with its own, or for a long one with what stands for it."""
    name = target.name
    if len(os.fsencode(name)) > LONGEST_NAME:
        name = hashlib.sha256(os.fsencode(name)).hexdigest()
    return f".{name}."


def _leftovers(target: Path) -> Iterator[Path]:
    """Yield what lies beside a place under the names that are given here."""
    pattern = re.compile(re.escape(_prefix(target)) + "[a-z0-9_]{8}(" + re.escape(PART) + "|" + re.escape(OLD) + ")")
    if target.parent.is_dir():
        yield from sorted(path for path in target.parent.iterdir() if pattern.fullmatch(path.name))


@contextmanager
def _held(path: Path) -> Iterator[None]:
    """Mark what is being written as in use; the system lets go of it however this ends."""
    with ExitStack() as stack:
        with suppress(OSError):  # some network drives cannot
            stack.enter_context(_held_alone(path))
        yield


@contextmanager
def _held_alone(path: Path) -> Iterator[None]:
    """Take hold of a file or folder. Raises OSError where another process holds it, or where that cannot be told."""
    if fcntl is None:
        raise OSError(errno.ENOTSUP, "cannot be locked")
    handle = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(handle)
