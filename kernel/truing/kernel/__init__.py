"""The kernel: finds plugins, loads each on its own, hands out models with what guests add to them."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module, metadata
from pathlib import Path
from types import ModuleType
from typing import Any

import pluggy
from pluggy import HookImpl

from truing import hookspecs
from truing.declare.chain import Link, chained, declared_links, link_faults
from truing.declare.correlations import Correlated
from truing.declare.model import Model, Section
from truing.declare.near_miss import near_miss
from truing.declare.quantities import unread_quantities
from truing.declare.sources import Effect, Tolerance
from truing.entry_points import distribution_of, entry_points
from truing.errors import DeclarationError, PluginError, UnknownPluginError
from truing.kernel.blame import SourceLine, home_of, line_of, line_of_words, place_of
from truing.kernel.loading import check_hooks, load_file
from truing.units.grammar import shown


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
        source_line = f"{self.file}:{self.line}" if self.line else self.file
        name = f"'{self.plugin}' {self.version}".rstrip()
        return f"{source_line}: plugin {name}: {self.reason}"


@dataclass(frozen=True)
class Added:
    """Something a guest added to somebody else's model."""

    what: str
    plugin: str
    version: str
    file: str = ""

    @property
    def as_json(self) -> dict[str, str]:
        """What it is and whose, without where that lies on this machine."""
        return {"what": self.what, "plugin": self.plugin, "version": self.version}


@dataclass(frozen=True)
class Offer:
    """A model ready to run: equipped with what guests add, and whose it is.

    ``beside`` are all offers of its kernel by name, each by itself: those that it may take inputs from.
    """

    name: str
    model: Model[Any, Any]
    origin: Origin
    added: tuple[Added, ...] = ()
    beside: Mapping[str, Offer] = field(default_factory=dict, repr=False, compare=False)


class ChainError(DeclarationError):
    """Calculations that cannot be chained: the sentences, each with the link that is to blame."""

    def __init__(self, faults: Sequence[tuple[Link, str]]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(sentence for _, sentence in faults))


