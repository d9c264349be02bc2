"""What can be calculated: what models are for, the example of one, its figure, inputs files looked through."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from truing.api.model import LoadedModel
from truing.calculation import calculate
from truing.declare.sources import Effect, Tolerance
from truing.errors import InputError, TruingError
from truing.example_file import text_to_fill_in
from truing.inputs_file import read_setup
from truing.kernel import Kernel, Offer, offer_of
from truing.report.chapters import Figures, Writing, front_figure
from truing.report.document import FigureView


def installed() -> dict[str, Any]:
    """Return every installed model with what it is for, and the plugins that are broken, a sentence each."""
    kernel = Kernel.installed()
    models = [_said(offer) for offer in kernel.offers.values()]
    return {"models": models, "broken": [str(broken) for broken in kernel.broken]}


def one(plugin: str) -> dict[str, Any]:
    """Return the same of one model."""
    return _said(offer_of(plugin, lambda text: None))


def _said(offer: Offer) -> dict[str, Any]:
    model, origin = offer.model, offer.origin
    sources = [type(source) for source in model.errors]
    return {
        "name": offer.name, "title": model.title, "summary": model.summary, "plugin": origin.name,
        "version": origin.version, "distribution": origin.distribution,
        "inputs": len(model.input_fields), "results": len(model.result_fields),
        "effects": sum(issubclass(source, Effect) for source in sources),
        "tolerances": sum(issubclass(source, Tolerance) for source in sources),
        "studies": [study.name for study in model.studies],
    }  # fmt: skip


def example(plugin: str) -> str:
    """Return the inputs file that ``calc init`` writes."""
    return text_to_fill_in(offer_of(plugin, lambda text: None))


def picture(plugin: str) -> dict[str, str]:
    """Return the first figure of a model at its example, without its studies: title and SVG, empty where none is drawn.

    A figure that needs what a study finds is not drawn, and the next one is.
    """
    with suppress(TruingError):
        setup = LoadedModel(offer_of(plugin, lambda text: None)).setup()
        calculation = calculate(replace(setup, studies=()))
        for view in _figures(Writing(calculation, "normal", Figures())):
            return {"title": view.title, "svg": view.svg}
    return {"title": "", "svg": ""}


def _figures(writing: Writing) -> Iterator[FigureView]:
    model = writing.calculation.setup.model
    for section in [None, *model.sheet]:
        sections = model.sheet if section is None else [replace(section, key=True)]
        setup = replace(writing.calculation.setup, model=replace(model, sheet=sections))
        chapter = front_figure(replace(writing, calculation=replace(writing.calculation, setup=setup), made={}))
        for block in chapter.blocks if chapter is not None else ():
            if isinstance(block, FigureView) and block.svg:
                yield block


def looked_through(root: str, files: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Return the first fault of each inputs file that has one; ``files`` hold ``name`` and ``plugin``."""
    faults = {}
    for file in files:
        try:
            read_setup(Path(root, file["name"]), offer_of(file["plugin"], lambda text: None))
        except InputError as error:
            first = error.faults[0]
            more = len(error.faults) - 1
            where = f"line {first.line}: " if first.line else ""
            faults[file["name"]] = f"{where}{first.message}" + (f" (and {more} more)" if more else "")
        except TruingError as error:
            faults[file["name"]] = str(error)
    return faults
