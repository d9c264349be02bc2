"""calc verify: the paper's printed numbers beside ours."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from truing.cli.console import Settings, aligned, out, out_json
from truing.cli.load import find_model
from truing.declare.published import rules_of
from truing.numbers import counted, format_number
from truing.published import ComparedRow
from truing.texts import one_line
from truing.units import unit_text

HEAD = ("quantity", "where", "unit", "paper", "ours", "ratio", "verdict", "obtained", "kind", "why")


def verify(settings: Settings, *, plugin: str, as_json: bool) -> int:
    """Print every number that the source prints beside ours; exit 0 if every row matches its stated verdict."""
    model = find_model(plugin, settings)
    rows = model.verify(progress=not settings.quiet)
    if as_json:
        findings = [asdict(finding) for finding in model.offer.model.findings]
        out_json(
            {
                "rows": [_plain(row) for row in rows],
                "rules": rules_of(row.published for row in rows),
                "findings": findings,
            }
        )
    else:
        out("\n".join(_lines(model.offer.model, rows)))
    return 0 if all(row.as_stated for row in rows) else 1


def _plain(row: ComparedRow) -> dict[str, Any]:
    printed = row.published
    return {
        "name": printed.name,
        "where": printed.where,
        "settings": dict(printed.settings),
        "unit": printed.unit,
        "paper": printed.value,
        "ours": row.value,
        "ratio": row.ratio,
        "kind": printed.rule,
        "verdict": "matches" if row.matches else "differs",
        "as_stated": row.as_stated,
        "obtained": printed.obtained,
        "why": printed.why,
    }


def _lines(model: Any, rows: Sequence[ComparedRow]) -> Iterator[str]:
    if not rows:
        yield f"{model.name} states no published numbers"
        return
    reasons = list(dict.fromkeys(one_line(row.published.why) for row in rows if row.published.why))
    numbers = {reason: f"[{index}]" for index, reason in enumerate(reasons, start=1)}
    head, *lines = aligned([HEAD, *(_cells(row, numbers) for row in rows)], right=(3, 4, 5))
    yield head
    shown: Mapping[str, str] = {}
    for row, line in zip(rows, lines, strict=True):
        if row.published.settings != shown:
            shown = row.published.settings
            yield "with " + one_line(", ".join(f"{name} = {value}" for name, value in shown.items()) or "the defaults")
        yield line
    if numbers:
        yield ""
    yield from (f"{number} {reason}" for reason, number in numbers.items())
    yield ""
    yield from (f"{kind}: {rule}" for kind, rule in rules_of(row.published for row in rows).items())
    for finding in model.findings:
        yield f"\nFinding: {one_line(finding.title)}\n  {one_line(finding.text)}"
    yield f"\n{_summary(rows)}"


def _cells(row: ComparedRow, numbers: Mapping[str, str]) -> tuple[str, ...]:
    printed = row.published
    verdict = "matches" if row.matches else "differs"
    if not row.as_stated:
        verdict += ", NOT AS STATED"
    ratio = "-" if row.ratio is None else f"{row.ratio:.4f}"
    values = (unit_text(printed.unit), format_number(printed.value, 5), format_number(row.value, 5), ratio)
    why = numbers.get(one_line(printed.why), "")
    return (one_line(printed.name), one_line(printed.where), *values, verdict, printed.obtained, printed.rule, why)


def _summary(rows: Sequence[ComparedRow]) -> str:
    matching = sum(row.matches for row in rows)
    wrong = [one_line(row.published.name) for row in rows if not row.as_stated]
    said = f"{counted(len(rows), 'printed number')}: {matching} match, {len(rows) - matching} differ"
    if not wrong:
        return f"{said}; every verdict is as stated"
    return f"{said}; NOT as stated: {', '.join(wrong)} (exit code 1)"
