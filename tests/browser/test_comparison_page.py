"""Two runs as a page: figures side by side on a wide screen, one below the other on a phone, nothing cut."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import truing

SPRING = Path(__file__).parents[2] / "docs" / "examples" / "coil_spring.py"


def test_figures_stand_side_by_side_and_on_a_phone_below_one_another(browser: Any, tmp_path: Path) -> None:
    spring = truing.load(SPRING).given(set={"studies.run": "[]"})
    before, after = spring.run(progress=False), spring.run(coil_diameter="7.5 mm", progress=False)
    file = after.compare(before).sheet(tmp_path / "page.html")
    page = browser.new_page(viewport={"width": 1200, "height": 900})
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.goto(file.as_uri())
    boxes = "[...document.querySelector('.pair').querySelectorAll('img')].map(i => i.getBoundingClientRect().toJSON())"
    left, right = page.evaluate(boxes)
    assert left["top"] == right["top"]
    assert left["right"] < right["left"]
    assert min(left["width"], right["width"]) > 300
    folded = page.locator("section#unchanged table").first
    assert not folded.is_visible()
    page.click("section#unchanged summary")
    assert folded.is_visible()
    page.set_viewport_size({"width": 390, "height": 900})
    upper, lower = page.evaluate(boxes)
    assert upper["bottom"] < lower["top"]
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert said == []
    page.close()
