"""Physics, readers and exporters that other installed packages bring, by the entry points of their metadata.

Only names are read here. A package is imported when its physics, its readers or its exporters are first asked for.
Whatever it gets wrong becomes one ``PluginError`` that names the package and its entry point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module, metadata
from typing import Any

from gearpoly.errors import GearpolyError, PluginError

PHYSICS_GROUP, READERS_GROUP, EXPORTERS_GROUP = GROUPS = ("gearpoly.physics", "gearpoly.readers", "gearpoly.exporters")


@dataclass(frozen=True, kw_only=True)
class Plugin:
    """One entry point: its ``group`` and ``name``, the ``module`` and the ``attribute`` in it (empty: the module
    itself), and which ``version`` of which ``package`` it came with."""

    group: str
    name: str
    module: str
    attribute: str
    package: str
    version: str

    @property
    def value(self) -> str:
        """Module and attribute as metadata write them."""
        return f"{self.module}:{self.attribute}" if self.attribute else self.module

    def fault(self, found: str) -> PluginError:
        """The one message about what it got wrong, with the cure."""
        return PluginError(
            f"package {self.package} {self.version}, entry point {self.name} = {self.value} of {self.group}: {found}; "
            f"want another version of {self.package}, or none of it: pip uninstall {self.package}"
        )

    def load(self) -> Any:
        """What stands there. Raises ``PluginError`` where it cannot be imported."""
        found: Any = self.call("it cannot be loaded", import_module, self.module)
        for part in self.attribute.split(".") if self.attribute else ():
            if not hasattr(found, part):
                raise self.fault(f"it cannot be loaded: there is no {part} in {self.module}")
            found = getattr(found, part)
        return found

    def call(self, failed: str, function: Callable[..., Any], *given: Any, **named: Any) -> Any:
        """What its ``function`` gives, a list for what it yields; whatever it raises by mistake becomes a
        ``PluginError`` that says what ``failed``. What it refuses on purpose passes."""
        try:
            made = function(*given, **named)
            return list(made) if isinstance(made, Iterator) else made
        except (GearpolyError, MemoryError):
            raise
        except (Exception, SystemExit) as error:
            last = str(error).strip().splitlines()[-1:] or ["no reason given"]
            raise self.fault(f"{failed}: {type(error).__name__}: {last[0]}") from error

    def guarded(self, what: str, function: Callable[..., Any], kind: type = object) -> Callable[..., Any]:
        """Its ``function`` called ``what``, with its mistakes told, one that gives no ``kind`` among them."""

        def told(*given: Any, **named: Any) -> Any:
            made = self.call(f"its {what} failed", function, *given, **named)
            if not isinstance(made, kind):
                raise self.fault(f"its {what} gave {type(made).__name__}, not {kind.__name__}")
            return made

        return told


def plugins(group: str) -> list[Plugin]:
    """The entry points of a group, in the order of packages and names. Raises ``PluginError`` where one cannot be
    read."""
    return [one for one in installed() if one.group == group]


@cache
def installed() -> tuple[Plugin, ...]:
    """All entry points in gearpoly's groups. Of a package that is found twice on the path the first counts, as for
    imports."""
    found: dict[str, list[Plugin]] = {}
    for package in metadata.distributions():
        try:
            text = package.read_text("entry_points.txt") or ""
        except ValueError:  # no text: whatever it is, it names no group
            continue
        if any(group in text for group in GROUPS):
            name, version = _called(package)
            found.setdefault(name.lower().replace("_", "-"), _points(package, name, version))
    return tuple(sorted((one for mine in found.values() for one in mine), key=lambda one: (one.package, one.name)))


def _called(package: metadata.Distribution) -> tuple[str, str]:
    """Name and version of a package; one without any is called by where it stands."""
    try:
        name, version = package.name, package.version
    except (TypeError, KeyError):
        name, version = None, None
    return name or str(package.locate_file("")), version or "of no version"


def _points(package: metadata.Distribution, name: str, version: str) -> list[Plugin]:
    """The entry points of a package that are in gearpoly's groups."""
    try:
        return [
            Plugin(group=one.group, name=one.name, module=one.module, attribute=one.attr or "", package=name,
                   version=version)
            for one in package.entry_points if one.group in GROUPS
        ]  # fmt: skip
    except (TypeError, AttributeError):
        cure = f"install it anew, or take it out: pip uninstall {name}"
        raise PluginError(f"package {name} {version}: its entry_points.txt is damaged; {cure}") from None
