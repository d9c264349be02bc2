"""Formulas of a page become MathML when the site is built: no script, no font, nothing to wait for."""

from __future__ import annotations

import html
import logging
import re
from functools import lru_cache

from latex2mathml.converter import convert

_FORMULA = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\(?P<open>[\[(])(?P<latex>.*?)\\[\])]</(?P=tag)>', re.DOTALL
)
_TAG = re.compile(r"\\tag\{([^}]*)\}")
_BRACE = re.compile(r"(?<=>)\\([{}])(?=</mo>)")
"""A sized brace, of which latex2mathml leaves the backslash."""
_SPACE = '<mspace width="0.1667em"/>'
_FUNCTION = "<mi>(?:arc)?(?:sin|cos|tan|cot)</mi>|<mi>(?:ln|log|exp)</mi>"
_BEFORE = re.compile(rf"(</(?:mi|mn|msub|msup|msubsup|mfrac)>)(?=(?:<msup>)?(?:{_FUNCTION}))")
_AFTER = re.compile(rf"(?<!<msup>)(?<!<msub>)(?<!<mover>)({_FUNCTION})(?=<m(?:i|n|sub|sup|subsup|frac|over)>)")
"""A thin space around the name of a function, which latex2mathml leaves out: z cos α."""
_WORD = re.compile(r"<mi>(?=[^<&]{2})")
"""A name of several letters, which the style sheet must not slant."""
_UNREAD = re.compile(r"\\|>&<")
_log = logging.getLogger("mkdocs.manual")


def with_mathml(text: str, page: str) -> str:
    """Set every formula of a page's HTML; a warning, which a strict build does not forgive, where one cannot be."""

    def written(item: re.Match[str]) -> str:
        latex = html.unescape(item["latex"]).strip()
        display = item["open"] == "["
        try:
            made = mathml(latex, display)
        except Exception as error:
            _log.warning("%s: the formula %s cannot be set: %r", page, latex, error)
            return html.escape(latex)
        if _UNREAD.search(re.sub(r'alttext="[^"]*"', "", made)):
            _log.warning("%s: the formula %s has a word that is not known", page, latex)
        return f'<div class="formula" tabindex="0">{made}</div>' if display else made

    return _FORMULA.sub(written, text)


@lru_cache(maxsize=4096)
def mathml(latex: str, display: bool) -> str:
    """Return LaTeX as MathML, with the LaTeX as its words for those who cannot see it; a tag stands beside it."""
    bare = _TAG.sub("", latex)
    readable = bare.replace("{aligned}", "{align*}")  # the one of the two that latex2mathml knows
    made: str = _BRACE.sub(r"\1", convert(readable, display="block" if display else "inline"))
    made = _AFTER.sub(r"\1" + _SPACE, _BEFORE.sub(r"\1" + _SPACE, made))
    made = _WORD.sub('<mi mathvariant="normal">', made)
    tag = "".join(f'<span class="tag">({number})</span>' for number in _TAG.findall(latex))
    return made.replace("<math ", f'<math alttext="{html.escape(bare.strip())}" ', 1) + tag
