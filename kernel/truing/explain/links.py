"""Which result is made from what, as the declared formulas say, and which results follow from a name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from truing.declare.checks import formula_scope
from truing.declare.fields import Found
from truing.declare.model import Model
from truing.formulas import parse
from truing.formulas.tree import Name, walk


def made_from(model: Model[Any, Any]) -> Mapping[str, tuple[str, ...]]:
    """Return, for every result with a formula, the inputs and results that it names, in the order of its text."""
    found: dict[str, tuple[str, ...]] = {}
    for name, item in model.result_fields.items():
        if not isinstance(item.spec, Found) or not item.spec.formula:
            continue
        formula = parse(item.spec.formula)
        scope = formula_scope(model, item)
        sides = [side for side in (formula.left, formula.right) if side is not None]
        written = [node.name for side in sides for node in walk(side) if isinstance(node, Name)]
        names = dict.fromkeys(scope[word].name for word in written if word in scope)
        found[name] = tuple(other for other in names if other != name)
    return found


def following(links: Mapping[str, tuple[str, ...]], name: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the results whose formulas name this one, and those that follow further down."""
    direct = tuple(result for result, sources in links.items() if name in sources)
    further: dict[str, None] = {}
    front = list(direct)
    while front:
        last = front.pop(0)
        for result, sources in links.items():
            if last in sources and result not in direct and result not in further and result != name:
                further[result] = None
                front.append(result)
    return direct, tuple(further)


def chain(links: Mapping[str, tuple[str, ...]], name: str) -> Iterator[tuple[int, str, bool]]:
    """Yield what a result is made from, depth first down to the inputs: depth, name, whether it stood above already."""
    seen: set[str] = set()

    def below(result: str, depth: int) -> Iterator[tuple[int, str, bool]]:
        for source in links.get(result, ()):
            again = source in seen and source in links
            seen.add(source)
            yield depth, source, again
            if not again:
                yield from below(source, depth + 1)

    yield from below(name, 1)