class Kernel:
    """The plugins of one run. ``Kernel([module])`` knows just these, ``Kernel.installed()`` what is installed.

    With ``strict`` the first broken plugin raises; without, it is listed in ``broken`` and every other works.
    """

    def __init__(self, plugins: Iterable[ModuleType] = (), *, strict: bool = False) -> None:
        self.strict = strict
        self.origins: dict[str, Origin] = {}
        self._manager = pluggy.PluginManager("truing")
        self._manager.add_hookspecs(hookspecs)
        self._not_loaded: list[Broken] = []
        self._left_out: list[Broken] = []
        self._offers: dict[str, Offer] | None = None
        modules = list(plugins)
        names = [getattr(module, "__name__", type(module).__name__) for module in modules]
        for name, module in zip(names, modules, strict=True):
            ref = "module:" + ",".join([name, *(other for other in names if other != name)])
            self.add(Origin(name, "", "", getattr(module, "__file__", None) or name, ref), _giving(module))

    @classmethod
    def installed(cls, *, strict: bool = False, only: str = "") -> Kernel:
        """Return a kernel with every plugin that is installed under the entry-point group ``truing.plugins``.

        With ``only`` no other plugin is loaded, so that guests of its models are missing.
        """
        kernel = cls(strict=strict)
        for entry in entry_points():
            if only in {"", entry.name}:
                kernel.add(_origin(entry), entry.load)
        return kernel

    def add_file(self, path: Path) -> Origin:
        """Load one Python file as a plugin; it needs no packaging. Its folder may hold modules it imports."""
        origin = Origin(path.stem.replace(".", "_"), "", "", str(path), f"file:{path.resolve()}")
        self.add(origin, lambda: load_file(path))
        return origin

    def add(self, origin: Origin, load: Callable[[], Any]) -> None:
        """Load and register one plugin; what goes wrong is noted, or raised when strict."""
        twin = self.origins.get(origin.name)
        try:
            if twin is not None:
                raise DeclarationError(f"the plugin name '{origin.name}' is taken by {twin.distribution or twin.file}")
            plugin = load()
            check_hooks(self._manager, plugin, origin.name)
            self._manager.register(plugin, name=origin.name)
        except (Exception, SystemExit) as error:
            self._note(self._not_loaded, origin, error)
            return
        self._offers = None
        self.origins[origin.name] = replace(origin, file=getattr(plugin, "__file__", None) or origin.file)

    @property
    def broken(self) -> list[Broken]:
        """Every plugin, and every part of one, that was left out, and why; asks all plugins first."""
        _ = self.offers
        return [*self._not_loaded, *self._left_out]

    @property
    def offers(self) -> dict[str, Offer]:
        """Every model by the name the command line uses."""
        if self._offers is None:
            self._left_out.clear()
            self._offers = self._make_offers()
        return self._offers

    def offer(self, name: str) -> Offer:
        """Return one model by name; raises UnknownPluginError, saying why where it was left out."""
        offer = self._named(name)
        demand_readable(offer)
        return offer

    def _named(self, name: str) -> Offer:
        offers = self.offers
        full = [offer for offer in offers.values() if name in {offer.name, f"{offer.origin.name}.{offer.model.name}"}]
        if full:
            return full[0]
        named = [key for key, offer in offers.items() if offer.model.name == name]
        if len(named) > 1:
            raise UnknownPluginError(f"the name '{name}' is used twice, by {' and '.join(named)}; write one of these")
        alone = [key for key, offer in offers.items() if offer.origin.name == name] or named
        if len(alone) == 1:
            return offers[alone[0]]
        if alone:
            raise UnknownPluginError(f"the plugin '{name}' offers {' and '.join(alone)}; write one of these")
        for broken in self.broken:
            if broken.plugin == name.partition(".")[0]:
                raise PluginError(str(broken))
        known = ", ".join(sorted(offers)) or "none"
        raise UnknownPluginError(f"no plugin offers {shown(name)}.{near_miss(name[:80], offers)} Installed: {known}.")

    def _note(
        self, where: list[Broken], origin: Origin, error: BaseException, source_line: SourceLine | None = None
    ) -> None:
        reason = f"{type(error).__name__}: {error}"
        file, line = source_line or getattr(error, "place", None) or place_of(error, _homes(origin))
        broken = Broken(origin.name, origin.version, file or _file_of(origin), line if file else None, reason)
        if self.strict:
            raise PluginError(str(broken)) from error
        where.append(broken)

    def _answers(self, hook: str, **arguments: Any) -> Iterator[tuple[Origin, HookImpl, list[Any]]]:
        """Ask every plugin on its own, in the order of their names."""
        caller = getattr(self._manager.hook, hook)
        for implementation in sorted(caller.get_hookimpls(), key=lambda implementation: implementation.plugin_name):
            origin = self.origins[implementation.plugin_name]
            wanted = {name: arguments[name] for name in implementation.argnames if name in arguments}
            try:
                answer = implementation.function(**wanted)
                if isinstance(answer, str) or not isinstance(answer, Iterable):
                    raise DeclarationError(f"{hook} returned {answer!r:.60}; it returns a list")
                items = list(answer)
            except (Exception, SystemExit) as error:
                source_line = place_of(error, _homes(origin))
                self._note(
                    self._left_out, origin, error, source_line if source_line[0] else line_of(implementation.function)
                )
                continue
            yield origin, implementation, items

    def _make_offers(self) -> dict[str, Offer]:
        accepted: list[tuple[Origin, HookImpl, Model[Any, Any]]] = []
        for origin, hook, models in self._answers("truing_models"):
            for model in models:
                fault = self._fault_of_model(model, [twin for owner, _, twin in accepted if owner == origin])
                if fault:
                    self._note(self._left_out, origin, DeclarationError(fault), line_of(hook.function))
                else:
                    accepted.append((origin, hook, model))
        alone: dict[str, Offer] = {}
        offers: dict[str, Offer] = {}
        for origin, hook, model in accepted:
            owners = [owner for owner, _, twin in accepted if twin.name == model.name]
            if len(owners) > 1:
                both = " and ".join(f"{owner.name} ({owner.distribution or owner.file})" for owner in owners)
                fault = f"the model name '{model.name}' is used by {both}; write {origin.name}.{model.name}"
                self._note(self._left_out, origin, DeclarationError(fault), line_of(hook.function))
            is_main = model.name == origin.name and len(owners) == 1
            key = model.name if is_main else f"{origin.name}.{model.name}"
            equipped, added = self._equip(model, origin)
            alone[key] = Offer(key, equipped, origin, added, alone)
        for key, offer in alone.items():
            try:
                offers[key] = chained_offer(offer)
            except DeclarationError as error:
                hook = next(hook for _, hook, model in accepted if model.name == offer.model.name)
                said = DeclarationError(f"model '{offer.model.name}': {error}")
                self._note(self._left_out, offer.origin, said, line_of(hook.function))
        return offers

    @staticmethod
    def _fault_of_model(model: Any, twins: Sequence[Model[Any, Any]]) -> str:
        if not isinstance(model, Model):
            return f"truing_models returned {model!r:.60}, which is no Model"
        return f"it offers two models called '{model.name}'" if any(twin.name == model.name for twin in twins) else ""

    def _equip(self, model: Model[Any, Any], owner: Origin) -> tuple[Model[Any, Any], tuple[Added, ...]]:
        """Add what guests say of the model, leaving out what does not fit, by name."""
        added: list[Added] = []
        for hook in ("truing_error_sources", "truing_objectives", "truing_reports"):
            for origin, implementation, items in self._answers(hook, model=model):
                for addition in items:
                    try:
                        model = _with(model, hook, addition)
                    except DeclarationError as error:
                        fault = DeclarationError(f"'{_name_of(addition)}' is left out of '{model.name}': {error}")
                        self._note(self._left_out, origin, fault, line_of(implementation.function))
                        continue
                    if origin != owner:
                        added.append(Added(_name_of(addition), origin.name, origin.version, origin.file))
        return model, tuple(added)


