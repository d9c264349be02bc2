"""The sheet in another language: every word of the kernel is translated, and no word of anybody else."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from diagnosis_samples import SAMPLES, SLIDE
from matplotlib.figure import Figure
from matplotlib.text import Text
from test_diagnosis_sentences import torn

import truing
from truing import Allocation, Reliability, Sensitivity, Sweep, Uncertainty
from truing.calculation import Calculation, calculate
from truing.cases import run_cases
from truing.declare.blocks import Drawing
from truing.declare.model import Study
from truing.diagnosis.sentences import SENTENCES
from truing.errors import InputError, UsageError
from truing.executors import open_executor
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Kernel, Offer
from truing.measurements import read_cases
from truing.published import compare_published
from truing.report import chapters
from truing.report.comparison_page import Side, comparison_page
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.document import (
    Chapter,
    Document,
    Equation,
    FigureView,
    Fold,
    Items,
    Marked,
    TableView,
    Value,
)
from truing.report.figures import draw
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.report.sheet import make_sheet, study_sheet
from truing.report.translation import (
    COMPARISON,
    DIAGNOSIS,
    ENGLISH_WORDS,
    GAP,
    LISTS,
    Catalogue,
    catalogue_of,
    kernel_catalogue,
    kernel_words,
    translated,
    words_in,
)
from truing.report.wording import STUDY
from truing.runs.provenance import provenance_of
from truing.setup import SheetOptions, default_setup, sheet_in
from truing.templating import ENGLISH, languages, template_folder

FOREIGN = [language for language in languages() if language != ENGLISH]
MODELS = (
    "harmonic_fractal", "harmonic_fractal.run_up", "harmonic_fractal.vibration", "press_linkage",
    "press_linkage.motion", "roller_screw_shift", "rv_gearing", "rv_wear",
)  # fmt: skip
FEW = {"draws": 200, "points": 7, "design": 20, "held_out": 12, "restarts": 0, "compare": 20, "population": 8,
       "generations": 2, "verify": 200}  # fmt: skip
"""Options of studies that make a sheet quickly; its words do not depend on them."""
LEFT = "‖"


# What a sheet says, text by text, and what authors wrote of it


def texts_of(part: Any) -> Iterator[str]:
    """Every text of a part of a document that somebody may have to translate, the names of quantities left out."""
    match part:
        case str():
            yield part
        case Value(text):
            yield text
        case Marked("strong" | "aside" | "break", text):
            yield from texts_of(text)
        case tuple():
            is_label = any(isinstance(piece, Marked) and piece.kind == "bracketed code" for piece in part)
            for piece in part[1:] if is_label else part:
                yield from texts_of(piece)
        case Items("provenance" | "references", _, labels):
            yield from labels
        case TableView(title, columns, rows, note):
            yield from (title, *texts_of(note), *(column.title for column in columns))
            yield from (text for row in rows for cell in row for text in texts_of(cell))
        case FigureView(title, _, caption):
            yield from (title, caption)
        case Chapter(title, inner) | Fold(title, inner):
            yield title
            for block in inner:
                yield from texts_of(block)
        case Equation() | Marked() | None:
            return
        case _:
            yield from (text for each in fields(part) if each.name not in ("kind", "name", "labels")
                        for text in texts_of(getattr(part, each.name)))  # fmt: skip
            yield from getattr(part, "labels", ())


def all_texts(sheet: Document) -> Iterator[str]:
    """Every text of a document; what the user wrote into the title block is the user's."""
    yield from (sheet.kind, sheet.summary, sheet.banner.headline, *sheet.alarms, *sheet.warnings, sheet.head.model)
    yield from (label for label, _ in (*sheet.head.fields, *sheet.head.signatures))
    for part in (*sheet.banner.sentences, *sheet.front, *sheet.chapters):
        yield from texts_of(part)


def written_in(declared: Any, seen: set[int]) -> Iterator[str]:
    """Every text in a declaration, however deep."""
    if isinstance(declared, str):
        yield declared
    elif id(declared) not in seen:
        seen.add(id(declared))
        inner: Any = ()
        if isinstance(declared, Mapping):
            inner = (*declared, *declared.values())
        elif isinstance(declared, (list, tuple, set, frozenset)):
            inner = declared
        elif is_dataclass(declared) and not isinstance(declared, type):
            inner = [getattr(declared, each.name, None) for each in fields(declared)]
        for each in inner:
            yield from written_in(each, seen)


