"""How soon do numbers follow a keystroke: in a browser, for every shipped calculation, beside the call of the model.

Run it: ``python -m pytest tests/benchmarks/bench_workbench.py -s``. A key is pressed in a field of the form; the time
counts until the numbers of that very text stand on the page. Keys follow one another as typed, so that figure, sliders
and curves of the key before may be on their way. The median of the presses is compared with the bare call of the model
plus a stated overhead: two calls of the server, reading the text, printing the sheet, laying it out.
"""

import statistics
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from one_browser import browser, chromium  # noqa: F401
from truing.evaluate import answered
from truing.example_file import text_to_fill_in
from truing.inputs_file import setup_from_text
from truing.kernel import Kernel
from workbench_browser import Workbench, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser

OVERHEAD = 0.1
"""Seconds that everything but the model may take."""
WANTED = 0.3
"""Seconds that a keystroke may take, on a machine that does nothing else."""
PRESSES, PAUSE, CALLS, ENOUGH = 15, 0.2, 5, 0.3
SHIPPED = [*Kernel.installed().offers]
PRESS = """([field, value]) => new Promise((done) => {
    const input = document.querySelector(`.field[data-path*='"${field}"'] input`), started = performance.now();
    let asked = '';
    const answered = (event) => { asked = event.detail.text; };
    const shown = (event) => {
        if (!asked || event.detail.text !== asked) return;
        document.removeEventListener('truing:state', answered);
        document.removeEventListener('truing:shown', shown);
        requestAnimationFrame(() => done([performance.now() - started, event.detail.failed]));
    };
    document.addEventListener('truing:state', answered);
    document.addEventListener('truing:shown', shown);
    input.value = value;
    input.dispatchEvent(new Event('input', { bubbles: true }));
})"""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    folder = tmp_path_factory.mktemp("shipped")
    for name, offer in Kernel.installed().offers.items():
        (folder / f"{name}.toml").write_text(text_to_fill_in(offer), encoding="utf-8")
        example = offer.model.example
        for data in Path(example).parent.glob("*") if example is not None else ():
            if data.suffix in {".csv", ".txt", ".npy"}:
                (folder / data.name).write_bytes(data.read_bytes())
    with serving(folder) as served:
        yield served


def bare_call(name: str, folder: Path) -> tuple[float, float]:
    """Return the median time of the model alone, s, and how many times longer it took than the processor worked."""
    text = (folder / f"{name}.toml").read_text(encoding="utf-8")
    offer = Kernel.installed().offer(name)
    setup = replace(setup_from_text(text, offer, file=f"{name}.toml", folder=folder), studies=())
    seconds: list[float] = []
    worked, all_of_them = time.process_time(), time.perf_counter()
    while len(seconds) < CALLS or sum(seconds) < ENOUGH:
        start = time.perf_counter()
        answered(setup)
        seconds.append(time.perf_counter() - start)
    busy = (time.perf_counter() - all_of_them) / (time.process_time() - worked)
    return statistics.median(seconds), max(1.0, busy)


def presses(page: Any, name: str) -> list[float]:
    """Press keys in the field of the input that matters most, and return the seconds until numbers are there."""
    page.locator(".see-slider").first.wait_for(timeout=30_000)
    page.wait_for_timeout(2000)
    slider = page.locator(".see-slider input").first
    field = slider.get_attribute("id").removeprefix("see-slider-")
    value, step = float(slider.input_value()), float(slider.get_attribute("step"))
    unit = page.locator(".see-slider output").first.inner_text().partition(" ")[2]
    seconds = []
    for press in range(PRESSES):
        took, failed = page.evaluate(PRESS, [field, f"{value + (press % 3) * step:.12g} {unit}".strip()])
        assert not failed, f"{name}: {failed}"
        seconds.append(took / 1000)
        page.wait_for_timeout(1000 * PAUSE)
    return seconds


@pytest.mark.parametrize("name", SHIPPED)
def test_numbers_follow_a_keystroke(name: str, bench: Workbench, browser: "Browser") -> None:  # noqa: F811
    page = bench.page(browser)
    page.goto(f"{bench.address}edit?file={name}.toml")
    before, seconds, after = bare_call(name, bench.folder), presses(page, name), bare_call(name, bench.folder)
    bare, busy = min(before[0], after[0]), max(before[1], after[1])
    page.context.close()
    median = statistics.median(seconds)
    print(
        f"\n{name}: {1000 * median:.0f} ms (largest {1000 * max(seconds):.0f} ms), model alone {1000 * bare:.1f} ms, "
        f"ratio to model and {1000 * OVERHEAD:.0f} ms overhead {median / (bare + OVERHEAD):.2f}; "
        f"the machine was {busy:.1f} times as busy as it can be alone"
    )
    assert median <= WANTED * busy