# Calculations that take inputs from others


def offer_beside(offer: Offer, name: str) -> Offer | None:
    """Return the calculation that one beside this offer is called, by its whole name or that of its model."""
    if name in offer.beside:
        return offer.beside[name]
    named = [other for other in offer.beside.values() if other.model.name == name]
    return named[0] if len(named) == 1 else None


def chained_offer(offer: Offer, stated: Sequence[Link] = ()) -> Offer:
    """Return a calculation with all that its inputs are taken from, as declared and as stated besides.

    Links that are stated win over those declared of the same input. A source goes by the word that first names it, or
    by a name of its own.
    Raises ChainError with what is wrong with links, those of sources included.
    """
    last = offer.beside.get(offer.name, offer)
    gathered = _gathered(offer, last, stated)
    links = list(gathered.links.values())
    models = {word: source.model for word, source in gathered.sources.items()}
    faults = [*gathered.faults, *link_faults(last.model.name, last.model, models, links)]
    faults += _setting_faults(models, gathered.settings, links)
    if faults:
        raise ChainError(faults)
    if not links:
        return last
    whose = [
        (Added(word, each.origin.name, each.origin.version, each.origin.file), *each.added)
        for word, each in gathered.sources.items()
    ]
    model = chained(last.model, models, links, gathered.settings)
    return replace(last, model=model, added=(*last.added, *(added for each in whose for added in each)))


