"""Diagnoses: made from measured files, shown from the folder they left, accepted as an inputs file; experiments."""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from truing.diagnosis.causes import INPUT
from truing.diagnosis.result import UNKNOWN
from truing.errors import UsageError
from truing.heavy import Later
from truing.inputs_file import read_setup, setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.measurements import table_text
from truing.measurements.csv_text import name_and_unit
from truing.numbers import format_number
from truing.report.diagnosis_words import headline, spoken, verdict_word
from truing.runs.inputs_written import complete_inputs
from truing.studies.bench import Progress
from truing.units import unit_text
from truing.workbench.tasks.loaded import loaded

model: Any = Later("truing.api.model")
recorded: Any = Later("truing.api.records")
"""Figures come with them: pages that show a folder do without."""
CAUSES = "studies.diagnose.causes"
SIZE_DIGITS = 4


def candidates(plugin: str, file: str, folder: str, text: str) -> dict[str, Any]:
    """Return what may compete to explain a record, what competes by the inputs file, and what can be planned for."""
    offer = loaded(plugin)
    setup = setup_from_text(text, offer, file=file, folder=Path(folder))
    declared = setup.model
    several = [
        {"name": name, "title": spoken(name), "about": effect.looks_like or effect.why,
         "kind": "effect" if name in declared.effects else "gauge"}
        for name, effect in declared.known_effects.items()
    ]  # fmt: skip
    for tolerance in declared.tolerances.values():
        several += [
            {"name": INPUT + name, "title": spoken(INPUT + name), "about": tolerance.why, "kind": "input"}
            for name in tolerance.on
        ]
    words = "a curve that nobody registered, over whatever was measured"
    several.append({"name": UNKNOWN, "title": "something unknown", "about": words, "kind": "unknown"})
    results = [
        {"name": name, "unit": setup.print_unit(name)} for name in declared.measurable
        if not declared.own_result_fields[name].along
    ]  # fmt: skip
    return {"candidates": several, "causes": list(setup.diagnose.causes), "results": results}


def diagnose(
    plugin: str, file: str, root: str, *, data: list[str], output: str, causes: list[str], progress: Progress
) -> dict[str, Any]:  # fmt: skip
    """Diagnose measured files and write the folder of the diagnosis; return where it is, and the verdict in words.

    Files are named as seen from the folder that is served, as on the command line there.
    """
    os.chdir(root)
    Path(output).parent.mkdir(parents=True, exist_ok=True)
    record = recorded.MeasuredRecord(tuple(Path(name) for name in data))
    stated = {CAUSES: toml_value(causes)} if causes else {}
    made = model.LoadedModel(loaded(plugin)).diagnose(
        record, Path(file), output=Path(output), set=stated, progress=progress
    )  # fmt: skip
    said = [f"{verdict_word(made.result)}.", *headline(made.result)]
    return {"folder": output, "verdict": made.verdict, "sentences": said, "sheet": f"{output}/sheet.html"}


