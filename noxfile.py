"""Tasks of a developer: ``nox -s tests``, ``style``, ``types``, ``manual`` or ``benchmarks``; ``nox -l`` lists them."""

import nox

nox.options.sessions = ["style", "types", "tests"]
nox.options.reuse_existing_virtualenvs = True


@nox.session(python=["3.11", "3.12", "3.13"])
def tests(session: nox.Session) -> None:
    """Run the suite on two or more cores; arguments behind ``--`` go to pytest."""
    session.install("-e", ".[test]")
    session.run("python", "-m", "pytest", "-n", "auto", *session.posargs)


@nox.session
def style(session: nox.Session) -> None:
    """Check style and import contracts."""
    session.install("-e", ".[test]")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("lint-imports")


@nox.session
def types(session: nox.Session) -> None:
    """Check types, strictly."""
    session.install("-e", ".[test]")
    session.run("mypy")


@nox.session
def manual(session: nox.Session) -> None:
    """Build the manual in build/site; a warning is an error."""
    session.install("-e", ".[docs]")
    session.run("mkdocs", "build", "--strict")


@nox.session
def benchmarks(session: nox.Session) -> None:
    """Measure ratios of speed; arguments behind ``--`` name the benchmarks."""
    session.install("-e", ".[test]")
    session.run("python", "-m", "pytest", *(session.posargs or ["tests/benchmarks"]), "-s")
