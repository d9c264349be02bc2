"""What the workbench shows of a text: numbers by the printers of the sheet, sliders, curves, runs beside it.

The pin's numbers are those of its closed forms: pressure = load / area, depth = rate * pressure * distance / hardness.
"""

from __future__ import annotations

import html
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from starlette.applications import Starlette
from starlette.testclient import TestClient

from truing.errors import InputError, UsageError
from truing.workbench import seeing
from truing.workbench.bench import Bench
from truing.workbench.tasks import figures, results, runs, task
from truing.workbench.workers import Job, TaskError, fault_of

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
TEXT = """\
plugin = "pin_wear"  # which calculation

[inputs]
load = "120 N"

[studies]
run = []
"""


def about(text: str, folder: Path) -> dict[str, str]:
    """What every task is told of a text."""
    return {"plugin": str(PIN), "file": "pin.toml", "folder": str(folder), "text": text}


def shown(markup: str) -> str:
    """The words of markup on one line."""
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", markup)).split())


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the run of the text, at runs/pin."""
    folder = tmp_path_factory.mktemp("folder")
    (folder / "pin.toml").write_text(TEXT, encoding="utf-8")
    runs.run(str(PIN), str(folder / "pin.toml"), str(folder / "runs" / "pin"), str(folder), lambda *_: None)
    return folder


# Numbers


def test_numbers_are_those_of_the_text_by_section_with_their_units(tmp_path: Path) -> None:
    live = results.numbers(**about(TEXT.replace("120 N", "0.24 kN"), tmp_path))
    words = shown(live["html"])
    assert f"contact pressure pressure {240 / 28:.5g}" in words  # N / mm^2 = MPa
    assert "sliding distance distance 360 km" in words  # 0.5 m/s for 200 h
    assert f"worn depth depth {3e-8 * 240 / 28 / 2100 * 360e3 * 1e6:.5g} µm" in words
    assert re.findall(r'data-title="([^"]*)"><summary', live["html"]) == ["Contact", "Wear", "Further results"]
    assert live["headline"] == "Undecided"
    assert "reliability would" in words


def test_what_a_run_of_the_same_inputs_has_decided_stands_on_top(tmp_path: Path) -> None:
    text, last = TEXT.replace("run = []", 'run = ["reliability"]'), tmp_path / "runs" / "pin"
    (tmp_path / "pin.toml").write_text(text, encoding="utf-8")
    runs.run(str(PIN), str(tmp_path / "pin.toml"), str(last), str(tmp_path), lambda *_: None)
    (check,) = runs.load_either(last)["checks"]
    assert check["undecided"] == ""  # the run has decided what the text alone leaves open
    live = results.numbers(**about(text, tmp_path), last=str(last))
    words = shown(live["html"])
    assert live["headline"] == {"passes": "Passes", "fails": "Fails"}[check["state"]]
    assert f"{100 * check['value']:.5g} %" in words
    assert "The last run, of these inputs, has decided it." in words
    for other, run in ((text.replace("120 N", "121 N"), last), (text, tmp_path / "runs" / "none"), (text, "")):
        assert results.numbers(**about(other, tmp_path), last=str(run))["headline"] == "Undecided"


def test_numbers_say_what_a_text_gets_wrong_and_what_is_impossible(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a length"):
        results.numbers(**about(TEXT.replace("120 N", "120 mm"), tmp_path))
    with pytest.raises(InputError, match=r"pin\.toml:4: the contact flows"):
        results.numbers(**about(TEXT.replace("120 N", "60 kN"), tmp_path))  # 2.1 GPa on 28 mm^2 carry 58.8 kN


def test_what_differs_from_a_saved_run_is_marked_with_its_value_before(ran: Path) -> None:
    beside = {"run": str(ran / "runs" / "pin"), "called": "runs/pin"}
    assert results.numbers(**about(TEXT, ran), **beside)["changed"] == 0
    live = results.numbers(**about(TEXT.replace("120 N", "150 N"), ran), **beside)
    rows = {re.search(r"<code>(.*?)</code>", row)[1]: shown(row)  # type: ignore[index]
            for row in re.findall(r'<tr class="changed">.*?</tr>', live["html"], re.DOTALL)}  # fmt: skip
    assert live["changed"] == len(rows) == 3  # pressure, depth, and the price of a band of 3 %
    assert f"was {120 / 28:.5g} (+25 %)" in rows["pressure"]
    assert "(+25 %)" in rows["depth"]
    assert "load: 120 N → 150 N (+25 %)" in shown(live["html"])


# Sliders and curves


def test_sliders_are_the_inputs_that_move_limits_and_keys_most_to_first_order(tmp_path: Path) -> None:
    answer = results.sliders(**about(TEXT, tmp_path))
    inputs = {each["name"]: each for each in answer["inputs"]}
    assert answer["most"][0] == "load"  # the limit is on the pressure alone, which hardness does not touch
    assert inputs["load"]["why"] == "its scatter moves pressure by 0.16 %"  # 3 % of 120 N on 28 mm^2, of 80 MPa
    assert (inputs["load"]["low"], inputs["load"]["high"], inputs["load"]["unit"]) == (50, 200, "N")  # Vary
    assert inputs["area"]["why"] == "1 % of it moves pressure by 0.054 %"  # of 80 MPa
    assert (inputs["area"]["low"], inputs["area"]["value"], inputs["area"]["high"]) == (21, 28, 35)
    assert "hardness" not in answer["most"]
    assert inputs["hardness"]["value"] == 2.1
    assert [each["value"] for each in results.sliders(**about(TEXT.replace("120 N", "150 N"), tmp_path), ranked=False)[
        "inputs"] if each["name"] == "load"] == [150]  # fmt: skip


def test_a_curve_has_its_limit_and_says_where_it_is_met(tmp_path: Path) -> None:
    answer = figures.sweep(**about(TEXT, tmp_path), over="load", low="1 kN", high="4000 N")
    assert answer["svg"].startswith("<svg")
    assert answer["said"] == ["pressure ≤ 80 MPa: met at 2240 N, kept below it"]  # 80 MPa on 28 mm^2
    moved = figures.sweep(**about(TEXT, tmp_path), over="speed", low="0.1 m/s", high="1 m/s")
    assert moved["svg"]
    assert moved["said"] == []
    with pytest.raises(UsageError, match="backwards"):
        figures.sweep(**about(TEXT, tmp_path), over="load", low="4 kN", high="1 kN")


def test_the_figure_of_page_one_is_drawn_and_a_model_without_one_has_none(tmp_path: Path) -> None:
    press = {"plugin": "press_linkage", "file": "press.toml", "folder": str(tmp_path), "text": ""}
    assert figures.first(**press)["svg"].startswith("<svg")
    assert figures.first(**about(TEXT, tmp_path)) == {"svg": "", "caption": ""}


# Runs beside the text


def test_a_run_is_older_where_the_text_states_something_else_and_not_where_it_was_written_otherwise(ran: Path) -> None:
    def last(text: str) -> Any:
        return runs.last(**about(text, ran), run=str(ran / "runs" / "pin"), root=str(ran))

    same = last("# a note\n" + TEXT.replace("120 N", "0.12 kN"))
    assert (same["older"], same["differences"], same["run"]["name"]) == (False, [], "runs/pin")
    assert [each["name"] for each in same["runs"]] == ["runs/pin"]
    other = last(TEXT.replace("120 N", "130 N") + '\n[tolerances]\nhardness = "off"\n')
    assert other["older"]
    assert other["differences"][0] == "load: 120 N → 130 N"
    assert any(text.startswith("tolerances.hardness: ") for text in other["differences"])
    assert last(TEXT + "load = ")["differences"] == ["the text cannot be read as it stands"]
    assert runs.last(**about(TEXT, ran), run=str(ran / "runs" / "none"), root=str(ran))["run"] is None


def test_a_chapter_of_a_run_is_a_page_of_its_own(ran: Path) -> None:
    last = runs.last(**about(TEXT, ran), run=str(ran / "runs" / "pin"), root=str(ran))
    titles = {each["title"]: each["ident"] for each in last["chapters"]}
    page = runs.chapter(str(ran / "runs" / "pin"), titles["Wear"])
    assert page.startswith("<!DOCTYPE html>")
    assert "default-src 'none'" in page
    assert "worn depth" in page
    assert "contact pressure" not in page
    with pytest.raises(UsageError, match="no chapter"):
        runs.chapter(str(ran / "runs" / "pin"), "../../x")


def test_the_calculation_of_a_file_is_that_of_the_file_as_it_is_now(tmp_path: Path) -> None:
    file = tmp_path / "own_pin.py"
    shutil.copy(PIN, file)
    asked = {**about(TEXT, tmp_path), "plugin": str(file)}
    assert results.numbers(**asked)["changed"] is None
    file.write_text(PIN.read_text(encoding="utf-8").replace("contact pressure", "mean pressure"), encoding="utf-8")
    assert "mean pressure" in results.numbers(**asked)["html"]


# The calls of the page


class Here:
    """Workers that do a task in this process."""

    closed = False

    def __init__(self) -> None:
        self.jobs: dict[str, Job] = {}
        self.begun: list[dict[str, Any]] = []

    def ask(self, name: str, *, patience: float, **arguments: Any) -> Any:
        """Do a task; what it raises is its faults."""
        try:
            return task(name)(**arguments)
        except (InputError, UsageError) as error:
            raise TaskError([fault_of(str(error))]) from None

    def start(self, name: str, title: str, about: str, **arguments: Any) -> Job:
        """Only remember what was begun."""
        self.begun.append(arguments)
        return Job(name, title, about)


def test_calls_answer_faults_of_a_text_as_answers_and_keep_to_the_folder(ran: Path) -> None:
    app, workers = Starlette(routes=seeing.ROUTES), Here()
    app.state.bench = bench = Bench(ran, workers)  # type: ignore[arg-type]
    shutil.copy2(PIN, ran / "pin_wear.py")  # with its time: it is no newer than the run
    bench.confirmed.add(str(ran / "pin_wear.py"))
    client = TestClient(app)
    body = {"file": "pin.toml", "plugin": "pin_wear.py", "text": TEXT}
    assert client.post("/api/numbers", json={**body, "run": "runs/pin"}).json()["changed"] == 0
    faulty = client.post("/api/numbers", json={**body, "text": TEXT.replace("N", "mm")})
    assert faulty.status_code == 200
    assert "expected a force" in faulty.json()["faults"][0]["message"]
    with pytest.raises(UsageError, match="outside"):
        client.post("/api/numbers", json={**body, "run": "../elsewhere"})
    assert client.post("/api/sliders", json=body).json()["most"][0] == "load"
    assert client.post("/api/sweep", json={**body, "over": "load", "low": "x", "high": "1 N"}).json()["faults"]
    assert "<svg" not in client.post("/api/figure", json=body).json()["svg"]
    assert client.post("/api/whole", json=body).json()["html"].startswith("<!DOCTYPE html>")
    assert client.post("/api/last", json=body).json()["older"] is False
    ident = client.post("/api/last", json=body).json()["chapters"][0]["ident"]
    assert "chapter" in client.post("/api/chapter", json={"run": "runs/pin", "ident": ident}).json()["html"]
    client.post("/api/run", json=body)
    assert [begun["output"] for begun in workers.begun] == [str(ran / "runs" / "pin")]
    style = client.get("/sheet.css").text
    assert ":host {" in style
    assert not re.search(r"^\s*(:root|body|html) \{", style, re.MULTILINE)