def shown(root: str, folder: str) -> dict[str, Any]:
    """Return what the page of a diagnosis shows, from the files of its folder."""
    path = Path(root) / folder
    try:
        document = json.loads((path / "diagnosis.json").read_text(encoding="utf-8"))
        sheet = (path / "sheet.md").read_text(encoding="utf-8")
        return {
            "plugin": document["plugin"]["name"],
            "verdict": document["verdict"],
            "sentences": list(_lead(sheet)),
            "causes": [_cause(cause) for cause in document["causes"]],
            "explanations": document["explanations"],
            "ranking": [_ranked(each) for each in document["ranking"]],
            "gain": [_gain(name, each) for name, each in document["gain"].items() if name != "stability"],
            "warnings": document["warnings"],
            "experiment": _experiment(document["experiment"], _result_units(path)),
            "is_extended": (path / "extended.toml").is_file(),
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise UsageError(f"{folder[:80]} holds no diagnosis that can be read") from None


def _lead(sheet: str) -> Iterator[str]:
    """Give the first sentences of a sheet: what stands before its first chapter, without title and tables."""
    for line in sheet.partition("\n## ")[0].splitlines():
        if line and not line.startswith(("#", "|", "![")):
            yield line.replace("**", "").replace("\\", "")


def _cause(cause: Mapping[str, Any]) -> dict[str, Any]:
    sizes = [_size(name, each) for name, each in cause["unknowns"].items()]
    return {
        "name": cause["effect"], "title": spoken(cause["effect"]), "sizes": sizes, "share": round(100 * cause["share"]),
        "same_as": [spoken(name) for name in cause["same_as"]], "remedy": cause.get("remedy") or "",
    }  # fmt: skip


def _size(name: str, fitted: Mapping[str, Any]) -> str:
    ends = ["open" if end is None else format_number(end, SIZE_DIGITS) for end in fitted["interval95"]]
    value = f"{spoken(name)} {format_number(fitted['value'], SIZE_DIGITS)} {unit_text(fitted['unit'])}".rstrip()
    return f"{value} (95 %: {ends[0]} … {ends[1]})"


def _ranked(alternative: Mapping[str, Any]) -> dict[str, Any]:
    names = alternative["causes"]
    title = " and ".join(spoken(name) for name in names) or "the model as it is"
    return {"causes": names, "title": title, "behind": round(alternative["behind"], 1)}


def _gain(name: str, gain: Mapping[str, Any]) -> dict[str, Any]:
    sizes = {key: gain[key] for key in ("rmse_before", "rmse_after", "noise_floor")}
    texts = {
        key: f"{format_number(size['value'], 3)} {unit_text(size['unit'])}".rstrip() for key, size in sizes.items()
    }
    return {"result": name, "title": spoken(name), **texts, "p_value": gain["p_value"]}


def accepted(plugin: str, root: str, folder: str, file: str, target: str) -> str:
    """Return the inputs file of the extended model as it may stand at ``target``, comments and all.

    What restricted the search to some causes goes, where the inputs file of the diagnosis (``file``) does not say so.
    """
    path, offer = Path(root) / folder / "extended.toml", loaded(plugin)
    if not path.is_file():
        raise UsageError("nothing was named and nothing calibrated: there is no extended model")
    text = path.read_text(encoding="utf-8")
    setup = read_setup(path, offer)
    if setup.source.files and path.parent != (Path(root) / target).parent:
        text = complete_inputs(setup, (Path(root) / target).parent)
    own = read_setup(Path(root) / file, offer).diagnose.causes if file else ()
    if setup.diagnose.causes and setup.diagnose.causes != own:
        kept = [line for line in text.splitlines() if not line.startswith("causes = [")]
        text = "\n".join(kept).replace("[studies.diagnose]\n\n", "") + "\n"
    return text


# Experiments: proposed by a diagnosis, or planned for causes before there is any


def plan(
    plugin: str, file: str, root: str, *, causes: list[str], noise: dict[str, str], budget: int, progress: Progress
) -> dict[str, Any]:  # fmt: skip
    """Plan the experiment that tells causes apart; return it in words, and its readings as a table and as CSV."""
    os.chdir(root)
    made = model.LoadedModel(loaded(plugin)).plan(causes, Path(file), noise=noise, budget=budget, progress=progress)
    units = {name: made.planned.setup.print_unit(name) for name in made.planned.noise}
    return {"sentences": list(made.sentences), "experiment": _experiment(made.document["experiment"], units)}


def _result_units(path: Path) -> dict[str, str]:
    """Return the units of the measured results, as the rows of a diagnosis have them in their headers."""
    with (path / "rows.csv").open(encoding="utf-8", newline="") as stream:
        named = (name_and_unit(cell.strip()) for cell in next(csv.reader(stream), []))
    return {name: unit or "" for name, unit in named if name}


def _experiment(experiment: Mapping[str, Any] | None, units: Mapping[str, str]) -> dict[str, Any] | None:
    """Return the readings of an experiment as a table: headers, rows, and the CSV file to be filled in."""
    if experiment is None:
        return None
    columns: dict[str, Sequence[float]] = {
        f"{name} [{setting['unit'] or '1'}]": setting["values"] for name, setting in experiment["settings"].items()
    }
    empty = [None] * experiment["readings"]
    results = {f"{name} [{units.get(name) or '1'}]": empty for name in experiment["results"]}
    text = table_text([*columns, *results], [*columns.values(), *results.values()])
    rows = [[f"{value:.6g}" for value in row] for row in zip(*columns.values(), strict=True)]
    chance = experiment["chance"]
    return {"headers": list(columns), "results": list(results), "rows": rows, "csv": text, "chance": chance,
            "tells": experiment["tells"]}  # fmt: skip
