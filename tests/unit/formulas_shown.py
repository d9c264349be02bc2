"""What formulas show, whatever language they are written in: characters, and which of them stand where.

An element that is not known, or that holds other children than the schema of its language allows, is an error.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from typing import Any, Final

M: Final = "{http://schemas.openxmlformats.org/officeDocument/2006/math}"
W: Final = "{http://schemas.openxmlformats.org/wordprocessingml/2006/main}"
NAMESPACES: Final = f'xmlns:m="{M[1:-1]}" xmlns:w="{W[1:-1]}"'
NOT_SEEN: Final = dict.fromkeys(map(ord, " \u00a0\u2009\u200b\u2061\u2062"))
Shown = list[Any]
"""Texts, and tuples of a kind and what stands in its places; neighbouring texts are one."""


def shown_by_mathml(markup: str) -> Shown:
    """Read MathML."""
    return _joined(_mathml(element) for element in ElementTree.fromstring(f"<r>{markup}</r>"))


def shown_by_omml(markup: str) -> Shown:
    """Read OMML, with children in the order of ECMA-376, part 1, chapter 22.1.2."""
    return _omml_content(ElementTree.fromstring(f"<m:e {NAMESPACES}>{markup}</m:e>"), "e")


def _joined(pieces: Iterable[Shown]) -> Shown:
    joined: Shown = []
    for piece in (piece for pieces_of_one in pieces for piece in pieces_of_one):
        if isinstance(piece, str) and joined and isinstance(joined[-1], str):
            joined[-1] += piece
        elif piece != "":
            joined.append(piece)
    return joined


KINDS: Final = {"mfrac": "over", "msup": "sup", "msub": "sub", "msubsup": "subsup"}


def _mathml(element: ElementTree.Element) -> Shown:
    if element.tag in {"mi", "mn", "mo", "mtext", "mspace"}:
        assert len(element) == 0
        return [(element.text or "").translate(NOT_SEEN)]
    parts = [_joined([_mathml(child)]) for child in element]
    if element.tag in {"mrow", "mtd"}:
        return _joined(parts)
    if element.tag == "msqrt":
        return [("root", [], _joined(parts))]
    if element.tag == "mroot":
        return [("root", parts[1], parts[0])]
    if element.tag in {"mtable", "mtr"}:
        return [(element.tag, *parts)]
    return [(KINDS[element.tag], *parts)]


def _omml_content(element: ElementTree.Element, tag: str) -> Shown:
    assert element.tag == M + tag
    return _joined(map(_omml, element))


OMML_PARTS: Final = {
    "f": ("over", ("num", "den")), "sSup": ("sup", ("e", "sup")), "sSub": ("sub", ("e", "sub")),
    "sSubSup": ("subsup", ("e", "sub", "sup")), "mr": ("mtr", ("e", "e")),
}  # fmt: skip


def _omml(element: ElementTree.Element) -> Shown:
    name, children = element.tag.removeprefix(M), list(element)
    if name == "r":
        *properties, text = children
        assert [each.tag for each in properties] in ([W + "rPr"], [M + "rPr", W + "rPr"])
        assert text.tag == M + "t"
        return [(text.text or "").translate(NOT_SEEN)]
    if name == "d":
        (begin, end), content = children[0], children[1]
        assert (children[0].tag, begin.tag, end.tag) == (M + "dPr", M + "begChr", M + "endChr")
        return _joined([[begin.get(M + "val")], _omml_content(content, "e"), [end.get(M + "val")]])
    if name == "rad":
        degree, content = children[-2:]
        hides = [each.get(M + "val") for each in element.findall(f"{M}radPr/{M}degHide")]
        assert hides == ([] if len(degree) else ["1"])
        return [("root", _omml_content(degree, "deg"), _omml_content(content, "e"))]
    if name == "func":
        head, content = children
        return _joined([_omml_content(head, "fName"), _omml_content(content, "e")])
    if name == "m":
        assert children[0].tag == M + "mPr"
        return [("mtable", *(_omml(row) for row in children[1:]))]
    kind, places = OMML_PARTS[name]
    return [(kind, *(_omml_content(child, place) for child, place in zip(children, places, strict=True)))]