def plain(text: str) -> str:
    return text.replace("_", " ").strip(" ,.;:()").lower()


@cache
def sample(name: str) -> tuple[Document, frozenset[str]]:
    """The English sheet of a shipped model, everything on it, and all that its plugin wrote."""
    offer = offers()[name]
    assert offer.model.example is not None
    setup = read_setup(offer.model.example, offer)
    studies = []
    for study in setup.studies:
        known = {each.name for each in fields(study)} & {*FEW} - ({"points"} if name == "roller_screw_shift" else set())
        studies.append(replace(study, **{option: FEW[option] for option in known}))  # type: ignore[type-var]
    setup = replace(setup, sheet=replace(setup.sheet, detail="full"), studies=tuple(studies))
    calculation = calculate(setup)
    verified = compare_published(offer, known=calculation) if name == "rv_gearing" else ()
    sheet = make_sheet(calculation, provenance=provenance_of(setup, date="2026-11-26"), verified=verified)
    CALCULATIONS[name] = calculation
    return sheet, frozenset(authored(calculation))


CALCULATIONS: dict[str, Calculation] = {}
"""What the samples were made of."""


@cache
def offers() -> Mapping[str, Offer]:
    return Kernel.installed().offers


def authored(calculation: Calculation) -> Iterator[str]:
    model = calculation.setup.model
    fields_of_model = (model.input_fields, model.result_fields, model.known_conditions, model.effects)
    blocks = [block for section in model.sheet if section.blocks for block in section.blocks(calculation.record)]
    guests = [each for each in calculation.outcomes.values() if not type(each).__module__.startswith("truing.")]
    blocks += [block for outcome in guests for block in outcome.blocks()]
    titles = [f"{block.title}. {block.caption}" for block in blocks if isinstance(block, Drawing)]
    said = [text.partition(": ")[2] for outcome in guests for text in outcome.warnings()]
    yield from written_in([model, fields_of_model, calculation.setup.source, blocks, titles, said], set())


def pseudo(language: str) -> Catalogue:
    """A language in which every known word is taken out and only what stands in gaps is left."""
    places = {
        place: {text: LEFT.join(["", *(f"{{{gap}}}" for gap in GAP.findall(text)), ""]) for text in words}
        for place, words in kernel_words(language).items()
    }
    return Catalogue("pseudo", places)


def is_authors(text: str, known: frozenset[str]) -> bool:
    """Whether what is left of a text is words of its author, a setting, a unit or a number."""
    text = re.sub(r" \(95 %: [−\d.]+ … [−\d.]+\)", "", text)
    said = plain(text)
    if (
        said in known
        or not re.search(r"[^\W\d_]{3}", said)
        or re.fullmatch(r"[\d.−]+ \S+|\S*[µ/·^²]\S*|.*\.csv:\d+", text.strip())
    ):
        return True
    if re.fullmatch(r"[\w ]+ = .*|[\w ]+ IT\d+ →|[\w ]+ [−\d.e+-]+ ?\S+", said):
        return True
    head, _, tail = text.rpartition(", ")
    if head and is_authors(head, known) and is_authors(tail, known):
        return True
    parts = re.split(r", | \+ |: |; |\. ", text)
    return len(parts) > 1 and all(is_authors(part, known) for part in parts)


def unknown_in(sheet: Document, words: Catalogue, written: frozenset[str]) -> list[str]:
    """What of a sheet no word of a catalogue knows, and no author wrote."""
    known = frozenset(map(plain, written))
    left = [part for text in all_texts(translated(sheet, words)) if plain(text) not in known
            for part in text.split(LEFT)]  # fmt: skip
    return sorted({text.strip() for text in left if not is_authors(text, known)})


