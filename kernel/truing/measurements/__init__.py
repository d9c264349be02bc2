"""Tables: CSV with units in the header. Measured rows, cases of a run, rows of a virtual measurement."""

from __future__ import annotations

from truing.measurements.overriding import Case, RowsFile, read_cases, read_rows
from truing.measurements.table import DataTable, read_table
from truing.measurements.writing import write_table

__all__ = ["Case", "DataTable", "RowsFile", "read_cases", "read_rows", "read_table", "write_table"]