@dataclass
class _Gathered:
    """What belongs to a chain: links by owner and input, sources and what is stated of them by word, and faults."""

    links: dict[tuple[str, str], Link] = field(default_factory=dict)
    sources: dict[str, Offer] = field(default_factory=dict)
    settings: dict[str, dict[str, Any]] = field(default_factory=dict)
    faults: list[tuple[Link, str]] = field(default_factory=list)


def _gathered(offer: Offer, last: Offer, stated: Sequence[Link]) -> _Gathered:
    gathered, waiting = _Gathered(), [("", last)]
    words = {last.name: last.model.name}
    for link in stated:
        named = offer_beside(offer, link.source)
        if named is not None and not link.model:
            words.setdefault(named.name, link.source)
    while waiting:
        owner, current = waiting.pop(0)
        declared, settings = declared_links(current.model)
        order = {name: place for place, name in enumerate(current.model.input_fields)}
        own = [replace(link, owner=owner) for link in declared] + [link for link in stated if link.owner == owner]
        for link in sorted(own, key=lambda link: order.get(link.input, len(order))):  # equal files give equal chains
            source = offer_beside(offer, link.calculation)
            fault = _no_source(offer, link) if source is None else _wrong_name(offer, link, gathered.sources, source)
            if source is None or fault:
                gathered.faults.append((link, fault))
                continue
            word = link.source if link.model else words.setdefault(source.name, link.source)
            gathered.links[owner, link.input] = replace(link, source=word)
            gathered.settings.setdefault(word, {}).update(settings.get(link.source, {}))
            if word not in gathered.sources and (link.model or source is not last):
                gathered.sources[word] = source
                waiting.append((word, source))
    return gathered


def _no_source(offer: Offer, link: Link) -> str:
    known = [*offer.beside, *(other.model.name for other in offer.beside.values())]
    near = near_miss(link.calculation[:80], known)
    said = f"'{link.input}' is taken from {shown(link.calculation)}, which no plugin offers.{near}"
    if link.model or near or not link.source.isidentifier():
        return said
    return f'{said} If it is a name of its own, say whose: [from.{link.source}] plugin = "NAME"'


def _wrong_name(offer: Offer, link: Link, sources: Mapping[str, Offer], source: Offer) -> str:
    """Say what is wrong with the name of its own by which a source goes; nothing where it is right."""
    called = shown(link.source)
    if not link.model:
        return ""
    if not (link.source.isidentifier() and link.source.isascii()) or link.source.startswith("_"):
        return f"{link.model} cannot be called {called}: its name begins with a letter, then letters, digits and _"
    if offer_beside(offer, link.source) is not None:
        return f"{link.model} cannot be called {called}: another calculation has this name"
    other = sources.get(link.source, source)
    return "" if other is source else f"{called} is {other.model.name} and {link.model}; give each its own name"


def _setting_faults(
    sources: Mapping[str, Model[Any, Any]], settings: Mapping[str, Mapping[str, Any]], links: Sequence[Link]
) -> Iterator[tuple[Link, str]]:
    """Say which inputs are stated of a source that it does not have."""
    for link in links:
        known = sources[link.source].input_fields if link.source in sources else {}
        for name in settings.get(link.source, {}) if known else ():
            if name not in known:
                yield link, f"{link.source} has no input '{name}'.{near_miss(name, known)}"


def demand_readable(offer: Offer) -> None:
    """Raise PluginError, with file and line of each, where the model declares a unit or quantity that cannot be read.

    This is asked when a model is used, for it needs the table of units; what guests add is not held against the model.
    """
    guests = {added.what for added in offer.added}
    unread = [quantity for quantity in unread_quantities(offer.model) if quantity.owner not in guests]
    if not unread:
        return
    homes = [*_homes(offer.origin), *filter(None, [home_of(offer.model.function)])]
    said = []
    for quantity in dict.fromkeys(unread):
        file, line = line_of_words(dict.fromkeys(homes), quantity.owner, quantity.written)
        source_line = (file, line) if file else line_of(offer.model.function)
        origin = offer.origin
        said.append(str(Broken(origin.name, origin.version, *source_line, f"DeclarationError: {quantity.sentence}")))
    raise PluginError("\n".join(said))


