"""A change of an inputs file as text: one value stated, replaced or taken out; comments and order stay (tomlkit)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from truing.errors import UsageError
from truing.heavy import Later

tomlkit: Any = Later("tomlkit")


def changed_text(text: str, path: Sequence[str], value: Any) -> str:
    """Return the text with the value at a path ("inputs", "load") stated; None takes it out.

    Raises UsageError where the text is no TOML.
    """
    try:
        document = tomlkit.parse(text)
    except Exception as error:  # tomlkit has a family of errors, all of which are ValueErrors of the text
        raise UsageError(f"the file is no TOML as it stands: {error}; mend it in the text first") from None
    *sections, name = path
    table = document
    for section in sections:
        if section not in table:
            if value is None:
                return text
            table[section] = tomlkit.table()
        table = table[section]
    if value is None:
        table.pop(name, None)
    else:
        table[name] = value
    written: str = tomlkit.dumps(document)
    return written
