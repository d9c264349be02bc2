"""The house keeps its own rules: floors, types, style, sizes, and the list of names for plugin authors."""

import ast
import configparser
import importlib
import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from graphlib import TopologicalSorter
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from diagnosis_samples import REMAINDER, unknown
from grimp import build_graph

import truing
from shared import ROOT, Answer, process
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import ShapeTerm
from truing.runs.new_effect import new_effect_source

CODE = [*sorted((ROOT / "kernel").rglob("*.py")), *sorted((ROOT / "plugins").rglob("*.py"))]
PACKAGES = sorted(path.parent.name for path in (ROOT / "plugins").glob("*/__init__.py"))
# optional: imported inside a function, missed with a sentence
EXTRAS = {"harmonic_fractal": {"ContactMechanics", "SurfaceTopography"}}
SHARED = {"gear_geometry"}  # what several gear papers share: no hooks, and every plugin may import it
FOR_AUTHORS = {"truing"}
NEVER_MISSED = {"IPython", "typing_extensions", "_typeshed"}  # there in a notebook, and for type checkers, alone
FOR_OUR_WORK = {"test", "docs", "dev"}  # extras that nothing of ours imports


def tool(*arguments: str) -> Answer:
    return process([sys.executable, "-m", *arguments], ROOT)


def test_floors() -> None:
    code = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports())"
    answer = process([sys.executable, "-c", code], ROOT)
    assert answer.code == 0, answer.out + answer.err


def test_types() -> None:
    answer = tool("mypy")
    assert answer.code == 0, answer.out


@pytest.mark.parametrize("words", [("check",), ("format", "--check")], ids=["style", "format"])
def test_style(words: tuple[str, ...]) -> None:
    answer = tool("ruff", *words, "kernel", "plugins", "tests", "docs/site")
    assert answer.code == 0, answer.out


# What the type checker catches in a plugin, before anything runs


def stub() -> str:
    """The effect that a diagnosis proposes for a shape over two columns, one of which nobody declared."""
    covariates = {**unknown().records.covariates, "a b": Covariate("a b", np.zeros(160), "kN", "other")}
    records = replace(unknown().records, covariates=covariates)
    terms = {"slide_position": (ShapeTerm("np.tanh(load / 1e3) * a b", 1e-6),)}
    remainder = replace(REMAINDER, depends_on=("load", "a b"), terms=terms)
    return new_effect_source(replace(unknown(), records=records, remainder=remainder))


def test_plugins_outside_of_the_packages_are_typed_and_in_style(tmp_path: Path) -> None:
    """Of the style page, of the manual, and the stub that a diagnosis writes, before anybody touches it.

    What builds the site of the manual is typed as well.
    """
    (tmp_path / "new_effect.py").write_text(stub(), encoding="utf-8")
    examples = [str(file) for file in sorted((ROOT / "docs" / "examples").rglob("*.py"))]
    files = [str(ROOT / "tests" / "data" / "pin_wear.py"), str(tmp_path / "new_effect.py"), *examples]
    for words in (
        ("mypy", "--strict", "docs/site/hooks.py", "docs/site/manual", *files),
        ("ruff", "check", *examples),
        ("ruff", "format", "--check", *examples),
        ("ruff", "check", "--select", "E,F,W,I", "--line-length", "120", str(tmp_path / "new_effect.py")),
    ):
        answer = tool(*words)
        assert answer.code == 0, answer.out


def test_every_mistake_in_a_plugin_is_caught() -> None:
    file = ROOT / "tests" / "data" / "pin_wear_wrong.py"
    lines = file.read_text(encoding="utf-8").splitlines()
    wrong = {number for number, line in enumerate(lines, start=1) if "# WRONG" in line}
    answer = process(
        [sys.executable, "-m", "mypy", "--strict", "--config-file", str(ROOT / "pyproject.toml"), str(file)],
        ROOT,
        {"MYPYPATH": str(file.parent)},
    )
    found = {int(number) for number in re.findall(r"pin_wear_wrong\.py:(\d+): error", answer.out)}
    assert len(wrong) == 13
    assert found == wrong, answer.out


