"""The manual is run: every file it asks for is written, every command is typed, and the output shown is compared."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from read_in_docs import why_not
from shown_in_docs import (
    EXAMPLES,
    ROOT,
    blocks,
    check_page,
    commands,
    desk_in,
    grown,
    matches,
    missing_data,
    refreshed,
    takes_long,
)

TUTORIAL = ROOT / "docs" / "tutorial" / "first_calculation.md"
EVERY = sorted([*(ROOT / "docs").rglob("*.md"), *ROOT.glob("*.md")])
ELSEWHERE = {ROOT / "README.md": "test_readme.py", ROOT / "docs" / "reference" / "python.md": "test_api.py"}
PAGES = [page for page in EVERY if page not in ELSEWHERE]
PAGES = [page for page in PAGES if any(not block.mark.startswith("not run") for block in blocks(page))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_does_what_it_shows(page: Path, page_done: Callable[[Path], Path], full_torture: bool) -> None:
    if why := missing_data(page):
        pytest.skip(why)
    if not full_torture and (why := takes_long(page)):
        pytest.skip(f"{why}; at full size only")
    faults = json.loads((page_done(page) / "faults.json").read_text(encoding="utf-8"))
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("page", EVERY, ids=lambda page: str(page.relative_to(ROOT)))
def test_nothing_on_a_page_is_left_unread(page: Path) -> None:
    unread = [f"{page.name}:{block.line}: {why}" for block in blocks(page) if (why := why_not(block))]
    assert not unread, "\n".join(unread)
    text = page.read_text(encoding="utf-8")
    fences = sum(line.lstrip().startswith(("```", "~~~")) for line in text.splitlines())
    assert fences == 2 * sum(1 for _ in blocks(page)), "a fence that is indented, or that no other one closes"


def test_the_tutorial_is_among_the_pages_and_runs_every_verb_it_teaches() -> None:
    assert TUTORIAL in PAGES
    typed = [command.words for block in blocks(TUTORIAL) if block.kind == "console" for command in commands(block)]
    assert {words.split()[1] for words in typed if words.startswith("calc")} == {
        "run", "init", "compare", "verify", "plugins",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("page", "name", "shipped"),
    [
        (TUTORIAL, "coil_spring.py", EXAMPLES / "coil_spring.py"),
        (TUTORIAL.parent / "from_your_spreadsheet.md", "bracket.py", EXAMPLES / "bracket" / "bracket.py"),
    ],
)
def test_the_tutorial_ends_with_the_file_that_is_shipped(page: Path, name: str, shipped: Path) -> None:
    text = ""
    for block in blocks(page):
        if block.marked("file") == name:
            text = block.text
        elif block.marked("changes") == name:
            text = grown(text, block.text)
    assert by_statement(text) == by_statement(shipped.read_text(encoding="utf-8"))


def by_statement(text: str) -> list[str]:
    """The statements of a file without their layout and order."""
    return sorted(ast.dump(statement) for statement in ast.parse(text).body)


@pytest.mark.parametrize(
    ("shown", "said", "same"),
    [
        ("rate  2.4933  N/mm\n", "rate  2.4933  N/mm\n", True),
        ("rate  2.4934  N/mm\n", "rate  2.4933  N/mm\n", False),
        ("first\n...\nlast\n", "first\nlast\n", True),
        ("first\n...\nlast\n", "first\none\ntwo\nlast\n", True),
        ("first\n...\nlast\n", "first\none\nlast\nmore\n", False),
        ("took ... s\n", "took 1.25 s\n", True),
        ("took ... s\n", "took 1.25 s\nlonger\n", False),
        ("", "something\n", False),
    ],
)
def test_output_is_compared_line_by_line(shown: str, said: str, same: bool) -> None:
    assert matches(shown, said) is same


@pytest.mark.parametrize(
    ("shown", "said", "fresh"),
    [
        ("rate 1 mm\n", "rate 2 mm\nforce 3 N\n", "rate 2 mm\nforce 3 N\n"),
        ("...\nrate 1 mm\n...\n", "first\nrate 2 mm\nforce 3 N\n", "...\nrate 2 mm\n...\n"),
        ("rate 1 mm\n...\nrate 5 mm\n", "rate 2 mm\nforce 3 N\nrate 6 mm\n", "rate 2 mm\n...\nrate 6 mm\n"),
        ("took ... s\nrate 1 mm\n", "took 3 s\nrate 2 mm\n", "took ... s\nrate 2 mm\n"),
        ("a 1\nb 1 ...\nz 1\n", "a 2\nb 1 long\nnew\nz 2\n", "a 2\nb 1 ...\nnew\nz 2\n"),
        ("...\nend of it\n", "first\nend of it all\n", "...\nend of it all\n"),
    ],
)
def test_what_a_page_shows_is_written_anew(shown: str, said: str, fresh: str) -> None:
    assert refreshed(shown, said) == fresh
    assert matches(fresh, said)


def test_a_step_replaces_what_has_its_name_and_puts_the_rest_above_the_model() -> None:
    before = '"""Words."""\n\nfrom truing import Model\n\nM = Model(a=1)\n\n\ndef hook():\n    return [M]\n'
    step = "from truing import Model, given\n\nimport math\n\nPI = math.pi\n\nM = Model(a=2)\n"
    assert grown(before, step).split("\n\n") == [
        '"""Words."""', "from truing import Model, given", "import math", "PI = math.pi", "M = Model(a=2)",
        "def hook():\n    return [M]\n",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("block", "fault"),
    [
        ("```console\n$ calc plugins --names\nno_such_plugin\n```\n", "page.md:1: 'calc plugins --names' prints\n"),
        ("```console\n$ calc init no_such_plugin\n...\n```\n", "ended with 2, not 0"),
        ("```python\nassert normal(sd='3 %') and 1 / 0\n```\n", "ZeroDivisionError"),
        (
            "<!-- inputs: coil_spring.py -->\n```toml\n[inputs]\nwire_diametre = '1 mm'\n```\n",
            "no input 'wire_diametre'",
        ),
        ("<!-- cases: coil_spring.py -->\n```csv\ncase,colour\none,red\n```\n", "colour"),
        ('```json\n{"equal": True}\n```\n', "Expecting value"),
        ("```text\ncalc run PLUGIN [--colour]\n```\n", "calc run has no --colour"),
        ("```text\ncalc walk PLUGIN\n```\n", "there is no verb 'walk'"),
    ],
)
def test_a_page_that_lies_is_found(block: str, fault: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(block, encoding="utf-8")
    assert [fault in found for found in check_page(page, desk_in(tmp_path))] == [True]


@pytest.mark.parametrize(
    "block",
    [
        "<!-- not run -->\n```console\n$ calc plugins\n```\n",
        "```text\nwords\n```\n",
        "```toml\n[inputs]\n```\n",
        "```csv\na,b\n```\n",
        "```yaml\na: b\n```\n",
        "```\nwords\n```\n",
    ],
)
def test_a_block_that_nothing_reads_is_found(block: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(block, encoding="utf-8")
    assert all(why_not(one) for one in blocks(page))
    assert list(blocks(page))


def test_a_reason_that_names_a_test_names_one_that_is_there() -> None:
    for page in EVERY:
        whys = [(f"{page.name}:{block.line}", block.marked("not run")) for block in blocks(page)]
        for place, why in [*whys, (page.name, takes_long(page))]:
            for name in re.findall(r"tests/[\w/]+\.py", why):
                assert (ROOT / name).is_file(), f"{place}: {name}"


def test_what_is_run_at_full_size_only_is_asked_for_in_part_by_another_test() -> None:
    for page in EVERY:
        if why := takes_long(page):
            assert re.search(r"tests/[\w/]+\.py", why), f"{page.name}: {why} names no test"
