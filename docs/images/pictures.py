"""Make the pictures of the README: ``python docs/images/pictures.py runs/example/sheet.html runs/measured/sheet.html``.

Of a sheet of the press linkage its head down to the verdict, then the chapter of the mechanism and what follows it; of
a diagnosis its head down to the verdict, then the figures of the first result. Both are as wide and as high. Needs a
Chromium and the project's test extra.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw
from playwright.sync_api import sync_playwright

from truing.report.pdf import find_browser, sandbox_arguments

WIDTH, HEIGHT = 1000, 1300
GAP = 24
GREY = (160, 160, 160)
FIRST_CHAPTER = "[...document.querySelectorAll('h2')][0].getBoundingClientRect().top"
CHAPTERS = "[...document.querySelectorAll('h2')].map(h => [h.innerText, h.getBoundingClientRect().top])"
FIGURES = "[...document.querySelectorAll('figure, img, svg')].map(f => f.getBoundingClientRect().top)"


def photographed(sheet: Path) -> tuple[Any, float, dict[str, float], float]:
    """Return the whole sheet as a picture, and where its head ends, its chapters and its first figure begin."""
    with sync_playwright() as player:
        browser = player.chromium.launch(executable_path=str(find_browser()), args=sandbox_arguments())
        page = browser.new_page(viewport={"width": WIDTH, "height": 1200})
        page.goto(sheet.resolve().as_uri())
        contents = page.locator("nav").first
        box = contents.bounding_box() if contents.count() else None
        head = box["y"] if box else page.evaluate(FIRST_CHAPTER) - GAP
        chapters = {" ".join(title.split()[1:]): top for title, top in page.evaluate(CHAPTERS)}
        figure = min(top for top in page.evaluate(FIGURES) if top > head)
        picture = Image.open(BytesIO(page.screenshot(full_page=True))).convert("RGB")
        browser.close()
    return picture, head, chapters, figure


def composed(picture: Any, head: float, begin: float) -> Any:
    """Put the head above what begins further down, with a dashed line between them."""
    above = picture.crop((0, 0, WIDTH, int(head)))
    room = HEIGHT - above.height - GAP
    below = picture.crop((0, int(begin) - GAP, WIDTH, int(begin) - GAP + room))
    whole = Image.new("RGB", (WIDTH, HEIGHT), "white")
    whole.paste(above, (0, 0))
    whole.paste(below, (0, above.height + GAP))
    pen = ImageDraw.Draw(whole)
    line = above.height + GAP // 2
    for x in range(28, WIDTH - 28, 12):
        pen.line((x, line, x + 5, line), fill=GREY)
    pen.rectangle((0, 0, WIDTH - 1, HEIGHT - 1), outline=GREY)
    return whole.quantize(128, dither=Image.Dither.NONE)


def main(sheet: Path, diagnosis: Path) -> None:
    """Write sheet.png and diagnosis.png beside this file."""
    picture, head, chapters, _ = photographed(sheet)
    composed(picture, head, chapters["Mechanism and slider"]).save(Path(__file__).with_name("sheet.png"), optimize=True)
    picture, head, _, figure = photographed(diagnosis)
    composed(picture, head, figure).save(Path(__file__).with_name("diagnosis.png"), optimize=True)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