# Packaging and contracts speak of every package


def test_every_package_is_in_the_contracts_and_in_the_type_check() -> None:
    contracts = configparser.ConfigParser()
    contracts.read(ROOT / ".importlinter")

    def named(section: str, key: str) -> set[str]:
        return set(contracts[section][key].split())

    assert named("importlinter", "root_packages") == {"truing", *PACKAGES}
    assert named("importlinter:contract:kernel", "forbidden_modules") == set(PACKAGES)
    assert named("importlinter:contract:plugins", "source_modules") == set(PACKAGES)
    assert named("importlinter:contract:neighbours", "modules") == set(PACKAGES) - SHARED
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(project["tool"]["mypy"]["packages"]) == {"truing", *PACKAGES}
    entries = project["project"]["entry-points"]["truing.plugins"]
    assert {value.split(":")[0] for value in entries.values()} == set(PACKAGES) - SHARED


def test_every_library_that_is_imported_is_declared() -> None:
    """Also what comes with another one, which may do without it some day."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    lists = [project["dependencies"], *(extras[name] for name in extras if name not in FOR_OUR_WORK)]
    declared = {name for words in lists for word in words for name in installed_by(word)}
    imported = {name for file in CODE for name in _libraries_of(file)}
    imported -= NEVER_MISSED
    assert {"numpy", "pint", "sklearn"} <= imported
    assert imported - declared == set()


def installed_by(requirement: str) -> set[str]:
    """Return the names at the top of what the distribution of a requirement installs."""
    name = re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]
    try:
        return {file.parts[0].partition(".")[0] for file in metadata.files(name) or ()}
    except metadata.PackageNotFoundError:
        return {name}


@cache
def nodes_of(file: Path) -> list[ast.AST]:
    """Every node of a file; each is read once for all tests."""
    return list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))


@pytest.fixture(scope="module", autouse=True)
def _nodes_are_let_go() -> Iterator[None]:
    """A million of them would be looked through, whenever Python looks for rings of objects, in all later tests."""
    yield
    nodes_of.cache_clear()


def _libraries_of(file: Path) -> Iterator[str]:
    for node in nodes_of(file):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = [str(node.module)]
        elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Later":
            names = [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
        tops = {name.split(".")[0] for name in names}
        yield from tops - sys.stdlib_module_names - {"truing", *PACKAGES}


def test_every_package_is_marked_as_typed() -> None:
    for package in ("truing", *PACKAGES):
        module = importlib.import_module(package)
        assert (Path(str(module.__file__)).parent / "py.typed").is_file()


def _drawn(begin: str) -> list[str]:
    """Return the indented lines of a drawing in docs/explanation/house.md that begins with these words."""
    text = (ROOT / "docs" / "explanation" / "house.md").read_text(encoding="utf-8")
    _, _, rest = text.partition(f"```text\n{begin}")
    rest = rest.partition("\n")[2]
    return [line for line in rest.partition("```")[0].splitlines() if line.startswith("  ")]


def test_the_house_is_drawn_with_every_room_on_its_floor() -> None:
    contracts = configparser.ConfigParser()
    contracts.read(ROOT / ".importlinter")
    floors = [set(re.findall(r"\w+", line)) for line in contracts["importlinter:contract:floors"]["layers"].split("\n")]
    drawn = [set(re.split(r" {3,}", line.strip())[0].split()) for line in _drawn("kernel/truing/") if line[:3] != "   "]
    assert [floor for floor in drawn if floor] == [floor for floor in floors if floor]


@pytest.mark.parametrize("begin", ["inputs.toml", "measured.csv"])
def test_every_file_on_the_way_is_there(begin: str) -> None:
    files = [file for line in _drawn(begin) for file in re.findall(r"[\w/]+\.py", line)]
    assert len(files) > 8
    assert not [file for file in files if not (ROOT / "kernel" / "truing" / file).is_file()]


def test_the_page_of_the_diagnosis_names_modules_that_are_there() -> None:
    """At the head of a paragraph, and in brackets in the one on how rows are read."""
    page = (ROOT / "docs" / "explanation" / "diagnosis.md").read_text(encoding="utf-8")
    heads = re.findall(r"\n\n((?:`[a-z_]+`(?:, )?)+)[.:]", page)
    reading = next(part for part in page.split("\n\n") if part.startswith("First the rows are read"))
    named = {*re.findall(r"`([a-z_]+)`", " ".join(heads)), *re.findall(r"\(`([a-z_]+)`\)", reading)}
    assert len(named) > 15
    rooms = ROOT / "kernel" / "truing"
    assert named <= {file.stem for file in (rooms / "diagnosis").glob("*.py")}
    experiments = set(re.findall(r"\n\n`experiments/([a-z_]+)`\.", page))
    assert len(experiments) > 4
    assert experiments <= {file.stem for file in (rooms / "experiments").glob("*.py")}


def imports_of(file: Path) -> Iterator[str]:
    for node in nodes_of(file):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: imports are absolute"
            yield str(node.module)


@pytest.mark.parametrize("package", PACKAGES)
def test_a_plugin_imports_what_its_author_is_given(package: str) -> None:
    allowed = {package, "numpy", "scipy", "matplotlib", *SHARED, *EXTRAS.get(package, ()), *sys.stdlib_module_names}
    for file in sorted((ROOT / "plugins" / package).rglob("*.py")):
        for name in imports_of(file):
            assert name in FOR_AUTHORS or name.split(".")[0] in allowed, f"{file} imports {name}"


# Names for plugin authors


def test_every_name_for_authors_is_there() -> None:
    for name in truing.__all__:
        assert getattr(truing, name) is not None
        assert name in dir(truing)
    assert not [name for name, count in Counter(truing.__all__).items() if count > 1]
    with pytest.raises(AttributeError, match="module 'truing' has no attribute 'Modle'"):
        truing.Modle  # type: ignore[attr-defined]  # noqa: B018


def test_the_type_checker_sees_the_same_names() -> None:
    seen = {
        alias.name: node.module
        for node in nodes_of(Path(str(truing.__file__)))
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("truing.")
        for alias in node.names
    }
    assert seen == truing._HOME
    assert set(seen) == set(truing.__all__)


# Small pieces


def functions_of(file: Path) -> Iterator[ast.FunctionDef]:
    return (node for node in nodes_of(file) if isinstance(node, ast.FunctionDef))


def test_imports_stand_at_the_top_of_files() -> None:
    """But those of optional extras, and what ``truing`` itself loads when a name of its table is used."""
    inside = {
        (file.name, name)
        for file in CODE
        for function in functions_of(file)
        for node in ast.walk(function)
        for name in _imported(node)
    }
    assert inside == {
        ("kit.py", "pytest"), ("finding.py", "pytest"), ("surface_files.py", "SurfaceTopography"),
        ("pressed.py", "ContactMechanics"), ("pressed.py", "ContactMechanics.Systems"),
        ("pressed.py", "SurfaceTopography"),
    }  # fmt: skip


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [str(node.module)] if isinstance(node, ast.ImportFrom) else []


def test_no_file_imports_itself_over_others() -> None:
    """Imports for the type checker alone count too."""
    graph = build_graph("truing", *PACKAGES, include_external_packages=False)
    files = {name: graph.find_modules_directly_imported_by(name) for name in graph.modules if name != "truing"}
    TopologicalSorter(files).prepare()  # raises CycleError, which names the circle


def test_functions_are_small_and_take_few_arguments_by_position() -> None:
    """More than five come by keyword only, which the words of a declaration and the command line's verbs do."""
    for file in CODE:
        for function in functions_of(file):
            place = f"{file}:{function.lineno}: {function.name}"
            assert (function.end_lineno or 0) - function.lineno < 40, place
            assert len([*function.args.posonlyargs, *function.args.args]) <= 5 or "cli" in file.parts, place


def test_nothing_is_left_for_later() -> None:
    words = ("TODO", "FIXME", "XXX", "NotImplementedError")
    assert not [str(file) for file in CODE if any(word in file.read_text(encoding="utf-8") for word in words)]
