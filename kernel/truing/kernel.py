"""The kernel: finds plugins, loads each on its own, hands out models with what guests add to them."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from truing.declare.checks import near_miss, of_objective, of_section, of_tolerance
from truing.declare.model import Model, Section
from truing.declare.sources import Effect, Tolerance
from truing.errors import DeclarationError, PluginError, UnknownPluginError

GROUP = "truing.plugins"


@dataclass(frozen=True)
class Origin:
    """Where a plugin comes from: its name, version, distribution and file; ``ref`` finds it again in a worker."""

    name: str
    version: str
    distribution: str
    file: str
    ref: str


@dataclass(frozen=True)
class Broken:
    """A plugin, or a part of one, that was left out, and why."""

    plugin: str
    version: str
    file: str
    line: int | None
    reason: str

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line else self.file
        return f"{place}: plugin '{self.plugin}' {self.version}: {self.reason}"


@dataclass(frozen=True)
class Added:
    """Something a guest added to somebody else's model."""

    what: str
    plugin: str
    version: str


@dataclass(frozen=True)
class Offer:
    """A model ready to run: equipped with what guests add, and whose it is."""

    name: str
    model: Model[Any, Any]
    origin: Origin
    added: tuple[Added, ...] = ()


class Kernel:
    """The plugins of one run. ``Kernel([module])`` knows just these, ``Kernel.installed()`` what is installed.

    With ``strict`` the first broken plugin raises; without, it is listed in ``broken`` and every other works.
    """

    def __init__(self, plugins: Iterable[ModuleType] = (), *, strict: bool = False) -> None:
        import pluggy

        from truing import hookspecs

        self.strict = strict
        self.broken: list[Broken] = []
        self.origins: dict[str, Origin] = {}
        self._manager = pluggy.PluginManager("truing")
        self._manager.add_hookspecs(hookspecs)
        self._offers: dict[str, Offer] | None = None
        for plugin in plugins:
            name = getattr(plugin, "__name__", type(plugin).__name__)
            self.add(Origin(name, "", "", getattr(plugin, "__file__", None) or name, f"module:{name}"), lambda p=plugin: p)

    @classmethod
    def installed(cls, *, strict: bool = False) -> Kernel:
        """Return a kernel with every plugin that is installed under the entry-point group ``truing.plugins``."""
        kernel = cls(strict=strict)
        for entry in entry_points():
            kernel.add(_origin(entry), entry.load)
        return kernel

    def add_file(self, path: Path) -> Origin:
        """Load one Python file as a plugin; it needs no packaging."""
        origin = Origin(path.stem, "", "", str(path), f"file:{path.resolve()}")
        self.add(origin, lambda: _load_file(path))
        return origin

    def add(self, origin: Origin, load: Callable[[], Any]) -> None:
        """Load and register one plugin; what goes wrong is noted, or raised when strict."""
        twin = self.origins.get(origin.name)
        try:
            if twin is not None:
                raise DeclarationError(f"the name '{origin.name}' is taken by {twin.file} {twin.version}")
            plugin = load()
            self._manager.register(plugin, name=origin.name)
        except Exception as error:  # noqa: BLE001  # whatever a guest's import raises must not stop the house
            self._leave_out(origin, error)
            return
        self._offers = None
        self.origins[origin.name] = replace(origin, file=getattr(plugin, "__file__", None) or origin.file)

    @property
    def offers(self) -> dict[str, Offer]:
        """Every model by the name the command line uses."""
        if self._offers is None:
            self._offers = dict(self._make_offers())
        return self._offers

    def offer(self, name: str) -> Offer:
        """Return one model by name; raises UnknownPluginError, saying why where it was left out."""
        if name in self.offers:
            return self.offers[name]
        for broken in self.broken:
            if broken.plugin == name.partition(".")[0]:
                raise PluginError(str(broken))
        alone = [offer for key, offer in self.offers.items() if key.partition(".")[0] == name]
        if len(alone) == 1:
            return alone[0]
        owners = [key for key, offer in self.offers.items() if offer.model.name == name]
        if len(owners) > 1:
            raise UnknownPluginError(f"the name '{name}' is used twice, by {' and '.join(owners)}; write one of these")
        if owners:
            return self.offers[owners[0]]
        known = ", ".join(sorted(self.offers)) or "none"
        raise UnknownPluginError(f"no plugin offers '{name}'.{near_miss(name, self.offers)} Installed: {known}.")

    def _leave_out(self, origin: Origin, error: BaseException) -> None:
        if self.strict:
            raise PluginError(f"plugin '{origin.name}' {origin.version}: {type(error).__name__}: {error}") from error
        file, line = _place(error, origin.file)
        reason = f"{type(error).__name__}: {error}"
        self.broken.append(Broken(origin.name, origin.version, file, line, reason))

    def _answers(self, hook: str, **arguments: Any) -> Iterator[tuple[Origin, list[Any]]]:
        """Ask every plugin on its own, in the order of their names."""
        caller = getattr(self._manager.hook, hook)
        for implementation in sorted(caller.get_hookimpls(), key=lambda item: item.plugin_name):
            origin = self.origins[implementation.plugin_name]
            wanted = {name: arguments[name] for name in implementation.argnames if name in arguments}
            try:
                answer = list(implementation.function(**wanted))
            except Exception as error:  # noqa: BLE001  # as above
                self._leave_out(origin, error)
                continue
            yield origin, answer

    def _make_offers(self) -> Iterator[tuple[str, Offer]]:
        found: list[tuple[Origin, Model[Any, Any]]] = []
        for origin, models in self._answers("truing_models"):
            for model in models:
                if isinstance(model, Model):
                    found.append((origin, model))
                else:
                    self._leave_out(origin, TypeError(f"truing_models returned {model!r}, which is no Model"))
        for origin, model in found:
            owners = [other for other, twin in found if twin.name == model.name]
            own_name = model.name == origin.name and len(owners) == 1
            key = model.name if own_name else f"{origin.name}.{model.name}"
            if len(owners) > 1:
                first, second = owners[:2]
                reason = f"the model name '{model.name}' is used twice, by {first.name} ({first.file}) and {second.name} ({second.file})"
                self.broken.append(Broken(origin.name, origin.version, origin.file, None, reason))
            equipped, added = self._equip(model, origin)
            yield key, Offer(key, equipped, origin, added)

    def _equip(self, model: Model[Any, Any], owner: Origin) -> tuple[Model[Any, Any], tuple[Added, ...]]:
        """Add what guests say of the model, leaving out what does not fit, by name."""
        added: list[Added] = []
        places = {
            "truing_error_sources": ("errors", _faults_of_source),
            "truing_objectives": ("objectives", _faults_of_objective),
            "truing_reports": ("sheet", _faults_of_section),
        }
        for hook, (place, faults_of) in places.items():
            for origin, answer in self._answers(hook, model=model):
                for item in answer:
                    faults = faults_of(item, model)
                    if faults:
                        self._leave_out(origin, DeclarationError(f"left out of '{model.name}': {faults[0]}"))
                        continue
                    model = replace(model, **{place: [*getattr(model, place), item]})
                    if origin != owner:
                        added.append(Added(_name_of(item), origin.name, origin.version))
        return model, tuple(added)


