"""calc plugins, describe, init, verify: what is installed, and what a model says of itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from truing.atomic import write_files
from truing.cli.console import Settings, aligned, json_text, out, out_json
from truing.cli.load import find_model, find_offer
from truing.declare.published import rules_of
from truing.describe import sections
from truing.errors import OutputError, UsageError
from truing.example_file import example_book, schema_name, text_to_fill_in, with_schema_line
from truing.inputs_file import json_schema
from truing.kernel import Kernel, Offer
from truing.numbers import counted, format_number
from truing.published import ComparedRow
from truing.texts import one_line
from truing.units import unit_text


def plugins(settings: Settings, *, as_json: bool, strict: bool) -> int:
    """List what is installed, from where, which version, and what broke while loading."""
    kernel = Kernel.installed(strict=strict)
    offers = kernel.offers
    if as_json:
        out_json({"models": [_model(offer) for offer in offers.values()], "broken": list(map(asdict, kernel.broken))})
        return 0
    rows = [("model", "version", "from", "title")]
    for offer in offers.values():
        home = offer.origin.distribution or offer.origin.file
        rows.append((offer.name, offer.origin.version, home, one_line(offer.model.title)))
    out("\n".join(aligned(rows)))
    for offer in offers.values():
        for addition in offer.added:
            out(f"  {offer.name}: {addition.plugin} {addition.version} adds '{addition.what}'")
    for broken in kernel.broken:
        settings.say(f"warning: {broken}")
    return 0


def _model(offer: Offer) -> dict[str, object]:
    return {
        "name": offer.name,
        "title": offer.model.title,
        "plugin": offer.origin.name,
        "version": offer.origin.version,
        "distribution": offer.origin.distribution,
        "file": offer.origin.file,
        "added": [addition.as_json for addition in offer.added],
    }


def describe(settings: Settings, asked: SimpleNamespace) -> int:
    """Show inputs, results, error sources and objectives: symbols, units, bounds, sources."""
    model = find_model(asked.plugin, settings)
    if asked.as_schema:
        out_json(json_schema(model.offer))
    elif asked.as_json:
        out_json(model.describe())
    else:
        out("\n".join(_described(model.describe())))
    return 0


def _described(said: dict[str, Any]) -> Iterator[str]:
    yield f"{said['name']} ({said['plugin']['version'] or 'a file'}): {one_line(said['title'])}"
    if said["summary"]:
        yield one_line(said["summary"])
    for title, rows in sections(said).items():
        yield ""
        yield title
        yield from aligned([("  " + one_line(row[0]), *map(one_line, row[1:])) for row in rows])
    if said["studies"]:
        yield ""
        yield "Studies: " + ", ".join(said["studies"])
    for addition in said["added"]:
        yield f"'{addition['what']}' was added by {addition['plugin']} {addition['version']}"


# A commented inputs file that holds the paper's example, and the schema by which editors complete it


def init(settings: Settings, asked: SimpleNamespace) -> int:
    """Write a commented inputs file that holds the shipped example."""
    offer = find_offer(asked.plugin, settings)
    output: Path | None = asked.output or (Path(f"{offer.name}.xlsx") if asked.excel else None)
    is_book = output is not None and output.suffix.lower() == ".xlsx"
    if asked.excel and not is_book:
        raise UsageError(f"--excel writes a workbook; name it like {asked.output.stem}.xlsx")
    text = "" if is_book else text_to_fill_in(offer)
    if output is None:
        out(text.rstrip("\n"))
        return 0
    files: dict[Path, str | bytes] = {output: example_book(offer) if is_book else text}
    if not asked.no_schema and not is_book:
        schema = output.parent / schema_name(offer)
        files = {output: with_schema_line(text, schema.name), schema: json_text(json_schema(offer), indent=None) + "\n"}
    if not asked.force:
        _demand_new(output, files)
    write_files(dict(reversed(files.items())))  # after a death between the two the same command goes on
    settings.say(f"wrote {' and '.join(map(str, files))}; now: calc run {asked.plugin} --inputs {output}")
    return 0


def _demand_new(output: Path, files: Mapping[Path, str | bytes]) -> None:
    """Raise OutputError where a file is there already, unless it is a schema that would be the same."""
    if output.exists():
        raise OutputError(f"{output} exists already; choose another name or say --force")
    for path, content in files.items():
        if path.exists() and isinstance(content, str) and not _holds(path, content):
            raise OutputError(f"{path} exists already and is another schema; say --force to replace it, or --no-schema")


def _holds(path: Path, content: str) -> bool:
    try:
        return path.read_bytes() == content.encode()
    except OSError:
        return False


# The paper's printed numbers beside ours


HEAD = ("quantity", "where", "unit", "paper", "ours", "ratio", "verdict", "obtained", "kind", "why")


def verify(settings: Settings, asked: SimpleNamespace) -> int:
    """Print every number that the source prints beside ours; exit 0 if every row matches its stated verdict."""
    model = find_model(asked.plugin, settings)
    rows = model.verify(progress=not settings.quiet)
    if asked.as_json:
        findings = [asdict(finding) for finding in model.offer.model.findings]
        rules = rules_of(row.published for row in rows)
        out_json({"rows": [_row(row) for row in rows], "rules": rules, "findings": findings})
    else:
        out("\n".join(_verified(model.offer.model, rows)))
    return 0 if all(row.as_stated for row in rows) else 1


def _row(row: ComparedRow) -> dict[str, Any]:
    printed = row.published
    return {
        "name": printed.name, "where": printed.where, "settings": dict(printed.settings), "unit": printed.unit,
        "paper": printed.value, "ours": row.value, "ratio": row.ratio, "kind": printed.rule, "verdict": _verdict(row),
        "as_stated": row.as_stated, "obtained": printed.obtained, "why": printed.why,
    }  # fmt: skip


def _verdict(row: ComparedRow) -> str:
    return "matches" if row.matches else "differs"


def _verified(model: Any, rows: Sequence[ComparedRow]) -> Iterator[str]:
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
    verdict = _verdict(row) + ("" if row.as_stated else ", NOT AS STATED")
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
