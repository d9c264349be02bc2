"""The site of the manual: built strictly, whole, and without a word that leads a browser elsewhere."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from built_site import site  # noqa: F401
from shared import ROOT
from truing.describe import description
from truing.kernel import Kernel

DOCS = ROOT / "docs"


def pages(site: Path) -> list[Path]:  # noqa: F811
    found = sorted(site.rglob("*.html"))
    assert len(found) > 50
    return found


def test_every_page_on_disk_is_a_page_of_the_site(site: Path) -> None:  # noqa: F811
    for page in DOCS.rglob("*.md"):
        if DOCS / "site" in page.parents:
            continue
        place = page.relative_to(DOCS).with_suffix(".html")
        place = place.with_name("index.html") if place.name == "README.html" else place
        assert (site / place).is_file(), place


LOADS = [
    re.compile(r"""<(?!a\b)[^>]*\s(?:src|srcset|data|poster|action|background)\s*=\s*["']?([^"'\s>]+)"""),
    re.compile(r"""<link[^>]*\shref\s*=\s*["']?([^"'\s>]+)"""),
    re.compile(r"""url\(\s*["']?([^"')]+)|@import\s+["']?([^"';]+)"""),
]
"""What makes a browser fetch something: attributes, style sheets and icons, addresses in style sheets."""


@pytest.mark.parametrize("ending", ["html", "css", "js"])
def test_nothing_is_loaded_from_outside(site: Path, ending: str) -> None:  # noqa: F811
    files = sorted(site.rglob(f"*.{ending}"))
    assert files
    for file in files:
        if file.name == "index.js":  # the words of the search: data, no code
            continue
        text = file.read_text(encoding="utf-8")
        loads = [next(filter(None, item.groups()), "") for rule in LOADS for item in rule.finditer(text)]
        assert not [name for name in loads if re.match(r"(?:\w+:)?//", name)], file
        if ending == "js":
            assert not re.search(r"https?://|\bfetch\(|XMLHttpRequest|WebSocket|sendBeacon|\bimport\(", text), file
        if ending == "html":
            assert not re.search(r"@font-face|<base\b|http-equiv=.refresh", text), file


def test_every_link_inside_the_site_arrives(site: Path) -> None:  # noqa: F811

    for page in pages(site):
        if page.parent.parent.name == "gallery":
            continue  # a sheet: its own tests look at it
        text = page.read_text(encoding="utf-8")
        for link in re.findall(r"""<(?:a|link|script|img|iframe)\b[^>]*\s(?:href|src)=["']([^"'#]+)[^"']*["']""", text):
            if not re.match(r"\w+:", link):
                assert (page.parent / unquote(link)).resolve().is_file(), f"{page}: {link}"


def test_no_formula_is_left_as_it_was_typed(site: Path) -> None:  # noqa: F811
    for page in pages(site):
        assert "arithmatex" not in page.read_text(encoding="utf-8"), page


def test_every_page_is_in_the_navigation(site: Path) -> None:  # noqa: F811

    class Sidebar(HTMLParser):
        found: set[Path] = set()  # noqa: RUF012

        def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
            if tag == "a":
                self.found.add((site / str(dict(attributes).get("href")).partition("#")[0]).resolve())

    text = (site / "index.html").read_text(encoding="utf-8")
    reader = Sidebar()
    reader.feed(text[text.index('<nav id="sidebar"') : text.index("</nav>")])
    listed = {page for page in pages(site) if page.parent.parent.name != "gallery"}
    assert listed <= reader.found


def keys(document: Any) -> set[str]:
    """Every key of a document, at any depth."""
    if isinstance(document, dict):
        return set(document) | {key for item in document.values() for key in keys(item)}
    return {key for item in document for key in keys(item)} if isinstance(document, list) else set()


def test_the_json_of_a_study_has_the_keys_that_its_chapter_shows(site: Path) -> None:  # noqa: F811
    text = (DOCS / "reference" / "studies.md").read_text(encoding="utf-8")
    shown = re.findall(r"^## (\w+)\n.*?```json\n(.*?)```", text, re.DOTALL | re.MULTILINE)
    assert len(shown) == 8
    written = [site / "gallery" / name / "results.json" for name in ("press", "reducer")]
    known = keys([json.loads(file.read_text(encoding="utf-8")) for file in written])
    named = {"force", "wire_diameter", "pin_fit", "tolerances.pin", "pin", "wear", "shift"}  # names of the examples
    named |= {"sobol_first", "sobol_total", "price"}  # with options that no sheet of the gallery has
    named |= {"kept"}  # no limit is met there along a sweep
    named |= keys(json.loads(dict(shown)["Uncertainty"]))  # none has a budget: tests/unit/test_docs.py holds these
    named |= keys(json.loads(dict(shown)["Frequency"]))  # no model of the gallery moves: its own tests hold these
    for title, block in shown:
        assert not keys(json.loads(block)) - known - named, title


