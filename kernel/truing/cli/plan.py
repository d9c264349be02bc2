"""calc plan: the experiment that tells causes apart, before any data exist."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

from truing.cli.console import Settings, broken, out, out_json
from truing.cli.load import find_model, say_example
from truing.errors import UsageError


def plan(settings: Settings, asked: SimpleNamespace) -> int:
    """Design an experiment that tells causes apart: what is held, what is varied, how long, with which chance."""
    names = [name.strip() for name in asked.causes.split(",") if name.strip()]
    noise = _noise(asked.noise or ())
    model = find_model(asked.plugin, settings, asked.changed)
    say_example(asked.inputs, asked.plugin, settings)
    made = model.plan(names, asked.inputs, noise=noise, budget=asked.budget, progress=not settings.quiet)
    if asked.output is not None and made.chance is not None:
        settings.say(f"wrote {made.save(asked.output)}: fill in the results and diagnose it")
    if asked.as_json:
        out_json(made.document)
    else:
        for sentence in made.sentences:
            out("\n".join(broken(sentence, 0)))
    return 0 if made.chance is not None else 1


def _noise(words: Sequence[str]) -> dict[str, str]:
    """Take "RESULT=SD" as often as it is given; raises UsageError for what is none."""
    said = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not (name.strip() and equals and text.strip()):
            raise UsageError(f'--noise {word}: write RESULT=SD, as in --noise "depth=1 um"')
        if name.strip() in said:
            raise UsageError(f"--noise states '{name.strip()}' twice")
        said[name.strip()] = text.strip()
    return said
