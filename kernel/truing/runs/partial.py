"""DIR.partial: the finished batches of a run that is not complete, and of which run they are."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from truing.declare.chain import chain_of
from truing.errors import OutputError
from truing.executors.kept import BatchLog
from truing.kernel.loading import code_hash
from truing.runs.folder import json_text
from truing.runs.provenance import provenance_of
from truing.setup import Setup

if os.name == "nt":
    import msvcrt
else:
    import fcntl

PARTIAL_SCHEMA = "truing.partial/3"
HEADER, FRESH, BATCHES, LOCK = OURS = ("partial.json", "partial.json.new", "batches.log", "lock")


def partial_folder(folder: Path) -> Path:
    """Return where the finished batches of a run at ``folder`` are kept."""
    plain = folder.name not in {"", ".."} and not folder.is_symlink()
    target = folder if plain else folder.resolve()
    return target.with_name(f"{target.name}.partial")


def is_partial(folder: Path) -> bool:
    """Tell whether a folder holds finished batches of ours."""
    return (folder / HEADER).is_file()


def code_of(setup: Setup) -> tuple[str, ...]:
    """Name the packages and files whose code decides the results: ours, the plugin's, and those of its guests.

    A single file stands with the modules that were imported from its folder, all of them by path.
    """
    file = Path(setup.origin.file).resolve()
    chain = chain_of(setup.model)
    sources = () if chain is None else tuple(source.function for source in chain.sources.values())
    effects = (effect.function for effect in setup.model.known_effects.values())
    functions = [setup.model.function, *sources, *effects]
    packages = {function.__module__.partition(".")[0] for function in functions}
    if not setup.origin.ref.startswith("file:"):
        own = file.parent.name if file.name == "__init__.py" else file.stem
        return tuple(sorted({"truing", own, *packages}))
    beside = {path for module in list(sys.modules.values()) if (path := _file(module)).parent == file.parent}
    others = {name for name in packages if name in sys.modules and _file(sys.modules[name]) not in beside}
    return tuple(sorted({"truing", str(file), *others, *map(str, beside)}))


def _file(module: Any) -> Path:
    name = getattr(module, "__file__", None)
    return Path(name).resolve() if isinstance(name, str) else Path()


def identity_of(setup: Setup, code: tuple[str, ...]) -> dict[str, Any]:
    """Say what a batch may depend on, the most telling first: versions, and the source of these packages or files."""
    origin = provenance_of(setup)
    versions = {
        "truing": origin.kernel,
        "python": origin.python,
        **origin.packages,
        **{name: version for _, name, version in origin.added},
        origin.plugin: origin.plugin_version,
    }
    return {
        "schema": PARTIAL_SCHEMA,
        "plugin": origin.plugin,
        "calculation": setup.model.name,
        "seed": origin.seed,
        "inputs": origin.input_hash,
        **{f"version of {name}": version for name, version in versions.items()},
        **{f"code of {Path(source).name}": code_hash(source) for source in code},
    }


@contextmanager
def kept_batches(folder: Path, identity: Mapping[str, Any]) -> Iterator[BatchLog]:
    """Give the log of finished batches beside a run folder.

    It is removed when the block is complete, and stays where the block ends early, unless it is empty. Raises
    OutputError where the batches there are of other inputs, seed, versions or code, where another run uses them, or
    where nothing can be written.
    """
    batch_folder = partial_folder(folder)
    missing = [parent for parent in (batch_folder.parent, *batch_folder.parent.parents) if not parent.exists()]
    try:
        lock, log = _opened(batch_folder, identity)
    except OSError as error:
        raise OutputError(f"{batch_folder}: cannot keep finished batches: {error.strerror or error}") from error
    complete = False
    try:
        yield log
        complete = True
    finally:
        log.close()
        lock.close()
        if complete or not len(log):
            shutil.rmtree(batch_folder, ignore_errors=True)
            for parent in missing:
                with suppress(OSError):
                    parent.rmdir()


def _opened(batch_folder: Path, identity: Mapping[str, Any]) -> tuple[IO[bytes], BatchLog]:
    """Take hold of the folder for this process alone; the system lets go of it however the process ends."""
    batch_folder.mkdir(parents=True, exist_ok=True)
    strange = sorted(path.name for path in batch_folder.iterdir() if path.name not in OURS)
    if strange:
        raise OutputError(f"{batch_folder}: holds '{strange[0]}', so it is none of ours; name another --output")
    with ExitStack() as closing:
        lock = closing.enter_context(open(batch_folder / LOCK, "a+b"))
        try:
            if os.name == "nt":
                lock.seek(0)
                msvcrt.locking(lock.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
            else:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise OutputError(
                f"{batch_folder}: is in use by another run; wait for it, or name another --output"
            ) from None
        _demand_same(batch_folder, identity)
        log = BatchLog(batch_folder / BATCHES)
        closing.pop_all()
    return lock, log


def _demand_same(batch_folder: Path, identity: Mapping[str, Any]) -> None:
    """Refuse batches of another run; write whose they are where there are none yet."""
    header = batch_folder / HEADER
    if not header.exists():
        (batch_folder / BATCHES).unlink(missing_ok=True)
        fresh = batch_folder / FRESH
        fresh.write_text(json_text(dict(identity)), encoding="utf-8")
        os.replace(fresh, header)
        return
    try:
        stated = json.loads(header.read_text(encoding="utf-8"))
    except ValueError:
        stated = None
    if not isinstance(stated, dict) or stated.get("schema") != PARTIAL_SCHEMA:
        raise OutputError(f"{header}: says not whose batches these are; remove the folder")
    if stated != identity:
        raise OutputError(
            f"{batch_folder}: holds finished batches of a run with {_difference(stated, identity)}; "
            "run that one again, or remove the folder"
        )


def _difference(stated: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    """Say what differs first; of what is known by its hash alone nothing more."""
    name = next(name for name in {**wanted, **stated} if stated.get(name) != wanted.get(name))
    if name == "inputs" or name.startswith("code of "):
        return f"other {name}"
    return f"another {name} ({stated.get(name, 'none')}, now {wanted.get(name, 'none')})"
