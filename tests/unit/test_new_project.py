"""Names, titles and files of new plugins: what is refused, what is proposed, and that titles come through whole."""

from __future__ import annotations

import ast
import tomllib
from pathlib import Path

import pytest

from truing.errors import OutputError, UsageError
from truing.new_project import (
    LONGEST_NAME,
    WIDEST_TITLE,
    NewPlugin,
    check_name,
    check_title,
    project,
    single_file,
    spelled,
    title_of,
    write_project,
    write_single_file,
)

LONG_NAME = "a" + "_b" * 19 + "c"
TITLES = [
    "Plain",
    'Arm, 5" wide',
    "Roark's arm, 5\" wide",
    "Träger „Größe“ ΔL × 2",
    "back\\slash\\",
    "{{ 7 * 7 }} {% raw %} ${{ x }}",
    '"""\\',
    "<script>alert(1)</script> *b* | $x$",
    "梁" * (WIDEST_TITLE // 2),
    "x" * WIDEST_TITLE,
]


PROPOSED = {
    "belt-drive": "belt_drive", "BeltDrive": "belt_drive", "2nd drive": "nd_drive", "Träger Größe": "traeger_groesse",
    "crème_brûlée": "creme_brulee", "größe": "groesse", "_private": "private", "belt__drive": "belt_drive",
    "belt_": "belt", "../../etc/passwd": "etc_passwd", "a/b": "a_b", "a\\b": "a_b", "belt.py": "belt_py", "a\nb": "a_b",
    "\x1b[31mred": "mred", "'; rm -rf /": "rm_rf",
}  # fmt: skip
REFUSED = {
    "such as belt_drive": ["", "123", "齿轮", "Class", "-", "x" * 10_000 + "!"],
    f"at most {LONGEST_NAME} characters": ["a" * (LONGEST_NAME + 1)],
    "a word of Python itself": ["class", "lambda"],
    "a device on Windows": ["con", "com1"],
    "another meaning in a project": ["tests", "build"],
    "is a module already": ["json", "numpy", "truing", "gear_geometry"],
    "is a module already (Python itself)": ["sys"],
    "is a calculation of truing": ["press_linkage", "made_flank"],
}


def test_a_bad_name_is_refused_in_one_sentence() -> None:
    refused = [(name, f"write {better}") for name, better in PROPOSED.items()]
    refused += [(name, words) for words, bad in REFUSED.items() for name in bad]
    for name, words in refused:
        with pytest.raises(UsageError) as caught:
            check_name(name)
        sentence = str(caught.value)
        assert words in sentence
        assert sentence.isprintable()
        assert len(sentence) < 300


def test_a_good_name_and_what_is_proposed_are_taken() -> None:
    for name in ("a", "belt_drive", "belt2", "x_1", "match", LONG_NAME):
        check_name(name)
    assert len(LONG_NAME) == LONGEST_NAME
    for name in ("HTTPServer2", "ÄußereKraft", "  spaced  out  ", "Shaft Ø 5"):
        check_name(spelled(name))


@pytest.mark.parametrize("title", TITLES)
def test_a_title_comes_through_whole(title: str) -> None:
    check_title(title)
    plan = NewPlugin("belt_drive", title)
    files = project(plan)
    assert title_in(files["belt_drive/__init__.py"]) == title_in(single_file(plan)) == title
    assert tomllib.loads(files["pyproject.toml"])["project"]["description"] == title
    head = files["README.md"].splitlines()[0]
    assert head.startswith("# ")
    assert "<script" not in head


def title_in(code: str) -> object:
    """The title of the model that a file declares."""
    keywords = [node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.keyword)]
    (title,) = [ast.literal_eval(keyword.value) for keyword in keywords if keyword.arg == "title"]
    return title


def test_a_title_that_is_no_line_is_refused() -> None:
    for title in ("", "   ", "two\nlines", "bell\a", "\u202eturned", "x" * (WIDEST_TITLE + 1), '"' * 36):
        with pytest.raises(UsageError, match="--title: "):
            check_title(title)


