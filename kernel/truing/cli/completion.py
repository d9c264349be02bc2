"""calc completion: the script by which a shell completes names, and the answer when a shell asks."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

from truing.atomic import write_files
from truing.cli.app import Shell
from truing.cli.console import Settings, out
from truing.errors import UsageError
from truing.templating import template_folder

FILES = {Shell.bash: "calc.bash", Shell.zsh: "calc.zsh", Shell.fish: "calc.fish", Shell.powershell: "calc.ps1"}


def completion(settings: Settings, asked: SimpleNamespace) -> int:
    """Print the script by which your shell completes plugins, inputs and results, or install it."""
    wanted: Shell = asked.shell or _present_shell()
    text = (template_folder() / "completion" / FILES[wanted]).read_text(encoding="utf-8")
    if not asked.install:
        out(text.rstrip("\n"))
        return 0
    for line in _installed(wanted, text):
        settings.say(line)
    return 0


def _present_shell() -> Shell:
    """Return the shell that has called; raises UsageError where that cannot be seen."""
    known = {shell.value: shell for shell in Shell} | {"pwsh": Shell.powershell}
    try:
        name = str(import_module("shellingham").detect_shell()[0])
    except Exception:
        name = Path(os.environ.get("SHELL", "")).name
    if name not in known:
        raise UsageError(f"which shell? name it: calc completion {' | '.join(Shell)}")
    return known[name]


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
    files: dict[Path, str | bytes] = {script: text}
    said = [f"wrote {script}"]
    settings = home / f".{shell}rc"
    added = _with_line(settings, f'source "{script}"') if shell != Shell.fish else None
    if added is not None:
        files[settings] = added
        said.append(f"added a line to {settings}")
    write_files(files)
    return [*said, f"open a new {shell} and try: calc run <Tab>"]


def _with_line(file: Path, line: str) -> bytes | None:
    """Return what a file holds with a line added to it, or None where the line stands there already."""
    present = file.read_bytes() if file.is_file() else b""
    if line.encode() in present.splitlines():
        return None
    gap = b"" if not present or present.endswith(b"\n") else b"\n"
    return present + gap + line.encode() + b"\n"
