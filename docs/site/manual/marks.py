"""The marks above a block, which say what the tests do with it: a file's name is shown, the others are left out."""

from __future__ import annotations

import re

_MARKED = re.compile(r"^<!-- (?P<word>[\w ]+?)(?:: (?P<value>[^\n]*?))? -->\n```(?P<kind>\w*)$", re.MULTILINE)
_GIVEN = re.compile(r"^<!-- given:\n.*?^-->\n+", re.MULTILINE | re.DOTALL)
_TITLES = {"file": "{}", "excel": "{}", "changes": "changes in {}"}


def with_titles(text: str) -> str:
    """Give blocks that are files their names as titles and take the other marks away."""

    def written(item: re.Match[str]) -> str:
        title = _TITLES.get(item["word"], "").format(item["value"])
        language = item["kind"] or "text"
        return f'```{language} title="{title}"' if title else f"```{language}"

    return _MARKED.sub(written, _GIVEN.sub("", text))