def _giving(plugin: ModuleType) -> Callable[[], ModuleType]:
    return lambda: plugin


def _with(model: Model[Any, Any], hook: str, addition: Any) -> Model[Any, Any]:
    """Return the model with what one hook adds; raises DeclarationError where it does not fit."""
    if hook == "truing_error_sources":
        if not isinstance(addition, (Tolerance, Correlated, Effect)):
            raise DeclarationError(f"{addition!r:.60} is neither a Tolerance nor an Effect")
        return replace(model, errors=[*model.errors, addition])
    if hook == "truing_objectives":
        return replace(model, objectives=[*model.objectives, addition])
    if not isinstance(addition, Section):
        raise DeclarationError(f"{addition!r:.60} is no Section")
    return replace(model, sheet=[*model.sheet, addition])


def _origin(entry: metadata.EntryPoint) -> Origin:
    version = entry.dist.version if entry.dist is not None else ""
    return Origin(entry.name, version, distribution_of(entry), entry.value, f"entry:{entry.name}")


def _homes(origin: Origin) -> list[Path]:
    """Return where a plugin's own code lies, as far as that is known without running it."""
    file = Path(_file_of(origin))
    if not file.is_file():
        return []
    return [file.parent if file.name == "__init__.py" else file]


def _file_of(origin: Origin) -> str:
    """Return the plugin's file; before it is loaded, the one its entry point would import."""
    if Path(origin.file).is_file():
        return origin.file
    try:
        spec = importlib.util.find_spec(origin.file.partition(":")[0].partition(".")[0])
    except (ImportError, ValueError):
        return origin.file
    return (spec.origin if spec is not None else None) or origin.file


def _name_of(addition: Any) -> str:
    return str(
        getattr(addition, "name", None)
        or getattr(addition, "title", None)
        or getattr(addition, "result", None)
        or addition
    )


def kernel_for(ref: str, *, strict: bool = False) -> Kernel:
    """Return the kernel that knows the plugin of this ``Origin.ref``, in another process too.

    An installed plugin and a single file stand beside everything installed; modules stand alone, as they were given.
    """
    kind, _, value = ref.partition(":")
    if kind == "module":
        return Kernel([import_module(name) for name in value.split(",")], strict=strict)
    kernel = Kernel.installed(strict=strict)
    if kind == "file":
        kernel.add_file(Path(value))
    return kernel


# From a word to a model: an installed plugin's name, "plugin.model", or the path of a plugin in one file


def offer_of(word: str, say: Callable[[str], None], *, strict: bool = False) -> Offer:
    """Return the model that ``word`` names, after saying which plugins beside it were left out.

    Raises UnknownPluginError where there is no such model, PluginError where the plugin that is named is broken.
    """
    kernel = Kernel.installed(strict=strict)
    wanted = word
    if word.endswith(".py"):
        if not Path(word).is_file():
            raise UnknownPluginError(f"{word}: no such file")
        wanted = kernel.add_file(Path(word)).name
    offers = kernel.offers
    for broken in kernel.broken:
        if broken.plugin != wanted or wanted in offers:
            say(str(broken))
    if word.endswith(".py"):
        own = [offer for offer in offers.values() if offer.origin.name == wanted]
        if len(own) == 1:
            demand_readable(own[0])
            return own[0]
        if len(own) > 1:
            names = ", ".join(offer.model.name for offer in own)
            raise UnknownPluginError(f"{word} offers several models ({names}); a file that is run offers one")
    plugin, _, model = wanted.partition(".")
    is_named_whole = wanted not in offers and model in offers and offers[model].origin.name == plugin
    return kernel.offer(model if is_named_whole else wanted)
