"""Blocks of a page that are no commands: Python is executed, inputs files, tables and JSON are read by their readers.

- ``python`` without a mark is executed in the page's own namespace, which begins with the words of ``truing``, ``np``,
  ``replace``, ``dataclass``, ``Any``, ``Literal``, ``Mapping``, ``Sequence``, ``Path`` and ``NDArray``. What a fragment
  speaks of and does not show stands in a comment ``<!-- given:`` ... ``-->`` above it: Python, executed in its place.
- ``<!-- inputs: MODEL -->``: this TOML is an inputs file of an installed model, or of a file that the page has.
- ``<!-- cases: MODEL -->``: this CSV is what ``calc run MODEL --cases`` reads.
- ``json`` is one document. ``text`` that begins with ``calc VERB`` is a summary: the verb has the options it names.

Whatever else is no command and no file says why it is not run: ``<!-- not run: WHY -->``.
"""

from __future__ import annotations
import __future__

import json
import re
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import typer.main

from truing.cli.app import app
from truing.errors import TruingError
from truing.inputs_file import read_setup
from truing.kernel import Kernel

if TYPE_CHECKING:
    from shown_in_docs import Block, Desk

GIVEN = re.compile(r"^<!-- given:\n(?P<code>.*?)^-->$", re.MULTILINE | re.DOTALL)
_OPTIONS = re.compile(r"(?<![\w-])--?[a-z][a-z-]*")


def why_not(block: Block) -> str:
    """Return what is missing for a block to be executed or read; nothing where it is."""
    if block.mark.startswith("not run"):
        return "" if block.marked("not run") else "says not run and no reason; write <!-- not run: WHY -->"
    known = (
        block.kind in {"console", "python", "json"}
        or any(block.marked(word) for word in ("file", "excel", "changes"))
        or (block.kind == "toml" and block.marked("inputs"))
        or (block.kind == "csv" and block.marked("cases"))
        or (block.kind == "text" and block.text.startswith("calc "))
    )
    return "" if known else f"is {block.kind or 'without a language'} that nothing reads; see read_in_docs.py for marks"


def read(block: Block, page: Path, desk: Desk) -> None:
    """Execute or read a block; raises AssertionError where it is not what it seems."""
    if block.kind == "python":
        _execute(block, page, desk)
    elif block.kind == "toml":
        _read_inputs(block, desk)
    elif block.kind == "csv":
        (desk.folder / "of_the_page.csv").write_text(block.text, encoding="utf-8")
        said, code = desk.run(
            f"calc run {_shown(block.marked('cases'), desk)} --cases of_the_page.csv -q --output runs/page"
        )
        assert code in (0, 1), said
    elif block.kind == "json":
        try:
            json.loads(block.text)
        except ValueError as error:
            raise AssertionError(f"this is no JSON: {error}") from None
    elif block.kind == "text" and block.text.startswith("calc "):
        _demand_options(block.text)


def _execute(block: Block, page: Path, desk: Desk) -> None:
    """Run a block of Python where the page's earlier ones were run; annotations stay words."""
    if not desk.namespace:
        exec(WORDS, desk.namespace)
    try:
        with chdir(desk.folder), _importing_from(desk.folder):
            for code in [*_given_above(block, page), block.text]:
                exec(compile(code, page.name, "exec", __future__.annotations.compiler_flag), desk.namespace)
    except Exception as error:
        raise AssertionError(f"this Python ends with {type(error).__name__}: {error}") from error


WORDS = """
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from truing import *
"""


@contextmanager
def _importing_from(folder: Path) -> Iterator[None]:
    """Let Python find the files of the page, and forget them afterwards."""
    path, known = list(sys.path), set(sys.modules)
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path[:] = path
        for name in set(sys.modules) - known:
            place = str(getattr(sys.modules[name], "__file__", None))
            if place.startswith(str(folder.resolve())) or isinstance(sys.modules[name], SimpleNamespace):
                del sys.modules[name]


def _given_above(block: Block, page: Path) -> Iterator[str]:
    """Give the hidden Python between this block and the one before."""
    text = page.read_text(encoding="utf-8")
    before = text.rfind("\n```\n", 0, block.start)
    yield from (item["code"] for item in GIVEN.finditer(text, max(before, 0), block.start))


def _read_inputs(block: Block, desk: Desk) -> None:
    name = block.marked("inputs")
    file = desk.folder / "of_the_page.toml"
    file.write_text(block.text, encoding="utf-8")
    kernel: Any = Kernel() if name.endswith(".py") else Kernel.installed()
    if name.endswith(".py"):
        kernel.add_file(desk.folder / name)
    try:
        read_setup(file, kernel.offer(Path(name).stem if name.endswith(".py") else name))
    except TruingError as error:
        raise AssertionError(f"this is no inputs file of {name}: {error}") from None


def _shown(name: str, desk: Desk) -> str:
    return f"./{name}" if (desk.folder / name).is_file() else name


def _demand_options(text: str) -> None:
    """Fail unless a summary names a verb and just the options that it has."""
    group: Any = typer.main.get_command(app)
    words = text.split()
    assert words[1] in group.commands, f"there is no verb '{words[1]}'"
    parameters = [item for item in group.commands[words[1]].params if item.param_type_name == "option"]
    known = {spelling for item in parameters for spelling in (*item.opts, *item.secondary_opts)}
    unknown = [option for option in _OPTIONS.findall(text) if option not in known]
    assert not unknown, f"calc {words[1]} has no {', '.join(unknown)}"
