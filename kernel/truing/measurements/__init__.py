"""Tables: CSV with units in the header. Measured rows, cases of a run, rows of a virtual measurement."""

from __future__ import annotations

from truing.measurements.csv_text import RowCount, TableSource, TableText
from truing.measurements.overriding import CasesFile, RowsFile, StatedCase, read_cases, read_rows
from truing.measurements.table import EXCEL, INERT, PLAIN, DataTable, TableStyle, read_table, table_text

__all__ = [
    "EXCEL",
    "INERT",
    "PLAIN",
    "CasesFile",
    "DataTable",
    "RowCount",
    "RowsFile",
    "StatedCase",
    "TableSource",
    "TableStyle",
    "TableText",
    "read_cases",
    "read_rows",
    "read_table",
    "table_text",
]  # fmt: skip