# Every word is translated


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw nothing where a sheet is made for its words."""
    monkeypatch.setattr(chapters, "draw", lambda *_, **__: "")


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", MODELS)
def test_every_word_of_the_kernel_on_a_sheet_is_translated(name: str, language: str) -> None:
    assert unknown_in(sample(name)[0], pseudo(language), sample(name)[1]) == []


def alone(name: str, study: Study) -> tuple[Document, frozenset[str]]:
    """The sheet of a study that is asked alone."""
    setup = default_setup(offers()[name].model, offers()[name].origin)
    calculation = calculate(replace(setup, studies=(study,)))
    sheet = study_sheet(calculation, provenance=provenance_of(setup, date="2026-11-26"))
    return sheet, frozenset((*authored(calculation), *STATED))


def cases(detail: str) -> tuple[Document, frozenset[str]]:
    """A sheet of three cases, one of which cannot be calculated and one misses a limit."""
    offer = offers()["rv_gearing"]
    setup = replace(default_setup(offer.model, offer.origin), studies=(), sheet=SheetOptions(detail=detail))
    with TemporaryDirectory() as folder:
        file = Path(folder, "cases.csv")
        file.write_text("case,load_torque [N*m]\nusual,8\nheavy,800\nnone,1e9\n", encoding="utf-8")
        calculation, made = run_cases(setup, read_cases(file, offer, setup), executor=open_executor("serial"))
    sheet = make_sheet(calculation, provenance=provenance_of(setup, date="2026-11-26"), cases=made)
    return sheet, frozenset((*authored(calculation), *STATED))


STATED = ("usual", "heavy", "load torque", "sun torque")
"""What stands in the file of the cases."""
SHEETS: Mapping[str, Callable[[], tuple[Document, frozenset[str]]]] = {
    "cases": partial(cases, "normal"),
    "cases short": partial(cases, "short"),
    "uncertainty": partial(alone, "press_linkage", Uncertainty(of=("slider_position",), draws=300)),
    "sweep of two": partial(alone, "press_linkage", Sweep(
        over="crank_angle", at="-20..20 deg", points=5, by="crank_radius", by_at="0.1, 0.15 m",
        results=("slider_position",),
    )),
    "indices": partial(alone, "press_linkage", Sensitivity(of=("slider_position",), sobol=64)),
    "over": partial(alone, "rv_wear", Reliability(draws=100, over="working_time", at="0..6000 h", points=3)),
    "widths": partial(alone, "rv_wear", Allocation(of="backlash", draws=200)),
}  # fmt: skip


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", SHEETS)
def test_every_word_of_cases_and_of_a_study_alone_is_translated(name: str, language: str) -> None:
    sheet, written = SHEETS[name]()
    place = STUDY if sheet.kind.startswith("Study: ") else ""
    assert unknown_in(sheet, pseudo(language).at(place), written) == []


MADE = {**SAMPLES, "torn": torn}
OF_SAMPLES = frozenset({
    "press_record.csv", "second day.csv", "press_record.csv, second day.csv", "hall", "extended.toml", "speed",
    "speed swing",
    "speed swing (speed)", "warm up", "size", "slope", "expansion (of the rod)", "heavy, t with 4 degrees of freedom",
    "12 waves over the range of crank angle, with 31 % of what is left",
    "the range of crank angle, with 31 % of what is left", "rises with rod temperature: 3.8 µm per K",
    "order 7 of crank angle, amplitude 14 µm", "time", "row order", "all explanations fitted again",
    "Warm at once: heat follows the temperature, a drift follows the clock", "calc run slide --inputs extended.toml",
    "sensor offset", "sensor drift", "unregistered",
})  # fmt: skip
"""What the made diagnoses hold in place of words that the kernel finds."""


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", MADE)
def test_every_word_of_a_diagnosis_is_translated(name: str, language: str) -> None:
    made = MADE[name]()
    sheet = make_diagnosis_sheet(made, provenance=provenance_of(made.setup, date="2026-11-26"))
    written = frozenset(written_in([SLIDE, SLIDE.input_fields, SLIDE.result_fields, SLIDE.conditions], set()))
    assert unknown_in(sheet, pseudo(language).at(DIAGNOSIS), written | OF_SAMPLES) == []


RUN: Mapping[str, Any] = {
    "kernel": "1.0", "seed": 1, "verdict": "passes", "plugin": {"name": "press", "version": "1.0", "model": "press"},
    "inputs": {"load": {"value": 1.0, "unit": "N"}, "gap": {"value": 1.0, "unit": "mm"}},
    "tolerances": {"load": {"spread": "sd 1 %", "on": {"load": {"sd": 1.0}}}},
    "conditions": {"rod_temperature": {"value": 20.0, "unit": "degC"}}, "effects": {"wear": {"value": 1.0}},
    "results": {"depth": {"value": [1.0, 2.0], "unit": "um"}, "large": {"array": "large", "shape": [9]},
                **{f"path_{place}": {"value": 1.0, "unit": "mm"} for place in range(12)}},
    "checks": [{"name": f"stress_{place}", "value": 1.0, "limit": 2.0, "unit": "MPa", "margin": 0.5, "passed": True,
                "relation": "≤", "state": "passes"} for place in range(5)],
    "studies": {"sweep": {"values": [1.0, 2.0]}},
}  # fmt: skip
"""What a run wrote, with something of every kind that is compared."""


def moved(piece: Any) -> Any:
    """The same with every number twice as large, and every limit that passed failed."""
    if isinstance(piece, Mapping):
        more = {"state": "fails", "passed": False} if "state" in piece else {}
        return {name: moved(each) for name, each in piece.items()} | more
    if isinstance(piece, list):
        return [moved(each) for each in piece]
    return 2 * piece if isinstance(piece, float) else piece


OTHER_RUN = {
    **moved(RUN), "kernel": "2.0", "seed": 2, "verdict": "fails", "effects": {"drift": {"value": 1.0}},
    "plugin": {"name": "press", "version": "2.0", "model": "press"}, "inputs": {"load": {"value": 2.0, "unit": "N"}},
}  # fmt: skip
FOUND: Mapping[str, Any] = {
    "schema": "truing.diagnosis/1", "verdict": "none", "unique": None, "alternatives": [], "causes": [], "rows": 10,
    "runs": 1, "input_hash": "8", "measured": "9", "held_out": 0, "files": {},
    "wrong": {"depth": {"rmse": {"value": 1.0, "unit": "um"}, "noise_floor": {"value": 1.0, "unit": "um"}}},
}  # fmt: skip
CAUSE = {"effect": "wear", "unknowns": {"rate": {"value": 1.0, "unit": "um", "interval95": [0.0, 2.0]}}}
OTHERS_FOUND = (
    {**moved(FOUND), "verdict": "named", "unique": True, "causes": [CAUSE], "remainder": {"depends_on": "load"}},
    {**FOUND, "verdict": "unknown", "alternatives": [{"causes": ["wear"]}], "causes": [moved(CAUSE)]},
    {**FOUND, "verdict": "undecided", "causes": [{**CAUSE, "unknowns": {"rate": {"value": 9.0, "unit": "um"}}}]},
)


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("pair", [(RUN, OTHER_RUN), (OTHER_RUN, RUN), (RUN, {**RUN}),
                                  *zip((FOUND, *OTHERS_FOUND), OTHERS_FOUND, strict=False)])  # fmt: skip
def test_every_word_of_a_page_of_two_is_translated(pair: tuple[Any, Any], language: str) -> None:
    page = comparison_page(*(Side("side", document) for document in pair))
    authors = {name.replace("_", " ") for document in pair for kind in ("inputs", "results", "conditions", "effects")
               for name in document.get(kind, {})}  # fmt: skip
    names = {*authors, "side", "press", "Truing", "load", "sweep", "wear", "drift", "wear.rate", "depth.rmse",
             "depth.noise_floor", "sd 1 %", "sd 2 %", *(f"stress {place}" for place in range(5))}  # fmt: skip
    assert unknown_in(page, pseudo(language).at(COMPARISON), frozenset(names)) == []


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("kind", SENTENCES)
def test_every_sentence_of_a_diagnosis_has_a_translation_with_its_gaps(kind: str, language: str) -> None:
    text = SENTENCES[kind].text
    if text == "{cause}: {sizes}":
        return  # holds no word
    said = {text: said for words in kernel_words(language).values() for text, said in words.items()}
    assert {*GAP.findall(said[text])} == {*GAP.findall(text)}


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", MODELS)
def test_no_word_of_an_author_is_translated_by_the_kernel(name: str, language: str) -> None:
    words = kernel_catalogue(language)
    prose = {text for text in sample(name)[1] if " " in text and text[:1] != "<"}
    changed = {text: said for text in prose if (said := words.said(text)) != text}
    kernels = {*kernel_words(language)[""], *(text for text in changed if re.match(r"study '", text))}
    assert {text: said for text, said in changed.items() if text.rstrip(".") not in kernels} == {}


def labels_of(figure: Figure) -> Iterator[str]:
    """Every text that is drawn, but numbers at ticks."""
    yield from (text.get_text() for text in figure.findobj(Text))
    for axes in figure.axes:
        yield from (label.get_text() for label in (*axes.get_xticklabels(), *axes.get_yticklabels()))


def unknown_labels(figures: Iterable[Figure], words: Catalogue, written: frozenset[str]) -> list[str]:
    known = frozenset(map(plain, written))
    said = {part for figure in figures for label in labels_of(figure) for line in words.said(label).split("\n")
            for part in line.split(LEFT)}  # fmt: skip
    named = {re.sub(r" \[.*\]$|, [^,]*$", "", part) for part in said}
    return sorted(part for part in named if not is_authors(part, known))


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", ["named", "ambiguous", "unknown"])
def test_every_word_in_the_figures_of_a_diagnosis_is_translated(
    name: str, language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(chapters, "draw", lambda what, **_: drawn.append(what()) or "")
    made = MADE[name]()
    make_diagnosis_sheet(made, provenance=provenance_of(made.setup))
    written = frozenset(written_in([SLIDE, SLIDE.input_fields, SLIDE.result_fields, SLIDE.conditions], set()))
    assert len(drawn) > 5
    assert unknown_labels(drawn, pseudo(language).at(DIAGNOSIS), written | OF_SAMPLES) == []


@pytest.mark.parametrize("language", FOREIGN)
@pytest.mark.parametrize("name", ["harmonic_fractal.vibration", "press_linkage", "press_linkage.motion", "rv_wear"])
def test_every_word_in_the_figures_of_a_study_is_translated(name: str, language: str) -> None:
    written = sample(name)[1]
    outcomes = [each for each in CALCULATIONS[name].outcomes.values() if type(each).__module__.startswith("truing.")]
    drawn = [block.draw() for each in outcomes for block in each.blocks() if isinstance(block, Drawing)]
    assert drawn
    assert unknown_labels(drawn, pseudo(language).at(STUDY), written) == []


# Printing


def german(sheet: Document, place: str = "") -> Document:
    return translated(sheet, kernel_catalogue("de").at(place))


def test_a_german_sheet_says_so_and_prints_the_words_of_its_templates() -> None:
    sheet = german(sample("press_linkage")[0])
    page, text = html_of(sheet), markdown_of(sheet)
    assert page.startswith('<!DOCTYPE html>\n<html lang="de">')
    for words in ("Datum, Unterschrift", "Nachweise", "Bild 1", "mit Änderung"):
        assert words in page
        assert words in text
    assert not re.search(r"Date, signature|>Contents|Figure \d|not as stated", page)


def test_an_english_sheet_is_the_very_same_document() -> None:
    sheet = sample("press_linkage")[0]
    assert sheet.language == ENGLISH
    assert translated(sheet, ENGLISH_WORDS) is sheet


def test_words_that_stand_in_formulas_are_translated() -> None:
    words = kernel_catalogue("de")
    assert words.formula("<mtext>if\u00a0</mtext><mi>a</mi><mtext>otherwise</mtext>") == (
        "<mtext>wenn\u00a0</mtext><mi>a</mi><mtext>sonst</mtext>"
    )
    assert words.formula("<mi>order</mi><mtext>and so on</mtext>") == "<mi>order</mi><mtext>and so on</mtext>"


def test_texts_of_a_figure_are_translated_ticks_and_units_among_them() -> None:
    texts: list[str] = []

    def drawn() -> Figure:
        figure = Figure()
        axes = figure.subplots()
        axes.barh([0, 1], [1, 2], label="before")
        axes.set_yticks([0, 1], ["nothing but scatter", "pulley slip"])
        axes.set_xlabel("simulated shaft angle [°]")
        axes.set_ylabel("measured − model\n[µm]")
        axes.legend()
        figure.draw = lambda *_: texts.extend(each.get_text() for each in figure.findobj(Text))
        return figure

    draw(drawn, title="Gain", ident="f1", words=kernel_catalogue("de").at(DIAGNOSIS))
    assert {"vorher", "nur Streuung", "pulley slip", "shaft angle, gerechnet [°]", "gemessen − Modell\n[µm]"} <= {
        *texts
    }


# How texts are found


WORDS = Catalogue("xx", {
    "": {"value": "Wert", "{count} of {total} are off by {amount}": "{count} aus {total} um {amount} daneben",
         "and": "und", "wrong: {causes}": "falsch: {causes}", "wrong": "falsch"},
    "causes": {"{name} outside": "{name} außerhalb"},
}, {"pulley tension": "Riemenspannung"})  # fmt: skip


@pytest.mark.parametrize(("text", "said"), [
    ("value", "Wert"), ("Value.", "Wert."), ("values", "values"), ("  value ", "  Wert "), ("42 %", "42 %"),
    ("3 of 4 are off by 2 mm", "3 aus 4 um 2 mm daneben"), ("some of 4 are off by 2 mm", "some of 4 are off by 2 mm"),
    ("Wrong: rod outside, drift and this and that.", "Falsch: rod außerhalb, drift und this und that."),
    ("rod outside", "rod outside"), ("Value. Wrong.", "Wert. Falsch."), ("value; wrong", "Wert; falsch"),
    ("value; unheard of", "value; unheard of"), ("value [mm]", "Wert [mm]"),
])  # fmt: skip
def test_a_text_is_said_whole_by_pattern_or_by_parts(text: str, said: str) -> None:
    assert WORDS.said(text) == said


def test_what_a_quantity_is_called_is_left_to_its_author() -> None:
    assert (WORDS.name("value"), WORDS.name("pulley tension")) == ("value", "Riemenspannung")


# The language is asked for


BELT = '''
from truing import Float, Model, Section, found, given, hookimpl, inputs, results

@inputs
class Belt:
    """A pulley."""
    tension: Float = given(400.0, "N", note="pulley tension")

@results
class Force:
    """Its force."""
    force: Float = found("N", formula="2 * tension", note="force on the shaft")

def drive(pulley: Belt) -> Force:
    """Twice the tension."""
    return Force(force=2 * pulley.tension)

BELT = Model(name="pulley", title="Belt drive", function=drive, sheet=[Section("Shaft", "force")])

@hookimpl
def truing_models():
    """One calculation."""
    return [BELT]
'''


@pytest.fixture
def pulley(tmp_path: Path) -> Path:
    (tmp_path / "words").mkdir()
    (tmp_path / "pulley.py").write_text(BELT, encoding="utf-8")
    return tmp_path / "pulley.py"


def test_a_plugin_in_one_file_brings_its_own_words(pulley: Path) -> None:
    words = pulley.parent / "words" / "de.toml"
    words.write_text('"Belt drive" = "Riementrieb"\n[notes]\n"pulley tension" = "Trumkraft"\n', encoding="utf-8")
    run = truing.load(pulley).run(progress=False)
    english, german = (
        run.sheet(pulley.parent / f"{name}.md", language=name).read_text("utf-8") for name in ("en", "de")
    )
    assert "# Riementrieb" in german
    assert "Trumkraft" in german
    assert "force on the shaft" in german
    assert "# Belt drive" in english
    assert "Eingaben" not in english
    assert truing.load(pulley).run(language="de", progress=False).document == run.document


@pytest.mark.parametrize(("content", "sentence"), [
    ('"Belt drive" = 3', "'Belt drive' needs a text in quotation marks"),
    ('"{a} of b" = "von b"', "'{a} of b' and 'von b' differ in their gaps"), ("=", "left out: "),
])  # fmt: skip
def test_faulty_words_of_a_plugin_are_left_out_and_named(pulley: Path, content: str, sentence: str) -> None:
    (pulley.parent / "words" / "de.toml").write_text(content, encoding="utf-8")
    words = catalogue_of(sheet_in(truing.load(pulley).setup(), language="de"))
    (fault,) = words.faults
    assert fault.startswith(f"{pulley.parent / 'words' / 'de.toml'}: these words of a sheet are left out: ")
    assert sentence in fault
    assert (words.said("Belt drive"), words.said("Inputs")) == ("Belt drive", "Eingaben")


def test_an_unknown_language_is_refused_with_the_choices(pulley: Path) -> None:
    offer = truing.load(pulley).offer
    with pytest.raises(InputError, match=r"made.toml:2: language: choose en or de\."):
        setup_from_text('[sheet]\nlanguage = "xx"\n', offer, file="made.toml", folder=pulley.parent)
    with pytest.raises(UsageError, match="language: choose en or de, not 'xx'"):
        sheet_in(truing.load(pulley).setup(), language="xx")


def test_every_place_of_words_is_a_gap_or_a_kind_of_sheet() -> None:
    for language in FOREIGN:
        places = words_in(template_folder() / "words" / f"{language}.toml")
        gaps = {gap for words in places.values() for text in words for gap in GAP.findall(text)}
        assert {*places} - gaps <= {"", COMPARISON, DIAGNOSIS, STUDY, "Added"}
        assert gaps >= LISTS
