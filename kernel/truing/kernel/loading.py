"""Loading one plugin: a file without packaging, what must be true of any plugin's hooks, the hash of its source."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import re
import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from pluggy import PluginManager

from truing.declare.near_miss import near_miss
from truing.errors import DeclarationError, UnknownPluginError
from truing.kernel.blame import line_of

PREFIX = "truing_file_"
"""Before the name of a module whose plain name another module has."""


def load_file(path: Path) -> ModuleType:
    """Import one Python file by its path, under its own name unless that is taken by another module.

    Raises UnknownPluginError for what is no Python file; whatever the file itself raises goes through.
    """
    if not path.is_file():
        raise UnknownPluginError(f"{path}: no such file")
    path = path.resolve()
    taken = sys.modules.get(path.stem)
    if taken is not None and getattr(taken, "__file__", None) == str(path):
        return taken
    plain = re.sub(r"\W", "_", path.stem)
    is_free = plain == path.stem and taken is None and importlib.util.find_spec(plain) is None
    name = plain if is_free else PREFIX + plain
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise UnknownPluginError(f"{path}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    if str(path.parent) not in sys.path:
        sys.path.append(str(path.parent))
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def check_hooks(manager: PluginManager, plugin: Any, name: str) -> None:
    """Refuse a plugin with a misspelt hook, one without its mark, one with foreign arguments, or with none at all.

    Raises DeclarationError, which knows file and line.
    """
    hooks = {key: caller.spec for key, caller in vars(manager.hook).items() if getattr(caller, "spec", None)}
    marked = [key for key in dir(plugin) if manager.parse_hookimpl_opts(plugin, key) is not None]
    for key in marked:
        function = getattr(plugin, key)
        if key not in hooks:
            raise DeclarationError(f"'{key}' is no hook.{near_miss(key, hooks)}", line_of(function))
        known = tuple(hooks[key].argnames)
        strange = [argument for argument in inspect.signature(function).parameters if argument not in known]
        if strange:
            takes = ", ".join(known) or "nothing"
            raise DeclarationError(f"{key}() asks for '{strange[0]}'; this hook is given {takes}", line_of(function))
    for key in hooks:
        function = getattr(plugin, key, None)
        if inspect.isfunction(function) and key not in marked:
            raise DeclarationError(f"{key}() is not marked: write @hookimpl above it", line_of(function))
    if not marked:
        source_line = (getattr(plugin, "__file__", None) or name, None)
        raise DeclarationError(
            "it offers nothing: it needs a function such as truing_models() marked with @hookimpl", source_line
        )


# The source of a plugin as a hash: whether two processes, or two runs, compute with the same code


def code_hash(source: str) -> str:
    """Return the SHA-256 of the source of a package or file, line ends aside; empty where there is none."""
    files = sorted(_files_of(source))
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + b"\0" + file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return digest.hexdigest()[:16] if files else ""


def _files_of(source: str) -> Iterable[Path]:
    path = Path(source)
    if path.suffix == ".py":
        return [path] if path.is_file() else []
    try:
        spec = find_spec(source)
    except (ImportError, ValueError):
        return []
    if spec is None or not spec.origin:
        return []
    file = Path(spec.origin)
    return file.parent.rglob("*.py") if file.name == "__init__.py" else [file]