def test_every_model_has_a_page_with_all_that_it_declares(site: Path) -> None:  # noqa: F811

    effects = (site / "reference" / "effects.html").read_text(encoding="utf-8")
    for name, offer in Kernel.installed().offers.items():
        text = (site / "reference" / "models" / f"{name}.html").read_text(encoding="utf-8")
        said = description(offer)
        parts = ("inputs", "results", "tolerances", "effects", "conditions")
        missing = [item["name"] for part in parts for item in said[part] if f"<code>{item['name']}</code>" not in text]
        assert not missing, name
        for effect in said["effects"]:
            assert f'href="models/{name}.html#{effect["name"]}"' in effects
            assert f'id="{effect["name"]}"' in text
        assert text.count("<math") >= sum(bool(item["formula"]) for item in said["results"])
        ids = re.findall(r' id="([^"]+)"', text)
        assert len(ids) == len(set(ids)), name
        assert {f"input-{item['name']}" for item in said["inputs"]} <= set(ids)
        assert {f"result-{item['name']}" for item in said["results"]} <= set(ids)
        assert set(re.findall(r'href="#([^"]+)"', text)) <= {*ids, "__toc", "main"}, name
        schema = json.loads((site / "reference" / "models" / f"{name}.schema.json").read_text(encoding="utf-8"))
        assert set(schema["$defs"]["Inputs"]["properties"]) == {item["name"] for item in said["inputs"]}


def folded(text: str) -> list[tuple[str, str]]:
    """The summary of every part of a page that is folded, and what is in it."""
    return re.findall(r"<details><summary>(.*?)</summary>(.*?)</details>", text, re.DOTALL)


def test_every_formula_and_limit_of_a_model_is_on_its_page_and_folds_say_how_much_is_in_them(site: Path) -> None:  # noqa: F811
    counted = 0
    for name, offer in Kernel.installed().offers.items():
        text = (site / "reference" / "models" / f"{name}.html").read_text(encoding="utf-8")
        said = description(offer)
        rows = [row for table in re.findall(r'<table class="fields formulas">.*?</table>', text, re.DOTALL)
                for row in re.findall(r"<tbody>.*|<tr>.*?</tr>", table) if "<math" in row]  # fmt: skip
        shown = [result for row in rows for result in re.findall(r'href="#result-(\w+)"', row)]
        assert sorted(shown) == sorted(item["name"] for item in said["results"] if item["formula"]), name
        limits = "".join(re.findall(r'<table class="fields limits">.*?</table>', text, re.DOTALL))
        required = {goal["result"] for goal in said["objectives"] if goal["kind"] == "require"}
        assert required <= set(re.findall(r'href="#result-(\w+)"', limits)), name
        for summary, inside in folded(text):
            for word, mark in (("input", ' id="input-'), ("result", ' id="result-'), ("printed number", "<br><code>")):
                for count in re.findall(rf"^(\d+) {word}s?\b", summary):
                    counted += 1
                    assert inside.count(mark) == int(count), (name, summary)
            for count in re.findall(r"(\d+) formula", summary):
                listed = inside[inside.index("fields formulas") :]
                assert listed.count("<tr><td>") == int(count), (name, summary)
                counted += 1
    assert counted > 50


def test_parts_share_a_row_where_their_formulas_are_one_and_inputs_follow_the_example(site: Path) -> None:  # noqa: F811
    text = (site / "reference" / "models" / "rv_gearing.html").read_text(encoding="utf-8")
    rows = re.findall(r"<tr>.*?</tr>", text, re.DOTALL)
    assert [row for row in rows if 'id="result-base_diameter_sun"' in row and 'id="result-base_diameter_planet"' in row]
    # Z_B and Z_D are two formulas of the standard: each has its own row
    assert not [row for row in rows if row.count('id="result-single_contact_factor_') > 1]
    begin = text.index('id="inputs-how-well-it-is-made"')
    group = text[begin : text.index("<h3", begin)]
    example = Kernel.installed().offers["rv_gearing"].model.example
    assert example is not None
    paragraph = example.read_text(encoding="utf-8").partition("# How well it is made.")[2].partition("\n\n")[0]
    assert re.findall(r'id="input-(\w+)"', group) == re.findall(r"^(\w+) =", paragraph, re.MULTILINE)


def test_the_search_knows_what_is_folded(site: Path) -> None:  # noqa: F811
    words = (site / "search" / "index.js").read_text(encoding="utf-8")
    for name in ("nominal_root_stress_outer_planet", "stated_bending_life_planet", "transverse_base"):
        assert name in words
