"""Routes of picking, keeping and making: what they list, give and refuse; what is drafted from forms."""

from __future__ import annotations

import io
import json
import math
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from made_runs import HOSTILE, check, made_runs, run
from starlette.testclient import TestClient
from test_drafted import book

from shared import Calc
from truing.api.differences import differences_of_paths
from truing.errors import TruingError
from truing.kernel import offer_of
from truing.runs.comparison import Change
from truing.runs.folder import DOCUMENTS as DOCUMENTS_OF_RUNS
from truing.testing import failures
from truing.workbench import keeping
from truing.workbench.folder import DOCUMENTS, contents, program_of
from truing.workbench.guard import Key
from truing.workbench.keeping import pairs_of
from truing.workbench.server import application
from truing.workbench.tasks import task
from truing.workbench.tasks.drafts import checked, made, placeholder
from truing.workbench.tasks.kept import words_of_changes
from truing.workbench.workers import TaskError, fault_of

HOST = "127.0.0.1:8000"


class Here:
    """Does the tasks in this process: a worker process takes seconds to start."""

    def ask(self, name: str, *, patience: float = 0.0, **arguments: Any) -> Any:
        """Do a task now."""
        try:
            return json.loads(json.dumps(task(name)(**arguments)))
        except TruingError as error:
            raise TaskError([fault_of(str(error))]) from None


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    key = Key(8000)
    app = application(tmp_path, key, frozenset({HOST}), Here())  # type: ignore[arg-type]
    with TestClient(app, base_url=f"http://{HOST}") as client:
        client.get("/", params={"token": key.token})
        client.headers["origin"] = f"http://{HOST}"
        yield client


def faults(answer: Any) -> list[str]:
    """The sentences of an answer."""
    return [fault["message"] for fault in answer.json()["faults"]]


# What lies in the folder


def test_the_folder_is_told_apart_by_what_its_files_are(tmp_path: Path) -> None:
    run(tmp_path / "runs" / "press", date="2026-11-02T08:00:00+0100", head='project = "P"')
    for name, text in {
        "press.toml": 'plugin = "press"\n', "pyproject.toml": '[project]\nname = "x"\n',
        "half.toml": "plugin = 'press\n", "other.toml": "a = \n",
        "bare.toml": "[inputs]\nload = 1\n", "belt.py": "def truing_models(): ...",
        "tool.py": "print()", "rows.csv": "a\n1\n", ".hidden.toml": 'plugin = "x"\n',
    }.items():  # fmt: skip
        (tmp_path / name).write_text(text, encoding="utf-8")
    seen = contents(tmp_path)
    assert [(each.name, each.plugin, each.fault.partition(":")[0]) for each in seen.inputs] == [
        ("bare.toml", "", 'names no calculation; write plugin = "NAME" above its sections'),
        ("half.toml", "press", "is no TOML"), ("press.toml", "press", ""),
    ]  # fmt: skip
    assert (seen.programs, seen.data, seen.runs) == (("belt.py",), ("rows.csv",), ("runs/press",))
    assert tuple(document for document, _ in DOCUMENTS_OF_RUNS.values()) == DOCUMENTS


def test_a_calculation_that_is_not_installed_is_looked_for_beside_the_file() -> None:
    programs = ("a/belt.py", "belt.py", "other.py")
    assert [program_of("belt", name, programs) for name in ("x.toml", "a/x.toml", "b/x.toml")] == [
        "belt.py", "a/belt.py", "a/belt.py",
    ]  # fmt: skip
    assert (program_of("rv_wear", "x.toml", ("rv_wear.py",)), program_of("none", "x.toml", programs)) == ("", "")


def test_the_first_page_loads_no_plugin_and_asks_no_worker(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Here, "ask", None)
    answer = client.get("/")
    assert (answer.status_code, "rv_wear" in answer.text, "press_linkage" in answer.text) == (200, True, True)