def entry_points() -> list[metadata.EntryPoint]:
    """Return the entry points of all plugins from metadata alone; nothing is loaded."""
    unique = {(entry.name, entry.value, _dist_name(entry)): entry for entry in metadata.entry_points(group=GROUP)}
    return sorted(unique.values(), key=lambda entry: entry.name)


def _dist_name(entry: metadata.EntryPoint) -> str:
    return entry.dist.name if entry.dist is not None else ""


def _origin(entry: metadata.EntryPoint) -> Origin:
    version = entry.dist.version if entry.dist is not None else ""
    return Origin(entry.name, version, _dist_name(entry), entry.value, f"entry:{entry.name}")


def _load_file(path: Path) -> ModuleType:
    import importlib.util
    import sys

    if not path.is_file():
        raise UnknownPluginError(f"{path}: no such file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise UnknownPluginError(f"{path}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    if not any(hasattr(module, hook) for hook in ("truing_models", "truing_error_sources")):
        raise DeclarationError(f"{path} offers nothing: it needs a function truing_models() marked with @hookimpl")
    return module


def _place(error: BaseException, fallback: str) -> tuple[str, int | None]:
    if isinstance(error, SyntaxError) and error.filename:
        return error.filename, error.lineno
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if _is_guest(frame.filename)]
    return (frames[-1].filename, frames[-1].lineno) if frames else (fallback, None)


def _is_guest(filename: str) -> bool:
    parts = Path(filename).parts
    return not filename.startswith("<") and "truing" not in parts[-3:-1] and not {"pluggy", "importlib"} & set(parts)


def _name_of(item: Any) -> str:
    return str(getattr(item, "name", None) or getattr(item, "title", None) or getattr(item, "result", None) or item)


def _faults_of_source(item: Any, model: Model[Any, Any]) -> Sequence[str]:
    if not isinstance(item, (Tolerance, Effect)):
        return [f"{item!r} is neither a Tolerance nor an Effect"]
    if any(source.name == item.name for source in model.errors):
        return [f"the error source '{item.name}' exists already"]
    if isinstance(item, Tolerance):
        return list(of_tolerance(item, model))
    taken = [need.name for need in item.needs if model.conditions.get(need.name, need) != need]
    return [f"effect '{item.name}' declares the condition '{taken[0]}' in another way"] if taken else []


def _faults_of_objective(item: Any, model: Model[Any, Any]) -> Sequence[str]:
    return list(of_objective(item, model.input_fields, model.result_fields))


def _faults_of_section(item: Any, model: Model[Any, Any]) -> Sequence[str]:
    if not isinstance(item, Section):
        return [f"{item!r} is no Section"]
    return list(of_section(item, model.result_fields))


def kernel_for(ref: str, *, strict: bool = False) -> Kernel:
    """Return a kernel that knows the plugin of this ``Origin.ref`` besides what is installed."""
    kind, _, value = ref.partition(":")
    kernel = Kernel.installed(strict=strict)
    if kind == "file":
        kernel.add_file(Path(value))
    elif kind == "module":
        from importlib import import_module

        module = import_module(value)
        kernel.add(Origin(value, "", "", module.__file__ or value, ref), lambda: module)
    return kernel
