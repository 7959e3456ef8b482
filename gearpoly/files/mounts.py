"""Telescope mounts whose worm wheel, and perhaps transfer gears, are known: the pair file of one, with its sources."""

from __future__ import annotations

import difflib
import json
import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from gearpoly.errors import InputFileError, shown
from gearpoly.files.toml import load

SIDEREAL_DAY_S = 86164.0905
"""s of mean solar time (IERS Conventions 2010). One turn of the axis, by which a mount follows the stars."""

NEAREST = 5
"""Names that are shown for one that is not known."""

ANY_MODULE_MM = 0.5
"""mm. Stands for the module, which nobody states: sizes in um go with it, sizes in arcsec do not."""


@dataclass(frozen=True, kw_only=True)
class Mount:
    """A mount by its ``names``: teeth of the worm wheel, ``printed_s`` the worm's period as its source prints it, teeth
    of the spur pair before the worm (None: not known), further parts of the drive, and where each comes from."""

    names: tuple[str, ...]
    maker: str
    wheel_teeth: int
    worm_source: tuple[str, ...]
    printed_s: float | None = None
    driving: int | None = None
    driven: int | None = None
    gears_source: tuple[str, ...] = ()
    also_turns: tuple[dict[str, Any], ...] = ()
    note: str = ""

    @property
    def period_s(self) -> float:
        """Seconds per turn of the worm while the mount follows the stars."""
        return SIDEREAL_DAY_S / self.wheel_teeth


@cache
def mounts() -> tuple[Mount, ...]:
    """All mounts that are known."""
    held = load((files("gearpoly") / "data" / "mounts.toml").read_text(encoding="utf-8"))
    sources = held["sources"]

    def one(table: dict[str, Any]) -> Mount:
        lists: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in table.items()
        }
        for key in ("worm_source", "gears_source"):
            lists[key] = tuple(sources[name] for name in table.get(key, ()))
        return Mount(**lists)

    return tuple(one(table) for table in held["mount"])


def find_mount(name: str) -> Mount:
    """The mount of that ``name``, however it is spaced and cased. Raises ``InputFileError`` that lists the nearest
    names where there is none, and all where none was given."""
    by_name = {_plain(known): (known, mount) for mount in mounts() for known in mount.names}
    maker_too = {_plain(f"{mount.maker} {known}"): (known, mount) for mount in mounts() for known in mount.names}
    wanted = _plain(name)
    if wanted in by_name or wanted in maker_too:
        return (by_name.get(wanted) or maker_too[wanted])[1]
    known = ", ".join(name for name, _ in by_name.values())
    if not wanted:
        raise InputFileError("--mount", found="no name", wish=f"want one of {known}")
    close = difflib.get_close_matches(wanted, by_name, n=NEAREST, cutoff=0.5)
    near = ", ".join(by_name[one][0] for one in close)
    wish = f"the nearest known are {near}" if near else f"known are {known}"
    cure = "; or state [worm] wheel_teeth in a pair file of your own (gearpoly pair --new)"
    raise InputFileError("--mount", found=f'no mount "{shown(name)}"', wish=wish + cure)


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def mount_text(mount: Mount) -> str:
    """A pair file of the mount's transfer gears and worm, with what is known from where in comments."""
    worm = f"worm wheel: {mount.wheel_teeth} teeth, so the worm turns once in {mount.period_s:.2f} s"
    if mount.printed_s is not None and abs(mount.printed_s - mount.period_s) > 0.5:
        worm += f" (printed as {mount.printed_s:g} s)"
    known = mount.driving is not None
    gears = f"transfer gears: {mount.driving} teeth drive {mount.driven}" if known else "transfer gears: not known"
    lines = [
        f"# {mount.maker} {mount.names[0]}, for recordings of its right-ascension axis such as guide logs.",
        *_told(worm, mount.worm_source),
        *_told(gears, mount.gears_source),
        *([f"# {mount.note}"] if mount.note else []),
        "# Tell a guide log with: gearpoly compare THIS_FILE LOG",
        "",
        f'name = "{mount.maker} {mount.names[0]}, gears before the worm"',
    ]
    for gear, teeth in (("driving", mount.driving), ("driven", mount.driven)):
        side = "nearer the motor" if gear == "driving" else "that turns with the worm"
        unknown = f"# teeth =             # not known: count those of the gear {side}"
        stated = unknown if teeth is None else f"teeth = {teeth}"
        module = f"module_mm = {ANY_MODULE_MM}   # not known: sizes in um go with it, sizes in arcsec do not"
        lines += ["", f"[{gear}]", stated, module]
    lines += ["", "[worm]", f"wheel_teeth = {mount.wheel_teeth}"]
    for part in mount.also_turns:
        lines += ["", "[[also_turns]]", *(f"{key} = {json.dumps(value)}" for key, value in part.items())]
    return "\n".join(lines) + "\n"


def _told(what: str, sources: tuple[str, ...]) -> list[str]:
    """Comment lines of one fact and where it comes from."""
    return [f"# {what}", *(f"#   from {source}" for source in sources)]