def test_a_picture_is_drawn_once(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = client.post("/api/picture", json={"plugin": "rv_wear"}).json()
    assert (drawn["title"], drawn["svg"][:4]) == ("Disc, pins and crank", "<svg")
    monkeypatch.setattr(Here, "ask", None)
    assert client.post("/api/picture", json={"plugin": "rv_wear"}).json() == drawn


def test_the_server_imports_no_numpy() -> None:
    code = "import sys, truing.workbench.server; sys.exit('numpy' in sys.modules or 'pydantic' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_begun_file_never_replaces_one(client: TestClient, tmp_path: Path) -> None:
    begun = client.post("/api/begin", json={"plugin": "rv_wear", "file": "new/wear"})
    assert begun.json() == {"file": "new/wear.toml", "plugin": "rv_wear"}
    assert 'plugin = "rv_wear"' in (tmp_path / "new" / "wear.toml").read_text()
    (tmp_path / "new" / "wear.toml").write_text("mine")
    again = client.post("/api/begin", json={"plugin": "rv_wear", "file": "new/wear.toml"})
    assert (again.status_code, faults(again)) == (422, ["new/wear.toml is there already; choose another name"])
    assert (tmp_path / "new" / "wear.toml").read_text() == "mine"
    for name in ("../wear", "", " "):
        assert client.post("/api/begin", json={"plugin": "rv_wear", "file": name}).status_code == 422
    assert sorted(path.name for path in tmp_path.rglob("*.toml")) == ["wear.toml"]


# Runs


def test_hostile_texts_of_runs_are_only_text(client: TestClient, tmp_path: Path) -> None:
    made_runs(tmp_path)
    run(tmp_path / "odd", check(HOSTILE, 12.0, 10.0, -0.2), head=f"project = '''{HOSTILE[:-1]}'''")
    for answer in (client.get("/runs"), client.get("/run", params={"folder": "odd"})):
        assert answer.status_code == 200
        assert "<img src=x" not in answer.text
        assert "&lt;img src=x" in answer.text
    assert "its results.json is damaged: no JSON" in client.get("/runs").text


def test_pairs_are_runs_of_one_file_in_the_order_of_their_dates() -> None:
    newest_first = [
        {"kind": kind, "model": "press", "name": name}
        for kind, name in zip(
            ("run", "diagnosis", "run", "run", "run"),
            ("runs/a-3", "runs/a", "runs/a-2", "runs/c", "runs/a"),
            strict=True,
        )
    ]
    assert pairs_of(newest_first) == [("runs/a-2", "runs/a-3"), ("runs/a", "runs/a-2")]


def test_changes_are_named_causes_first() -> None:
    force = [{"value": value, "unit": "N"} for value in (50.0, 60.0)]
    before, after = check("tilt", 9.0, 10.0, 0.1), check("tilt", 12.0, 10.0, -0.2)
    moved = Change("results", "tilt", {"value": 9.0, "unit": "mm"}, {"value": 12.0, "unit": "mm"})
    changes = [Change("checks", "tilt", before, after), Change("inputs", "force", *force), moved]
    assert words_of_changes(changes) == "force 50 N → 60 N; tilt now FAILS"
    assert (words_of_changes([]), words_of_changes([moved])) == ("nothing", "results only")
    many = [Change("inputs", name, *force) for name in "abcde"]
    assert words_of_changes(many).endswith("c 50 N → 60 N; 2 more")


def test_a_changed_run_is_read_again(client: TestClient, tmp_path: Path) -> None:
    run(tmp_path / "press", check("tilt", 9.0, 10.0, 0.1), date="2026-11-02T08:00:00+0100")
    assert "passes" in client.get("/runs").text
    run(tmp_path / "press", check("tilt", 12.0, 10.0, -0.25), date="2026-11-03T08:00:00+0100")
    assert "−25" in client.get("/runs").text


@pytest.mark.parametrize("folder", ["", ".", "..", "nothing", "photos", "../../etc", "link"])
def test_only_folders_of_runs_are_given(client: TestClient, tmp_path: Path, folder: str) -> None:
    (tmp_path / "photos").mkdir()
    outside = tmp_path.parent / f"{tmp_path.name}-outside"
    run(outside)
    (tmp_path / "link").symlink_to(outside)
    for address in ("/run", "/api/made/zip", "/api/made/pdf", "/api/made/xlsx"):
        assert client.get(address, params={"folder": folder}).status_code == 422
    assert client.get("/compare", params={"before": folder, "after": folder}).status_code == 422


def test_a_packed_run_holds_its_own_files_and_no_link(client: TestClient, tmp_path: Path) -> None:
    run(tmp_path / "press", check("tilt", 9.0, 10.0, 0.1), date="2026-11-02T08:00:00+0100")
    (tmp_path / "secret.txt").write_text("secret")
    (tmp_path / "press" / "link.txt").symlink_to(tmp_path / "secret.txt")
    (tmp_path / "press" / ".hidden").write_text("hidden")
    answer = client.get("/api/made/zip", params={"folder": "press"})
    names = zipfile.ZipFile(io.BytesIO(answer.content)).namelist()
    assert names == ["press/results.json", "press/run.json", "press/sheet.html"]
    assert answer.headers["content-disposition"] == "attachment; filename*=UTF-8''press.zip"
    assert "link.txt" not in client.get("/run", params={"folder": "press"}).text


def test_a_copy_of_a_run_is_kept_under_the_next_number(client: TestClient, tmp_path: Path) -> None:
    run(tmp_path / "runs" / "press", check("tilt", 9.0, 10.0, 0.1), date="2026-11-02T08:00:00+0100")
    (tmp_path / "runs" / "press" / "link.txt").symlink_to(tmp_path)
    (tmp_path / "runs" / "press-1").mkdir()
    for number in (2, 3):
        answer = client.post("/api/keep", json={"folder": "runs/press"})
        assert answer.json() == {"folder": f"runs/press-{number}"}
    copies = sorted(path.name for path in (tmp_path / "runs" / "press-3").iterdir())
    assert copies == ["results.json", "run.json", "sheet.html"]
    assert client.get("/api/keep").status_code == 405
    assert client.post("/api/keep", json={"folder": "runs"}).status_code == 422


def test_a_printed_sheet_can_load_and_run_nothing(
    client: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed: list[str] = []
    monkeypatch.setattr(keeping, "pdf_bytes", lambda text: printed.append(text) or b"%PDF")
    run(tmp_path / "press", date="2026-11-02T08:00:00+0100")
    sheet = tmp_path / "press" / "sheet.html"
    sheet.write_text('<!DOCTYPE html>\n<html lang="en">\n<head><script>1</script></head>')
    answer = client.get("/api/made/pdf", params={"folder": "press"})
    assert (answer.content, answer.headers["content-type"]) == (b"%PDF", "application/pdf")
    assert printed[0].index("default-src 'none'") < printed[0].index("<script>")
    sheet.write_text("<script>1</script><!DOCTYPE html><html><head>")
    assert client.get("/api/made/pdf", params={"folder": "press"}).status_code == 422
    outside = tmp_path.parent / f"{tmp_path.name}.html"
    outside.write_text("<!DOCTYPE html><html><head>")
    sheet.unlink()
    sheet.symlink_to(outside)
    assert client.get("/api/made/pdf", params={"folder": "press"}).status_code == 422
    assert len(printed) == 1


def test_a_document_that_names_a_file_makes_none_run(tmp_path: Path) -> None:
    """Two folders that came from elsewhere are compared; the program that they name as their model does not run."""
    program = tmp_path / "evil.py"
    program.write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n")
    for name in ("one", "two"):
        run(tmp_path / name, plugin={"name": "press", "version": "1", "model": str(program)})
    differences = differences_of_paths(tmp_path / "one", tmp_path / "two", lambda *_: pytest.fail("nothing runs"))
    assert [side.model for side in differences.sides("en")] == [None, None]
    with pytest.raises(TruingError, match="names a file"):
        task("kept.workbook")(folder=str(tmp_path / "one"))
    assert not (tmp_path / "ran").exists()


# A calculation of one's own


def row(name: str, unit: str = "", **more: str) -> dict[str, str]:
    """A row of the form."""
    return {"name": name, "unit": unit, **more}


GOOD = {
    "name": "pin_pressure", "title": "Pressure 'of' a \"pin\"",
    "inputs": [
        row("load", "N", default="1.2 kN", symbol="F", lower="0", note="normal load"), row(""),
        row("area", "mm^2", default="20", lower="> 0", upper="1000"), row("angle", "deg", default="30", lower="> 0"),
        row("strength", "MPa", default="75", lower="> 0"),
    ],
    "results": [
        row("share", "%", formula="pressure / limit"),
        row("limit", "MPa", formula="cases(2 * strength, angle > 0.1 and 0 < 1 < 2, strength)"),
        row("pressure", "MPa", formula="load / area", symbol="p"),
        row("odd", formula="cot(angle) + inv(angle) + atan2(1, angle) + max(angle, 1, 2) - min(1, angle)"
            " + either(angle, 1) + hypot(3, 4) + asin(sin(angle)) + log10(10) + abs(-pi)"),
    ],
}  # fmt: skip
"""Every kind of function that a formula may have here; results out of order; bounds with 0 and without."""


def test_what_is_made_is_calculated_as_by_hand_and_keeps_the_kit(tmp_path: Path) -> None:
    """1200 N on 20 mm^2 are 60 MPa, 40 % of twice 75 MPa; the last result by Python's own functions of numbers."""
    said = checked(GOOD, str(tmp_path))
    assert said["faults"] == {}
    x = math.pi / 6
    odd = 1 / math.tan(x) + math.tan(x) - x + math.atan2(1, x) + 2 - x + x + 5 + x + 1 + math.pi
    expected = {"results.2": "60 MPa", "results.1": "150 MPa", "results.0": "40 %", "results.3": f"{odd:.5g}"}
    assert said["values"] == expected
    assert made(GOOD, str(tmp_path)) == {"file": "pin_pressure.py"}
    model = offer_of(str(tmp_path / "pin_pressure.py"), lambda _: None).model
    assert failures(model) == {}
    assert model.input_fields["load"].symbol == "F"


def test_all_faults_of_a_form_are_said_at_once_beside_their_fields(tmp_path: Path) -> None:
    (tmp_path / "taken.py").write_text("")
    form = {
        "name": "taken", "title": "x" * 90,
        "inputs": [row("F", "Nn", default="a"), row("force", "N", default="3 mm", note="a\nb"), row("sin", default="1"),
                   row("b", "mm", default="1", lower="> 1", upper="0"), row("b", "mm", default="")],
        "results": [row("area", "mm", formula="b * b"), row("c", formula="bb + 1"), row("d", formula="e"),
                    row("e", formula="d"), row("f", formula="__import__('os')"), row("g", formula="sum(b)"),
                    row("h", formula="b +"), row("i", formula="1 / (b - b)", unit="1/mm"), row("j", formula="x == y")],
    }  # fmt: skip
    said = checked(form, str(tmp_path))["faults"]
    wanted = {
        "name": "taken.py is in the folder", "title": "the title is too long", "inputs.0.name": "'F' is no name",
        "inputs.0.unit": "unknown unit 'Nn'", "inputs.1.default": "'3 mm' is a length (mm), expected a force (N)",
        "inputs.1.note": "a note is one line", "inputs.2.name": "'sin' has another meaning",
        "inputs.3.lower": "the default is at this bound", "inputs.3.upper": "the default is above this bound",
        "inputs.4.name": "'b' is used twice", "results.0.unit": "the formula gives an area, not a length",
        "results.1.formula": "there is no input and no result 'bb'. Did you mean 'b'?", "results.2.formula": "needs e,",
        "results.3.formula": "needs d,", "results.4.formula": "the character", "results.5.formula": "sum is not",
        "results.6.formula": "it cannot be read", "results.7.formula": "gives no finite number",
        "results.8.formula": "an equation is no formula",
    }  # fmt: skip
    assert {path: said[path][: len(text)] for path, text in wanted.items()} == wanted
    assert said.keys() == wanted.keys()
    assert made(form, str(tmp_path))["faults"].keys() == wanted.keys()
    assert [path.name for path in tmp_path.iterdir()] == ["taken.py"]


def test_a_bound_without_an_answer_is_a_fault(tmp_path: Path) -> None:
    inputs = [row("load", "N", default="1"), row("area", "mm^2", default="2", lower="0")]
    results = [row("pressure", "MPa", formula="load / area")]
    form = {"name": "bound", "title": "", "inputs": inputs, "results": results}
    assert checked(form, str(tmp_path))["faults"] == {
        "inputs.1.lower": "pressure is not finite at this bound; write > to leave it out"
    }


def test_the_placeholder_is_that_of_calc_new(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    for kind, words in (("single", ["--single-file"]), ("project", [])):
        assert calc("new", f"own_{kind}", *words).code == 0
        placeholder({"name": f"own_{kind}x", "title": f"Own {kind}"}, str(tmp_path / "here"), kind)
    files = {path.relative_to(tmp_path / "here"): path for path in (tmp_path / "here").rglob("*") if path.is_file()}
    files = {name: path for name, path in files.items() if "__pycache__" not in name.parts}
    assert len(files) == 10
    for name, path in files.items():
        beside = tmp_path / str(name).replace("projectx", "project").replace("singlex", "single")
        text = (
            path.read_text(encoding="utf-8").replace("own_projectx", "own_project").replace("own_singlex", "own_single")
        )
        assert text.replace("own-projectx", "own-project") == beside.read_text(encoding="utf-8"), name


def test_a_workbook_is_drafted_and_written(client: TestClient, tmp_path: Path) -> None:
    book(tmp_path / "pin.xlsx", [("Force", 120, "N"), ("Area", 30, "mm^2"), ("Pressure", "=B1/B2", "MPa", None, 4.0)])
    about = {"form": {"name": "from_book", "title": ""}, "book": "pin.xlsx", "place": ""}
    drafted = client.post("/api/new/draft", json=about).json()
    assert (drafted["inputs"], drafted["results"], drafted["said"]) == (2, 1, [])
    assert not (tmp_path / "from_book.py").exists()
    made_here = client.post("/api/new/make", json={**about, "kind": "workbook"}).json()
    assert made_here["file"] == "from_book.py"
    assert (tmp_path / "from_book.py").read_text(encoding="utf-8") == drafted["text"]
    said = client.post("/api/program", json={"file": "from_book.py"})
    assert (said.status_code, said.json()["title"]) == (200, "From book")  # made here, so it needs no confirming
    for place in ("../x", "a#b", "Sheet9"):
        assert client.post("/api/new/draft", json={**about, "place": place}).status_code == 422


def test_a_workbook_whose_values_were_never_stored_is_refused(client: TestClient, tmp_path: Path) -> None:
    book(tmp_path / "pin.xlsx", [("Force", 120, "N"), ("Twice", "=2*B1", "N")])
    about = {"form": {"name": "never_stored", "title": ""}, "book": "pin.xlsx", "place": "", "kind": "workbook"}
    answer = client.post("/api/new/make", json=about)
    assert "never stored" in faults(answer)[0]
    assert str(tmp_path) not in answer.text
    assert not (tmp_path / "never_stored.py").exists()