def test_names_and_titles_of_what_is_written() -> None:
    assert title_of("belt_drive_2") == "Belt drive 2"
    settings = tomllib.loads(project(NewPlugin("belt_drive", "Belt"))["pyproject.toml"])
    assert settings["project"]["name"] == "belt-drive"
    assert settings["project"]["entry-points"] == {"truing.plugins": {"belt_drive": "belt_drive"}}
    assert settings["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"] == ["belt_drive"]


def test_it_needs_truing_and_pytest_only_and_has_no_licence() -> None:
    files = project(NewPlugin("belt_drive", "Belt"))
    about = tomllib.loads(files["pyproject.toml"])["project"]
    assert about["dependencies"] == ["truing>=0.1"]
    assert about["optional-dependencies"] == {"test": ["truing[testing]"]}
    assert not [key for key in about if "licen" in key]
    assert not [name for name in files if "licen" in name.lower()]
    imported = {
        (node.module if isinstance(node, ast.ImportFrom) else node.names[0].name).split(".")[0]
        for name, text in files.items()
        if name.endswith(".py")
        for node in ast.walk(ast.parse(text))
        if isinstance(node, (ast.Import, ast.ImportFrom))
    }
    assert imported == {"truing", "pytest", "belt_drive", "dataclasses", "json", "pathlib"}


def test_the_made_rows_are_what_they_say() -> None:
    """A cantilever after Roark, table 8.1, case 1a, with the moment turning its clamp, and a noise of 0.01 mm."""
    said, header, *lines = project(NewPlugin("belt_drive", "Belt"))["measured.csv"].splitlines()
    assert said == "# Made, not measured: bar of 5.97 mm instead of 6 mm, clamp of 0.25 mrad/(N*m), noise of 0.01 mm."
    assert header == "time [min],force [N],length [mm],deflection [mm]"
    rows = [[float(cell) for cell in line.split(",")] for line in lines]
    noise = [
        read - (force * length**3 / (3 * 210e3 * 20 * 5.97**3 / 12) + 0.25e-6 * force * length**2)
        for _, force, length, read in rows
    ]
    count = len(noise)
    assert count == 40
    assert abs(sum(noise) / count) < 3 * 0.01 / count**0.5
    # 99 % of the chi-square distribution with 40 degrees of freedom lie between 20.7 and 66.8
    assert 20.7 < sum(one**2 for one in noise) / 0.01**2 < 66.8


def test_nothing_is_written_where_nothing_may_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def denied(*arguments: object, **more: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.mkdtemp", denied)
    monkeypatch.setattr("tempfile.mkstemp", denied)
    with pytest.raises(OutputError, match="new: the project cannot be written: Permission denied"):
        write_project(tmp_path / "below" / "new", FILES)
    with pytest.raises(OutputError, match=r"new\.py: cannot be written: Permission denied"):
        write_single_file(tmp_path / "new.py", "")
    assert list(tmp_path.iterdir()) == []


FILES = {"a.txt": "1", "b/c/d.txt": "2", ".hidden/e.txt": "3"}


def written(folder: Path) -> dict[str, str]:
    """Every file below a folder."""
    paths = [path for path in folder.rglob("*") if path.is_file()]
    return {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in paths}


@pytest.mark.parametrize("is_there", [False, True])
def test_a_project_fills_a_folder_that_is_new_or_empty(tmp_path: Path, is_there: bool) -> None:
    folder = tmp_path / "ä b" / "new"
    if is_there:
        folder.mkdir(parents=True)
        before = folder.stat().st_ino
    write_project(folder, FILES)
    assert written(folder) == FILES
    assert written(tmp_path) == {f"ä b/new/{name}": text for name, text in FILES.items()}
    assert not is_there or folder.stat().st_ino == before


def test_a_project_overwrites_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / ".hidden").write_text("mine", encoding="utf-8")
    (tmp_path / "broken").symlink_to(tmp_path / "nowhere")
    before = written(tmp_path)
    for name, words in [
        ("file", "is there already and no folder"),
        ("full", "is there and not empty"),
        ("broken", "is there already and no folder"),
        ("file/below", "cannot be written"),
    ]:
        with pytest.raises(OutputError, match=words):
            write_project(tmp_path / name, FILES)
    assert written(tmp_path) == before
