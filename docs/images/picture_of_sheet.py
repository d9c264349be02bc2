"""Make sheet.png, the picture in the README: ``python docs/images/picture_of_sheet.py runs/example/sheet.html``.

The head of a sheet of the press linkage down to its verdict, then the chapter of the mechanism and what follows it.
Needs a Chromium and the project's test extra.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path
from typing import Any

WIDTH = 1000
ABOVE_A_CHAPTER = 24
AFTER_THE_MECHANISM = 360
GREY = (160, 160, 160)


def photographed(sheet: Path) -> tuple[Any, dict[str, float]]:
    """Return the whole sheet as a picture, and where its chapters and its verdict's end are."""
    from PIL import Image
    from playwright.sync_api import sync_playwright

    from truing.report.pdf import find_browser, sandbox_arguments

    where = "[...document.querySelectorAll('h2')].map(h => [h.innerText, h.getBoundingClientRect().top])"
    with sync_playwright() as player:
        browser = player.chromium.launch(executable_path=str(find_browser()), args=sandbox_arguments())
        page = browser.new_page(viewport={"width": WIDTH, "height": 1200})
        page.goto(sheet.resolve().as_uri())
        places = {" ".join(title.split()[1:]): top for title, top in page.evaluate(where)}
        contents = page.locator("nav").first
        box = contents.bounding_box() if contents.count() else None
        places["end of head"] = box["y"] if box else places["Checks"]
        picture = Image.open(BytesIO(page.screenshot(full_page=True))).convert("RGB")
        browser.close()
    return picture, places


def composed(picture: Any, places: dict[str, float]) -> Any:
    """Put the head above the mechanism, with a dashed line between them."""
    from PIL import Image, ImageDraw

    head = picture.crop((0, 0, WIDTH, int(places["end of head"])))
    top = int(places["Mechanism and slider"]) - ABOVE_A_CHAPTER
    end = int(places["Dead centres and stroke"]) - ABOVE_A_CHAPTER + AFTER_THE_MECHANISM
    body = picture.crop((0, top, WIDTH, end))
    whole = Image.new("RGB", (WIDTH, head.height + ABOVE_A_CHAPTER + body.height), "white")
    whole.paste(head, (0, 0))
    whole.paste(body, (0, head.height + ABOVE_A_CHAPTER))
    pen = ImageDraw.Draw(whole)
    line = head.height + ABOVE_A_CHAPTER // 2
    for x in range(28, WIDTH - 28, 12):
        pen.line((x, line, x + 5, line), fill=GREY)
    pen.rectangle((0, 0, whole.width - 1, whole.height - 1), outline=GREY)
    return whole.quantize(128, dither=Image.Dither.NONE)


if __name__ == "__main__":
    target = Path(__file__).with_name("sheet.png")
    composed(*photographed(Path(sys.argv[1]))).save(target, optimize=True)
