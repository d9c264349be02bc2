"""The folder of a diagnosis: its document, its sheets, and the extended model, complete or absent."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from truing.diagnosis.result import DiagnosisResult
from truing.runs.diagnosis_document import diagnosis_document, file_labels
from truing.runs.extension import extended_text
from truing.runs.folder import npz_bytes, write_outcome
from truing.runs.new_effect import new_effect_source
from truing.runs.provenance import Provenance
from truing.units import from_si


def write_diagnosis(
    folder: Path,
    diagnosis: DiagnosisResult,
    *,
    provenance: Provenance,
    run_info: Mapping[str, Any],
    sheets: Mapping[str, str | bytes],
) -> dict[str, Any]:
    """Write the folder of a diagnosis and return diagnosis.json as data.

    ``sheets`` holds files by name, ``run_info`` what run.json says of this one run. A folder that is there already is
    replaced whole if it is a diagnosis of ours. Raises OutputError where it is not, or where nothing can be written.
    """
    document = diagnosis_document(diagnosis)
    data = {"data": dict(diagnosis.records.digests)}
    extension = {"extended.toml": extended_text(diagnosis, folder), "new_effect.py": new_effect_source(diagnosis)}
    files = {"arrays.npz": npz_bytes(curve_arrays(diagnosis)), **sheets}
    files |= {name: text for name, text in extension.items() if text}
    setup, run_info = diagnosis.setup, {**run_info, **data}
    write_outcome(folder, "diagnosis", setup, document, provenance=provenance, run_info=run_info, files=files)
    return document


def data_digests(diagnosis: DiagnosisResult) -> dict[str, str]:
    """Return the SHA-256 of every data file by the name it is given on the sheet."""
    records = diagnosis.records
    labels = zip(file_labels(records.files), records.files, strict=True)
    return {label: records.digests.get(file, "") for label, file in labels}


def curve_arrays(diagnosis: DiagnosisResult) -> dict[str, Any]:
    """Return what arrays.npz holds: per result measured, before and after in its printed unit; file, line and run."""
    records = diagnosis.records
    arrays: dict[str, Any] = {"file": records.file_of, "line": records.lines, "run": records.run_of}
    for item in diagnosis.curves:
        unit = diagnosis.setup.print_unit(item.result)
        for name in ("measured", "before", "after"):
            arrays[f"{item.result}.{name}"] = from_si(getattr(item, name), unit)
    return arrays
