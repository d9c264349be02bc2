"""Libraries that take longer to import than most calculations take, each imported when it is first used.

A file that needs one imports its name from here at the top, like any other; the import itself waits.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any


class Later:
    """A module by its name, imported when something of it is first asked for; ``homes`` say where some names are."""

    def __init__(self, name: str, **homes: str) -> None:
        self._name = name
        self._homes = homes

    def __getattr__(self, name: str) -> Any:
        """Return what the module calls so. Raises ImportError where it is not installed."""
        return getattr(import_module(self._homes.get(name, self._name)), name)


if TYPE_CHECKING:
    import narwhals as narwhals
    import pint as pint
    from scipy import optimize as optimize
else:
    narwhals = Later("narwhals")
    pint = Later("pint")
    optimize = Later("scipy.optimize")
gaussian_process: Any = Later("sklearn.gaussian_process")
gaussian_kernels: Any = Later("sklearn.gaussian_process.kernels")
learning_exceptions: Any = Later("sklearn.exceptions")
stats: Any = Later("scipy.stats")
rich: Any = Later(
    "rich",
    Console="rich.console",
    Live="rich.live",
    ProgressBar="rich.progress_bar",
    Table="rich.table",
)
ipython_display: Any = Later("IPython.display")
integrate: Any = Later("scipy.integrate")
sparse: Any = Later("scipy.sparse")
openpyxl: Any = Later(
    "openpyxl",
    EMPTY_CELL="openpyxl.cell.read_only",
    DataValidation="openpyxl.worksheet.datavalidation",
    Font="openpyxl.styles",
    Tokenizer="openpyxl.formula",
    TokenizerError="openpyxl.formula.tokenizer",
    WriteOnlyCell="openpyxl.cell",
    column_index_from_string="openpyxl.utils",
    get_column_letter="openpyxl.utils",
)
pypdf: Any = Later("pypdf")
nptdms: Any = Later("nptdms")
asammdf: Any = Later("asammdf")
h5py: Any = Later("h5py")
matlab_files: Any = Later("scipy.io")
pyarrow: Any = Later("pyarrow", ParquetFile="pyarrow.parquet", write_table="pyarrow.parquet", types="pyarrow")
docx: Any = Later(
    "docx",
    Mm="docx.shared",
    Pt="docx.shared",
    RGBColor="docx.shared",
    WD_STYLE_TYPE="docx.enum.style",
    WD_TAB_ALIGNMENT="docx.enum.text",
    WD_TAB_LEADER="docx.enum.text",
    parse_xml="docx.oxml",
    qn="docx.oxml.ns",
)
pymoo: Any = Later(
    "pymoo",
    Config="pymoo.config",
    Evaluator="pymoo.core.evaluator",
    HV="pymoo.indicators.hv",
    NSGA2="pymoo.algorithms.moo.nsga2",
    PM="pymoo.operators.mutation.pm",
    Problem="pymoo.core.problem",
    Repair="pymoo.core.repair",
    StaticProblem="pymoo.problems.static",
)
