"""calc completion: the script by which a shell completes names, and the answer when a shell asks."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import redirect_stderr, suppress
from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from truing.cli.console import out, settings_of, verb
from truing.errors import OutputError, UsageError

ASKED = "_CALC_COMPLETE"
"""The environment variable by which a shell asks."""
LINE = "_TYPER_COMPLETE_ARGS"
_FLAGS = re.compile(r"(?<=\s)(?:-q|-v|--quiet|--verbose|--traceback)(?=\s)")


class Shell(StrEnum):
    """A shell that can complete."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"
    powershell = "powershell"


FILES = {Shell.bash: "calc.bash", Shell.zsh: "calc.zsh", Shell.fish: "calc.fish", Shell.powershell: "calc.ps1"}


@verb
def completion(
    context: typer.Context,
    shell: Annotated[Shell | None, typer.Argument(help="The shell (default: the one you are in).")] = None,
    install: Annotated[bool, typer.Option("--install", help="Put the script where your shell finds it.")] = False,
) -> int:
    """Print the script by which your shell completes plugins, inputs and results, or install it."""
    from truing.report.templates import template_folder

    wanted = shell or _present_shell()
    text = (template_folder() / "completion" / FILES[wanted]).read_text(encoding="utf-8")
    if not install:
        out(text.rstrip("\n"))
        return 0
    for line in _installed(wanted, text):
        settings_of(context).say(line)
    return 0


def _present_shell() -> Shell:
    """Return the shell that has called; raises UsageError where that cannot be seen."""
    known = {shell.value: shell for shell in Shell} | {"pwsh": Shell.powershell}
    try:
        found = str(import_module("shellingham").detect_shell()[0])
    except Exception:
        found = Path(os.environ.get("SHELL", "")).name
    if found not in known:
        raise UsageError(f"which shell? name it: calc completion {' | '.join(Shell)}")
    return known[found]


def _installed(shell: Shell, text: str) -> list[str]:
    """Write the script and, where the shell does not look there, the line that reads it; say what was done."""
    home = Path.home()
    if shell == Shell.powershell:
        line = "calc completion powershell | Out-String | Invoke-Expression"
        raise UsageError(f"put this line into the file that $PROFILE names: {line}")
    if shell == Shell.fish:
        script = Path(os.environ.get("XDG_CONFIG_HOME") or home / ".config") / "fish" / "completions" / "calc.fish"
    else:
        script = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share") / "truing" / FILES[shell]
    try:
        script.parent.mkdir(parents=True, exist_ok=True)
        script.write_text(text, encoding="utf-8", newline="\n")
        said = [f"wrote {script}"]
        if shell != Shell.fish and _added(home / f".{shell}rc", f'source "{script}"'):
            said.append(f"added a line to {home / f'.{shell}rc'}")
    except OSError as error:
        raise OutputError(f"{script} cannot be written: {error.strerror or error}") from None
    return [*said, f"open a new {shell} and try: calc run <Tab>"]


def _added(file: Path, line: str) -> bool:
    """Add a line to a file unless it stands there; say whether it was added."""
    present = file.read_text(encoding="utf-8", errors="surrogateescape") if file.is_file() else ""
    if line in present.splitlines():
        return False
    gap = "" if not present or present.endswith("\n") else "\n"
    with file.open("a", encoding="utf-8", errors="surrogateescape", newline="\n") as stream:
        stream.write(f"{gap}{line}\n")
    return True


def answer_the_shell(app: Callable[..., object]) -> int:
    """Answer a shell that asks, through the protocol of typer; whatever goes wrong, nothing is said."""
    os.environ["COLUMNS"] = os.environ["TERMINAL_WIDTH"] = "1000"  # a help text broken into lines would be names
    line = os.environ.get(LINE)
    if line is not None:
        os.environ[LINE] = _FLAGS.sub("", line)
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stderr(nowhere), suppress(SystemExit, Exception):
        import_module("typer.completion").completion_init()
        app(args=[], prog_name="calc")
    return 0
