"""The truth of a case, as the scorer reads it."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.toml import parse
from gearpoly.files.traces import read_text
from gearpoly.physics import catalogue
from gearpoly.prove.fields import Fields
from gearpoly.prove.thresholds import Thresholds
from gearpoly.proving.physics import CATALOGUE, PHYSICS_BY_NAME

SIZE_PARAMETERS = {name: PHYSICS_BY_NAME[name].size for name in CATALOGUE} | {
    one.twin: one.parameters[0] for one in catalogue().values()
}
"""The parameter that says how much of it there is, of every physics of the catalogue."""

FROM_ONE = tuple(name for name in CATALOGUE if PHYSICS_BY_NAME[name].from_one)
"""Physics whose size counts from 1."""

WRONG_FILE = "wrong_file"
"""Kind of a case whose files say what is not so: nothing may be named, and that is to be said."""

COLOURED = 0.6
"""AR(1) coefficient from which on noise that is not whitened raises a false alarm in every healthy pair."""

DETECTED = 7.0
"""Size over the limit from which on a wrong statement is to be noticed, as ``detection`` of the thresholds has it."""

BESIDE_SIZE = ("angle_deg", "length_mm", "from_mm", "to_mm", "damping_ratio")
"""Parameters beside the size of which truths may tell."""


@dataclass(frozen=True, kw_only=True)
class MistakenFor:
    """What an effect may be mistaken for: ``separability`` is how far it is left over the effect's size (of small
    signals the sine of the angle between them), ``apart`` what they differ by in um rms (None: not known)."""

    physics: str
    gear: str | None
    separability: float
    apart: float | None = None


@dataclass(frozen=True, kw_only=True)
class NoCause:
    """What has no cause, as a rival at an effect's place: ``separability`` by the odds that so many standard deviations
    correspond to, ``left`` by distance alone, with the unknown's freedoms at no cost."""

    separability: float
    left: float


@dataclass(frozen=True, kw_only=True)
class Item:
    """One effect concealed in a case, or a place where something is.

    ``physics`` by the contract's name, ``shape`` for one outside the catalogue (then ``physics`` is empty); ``gear``,
    ``teeth`` of it, ``tooth`` and ``encoder_deg`` where they are; ``order``; ``hz``, and ``images_hz`` and ``aliases``
    (orders) at which even samples show it alike; ``parameters`` in the contract's units; ``over_limit`` its size over
    the theoretical limit (infinite: not known) and its ``rivals``, the ``unknown`` among them (None: the truth does
    not say how near that comes). ``kind``: of the entry of a verdict that would stand at the place ("any": each would).
    """

    physics: str
    shape: str = ""
    gear: str | None = None
    tooth: int | None = None
    teeth: int | None = None
    encoder_deg: float | None = None
    order: float | None = None
    hz: float | None = None
    images_hz: tuple[float, ...] = ()
    aliases: tuple[float, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)
    over_limit: float = math.inf
    rivals: tuple[MistakenFor, ...] = ()
    unknown: NoCause | None = None
    kind: str = ""

    @property
    def label(self) -> str:
        """What and where in a few words."""
        words = [self.physics or self.shape or "unknown"]
        if self.gear:
            words.append(self.gear)
        if self.tooth is not None:
            words.append(f"tooth {self.tooth}")
        if self.order is not None:
            words.append(f"order {self.order:g}")
        return " ".join(words)

    def separation(self, rival: MistakenFor) -> float:
        """Standard deviations by which the recordings tell a rival from this."""
        return rival.separability * self.over_limit if rival.separability else 0.0

    def acceptable(self, limits: Thresholds) -> tuple[MistakenFor, ...]:
        """Rivals within the evidence: those that the recordings do not tell from this, or that no model would."""
        return tuple(
            rival for rival in self.rivals
            if self.separation(rival) < limits.within or (rival.apart is not None and rival.apart < limits.floor_um)
        )  # fmt: skip

    def separable(self, limits: Thresholds) -> bool:
        """Whether size over limit, alone and times the separability of the nearest rival, is large enough that this
        has to be named, first."""
        nearest = min([self.over_limit, *(self.separation(rival) for rival in self.rivals)])
        unlike = all(rival.apart is None or rival.apart >= limits.floor_um for rival in self.rivals)
        return nearest > limits.separable and unlike

    def earned(self, limits: Thresholds) -> bool | None:
        """Whether it has to be named though something without a cause may do the same; None: not known."""
        if self.unknown is None:
            return None
        return self.separable(limits) and self.unknown.separability * self.over_limit > limits.separable

    def seen_by_shape(self, limits: Thresholds) -> bool | None:
        """The same, and by what no unknown can make whatever its freedoms cost."""
        if self.unknown is None:
            return None
        return bool(self.earned(limits)) and self.unknown.left * self.over_limit > limits.separable

    def alike(self, limits: Thresholds) -> bool:
        """Whether a rival stands so near that naming this alone would be more than the recordings say."""
        return any(self.separation(rival) < limits.true_look_alike for rival in self.rivals)


@dataclass(frozen=True, kw_only=True)
class Truth:
    """The truth of a case: ``kind`` none, missing or unknown; ``klass`` and ``pair`` as the ground names them; the true
    ``noise_um``; ``background``: what else is in the recordings, of no physics of the catalogue; ``z`` teeth of both
    gears; ``depth`` of all effects together: ``over_limit``, ``over_noise`` and
    ``over_what_hides_it``."""

    kind: str
    items: tuple[Item, ...]
    background: tuple[Item, ...]
    klass: str
    pair: str
    noise_um: float
    z: tuple[int, int]
    hunting_cycles: float | None
    depth: dict[str, float]
    concealed_by: str
    may_name: tuple[Item, ...] | None
    """Every name that would not be false; None: what is concealed and its rivals within the evidence."""
    must_name: tuple[Item, ...] | None
    must_locate: tuple[Item, ...] | None
    """What a careful expert could name, and where they would say that something is, if the truth says so itself; None:
    sizes and rivals say it."""
    says: tuple[str, ...]
    """Of a wrong file: words of which a remark or a refusal has to have one; empty where it cannot be known."""
    tempting: bool
    """Whether a large eccentricity is declared and the noise is coloured: what most often looks like more."""

    @property
    def over_limit(self) -> float:
        """Size of all effects together over the theoretical limit; infinite where nobody knows it."""
        return self.depth.get("over_limit", math.inf)


def read_truth(path: Path, *, pair: Path) -> Truth:
    """The truth file at ``path`` of a case whose pair file is ``pair``. Raises ``InputFileError`` for one that is
    none."""
    text = read_text(path)
    try:
        raw = Fields(json.loads(text))
        kind = raw.word("kind")
        items = tuple(_item(one) for one in raw.entries("truth", needed=True))
        background = tuple(_item(one) for one in raw.entries("background"))
        noise = raw.needed("noise_um")
        deep = raw.inner("depth")
        # What each recording shows by itself is a list, and no depth of the whole.
        depth = {name: deep.needed(name) for name, value in deep.raw.items() if not isinstance(value, list)}
        hunting_cycles = raw.number("hunting_cycles")
        klass, called, concealed_by = (raw.word(key, "") for key in ("class", "pair", "concealed_by"))
        declared_um = raw.numbers("declared_eccentricity_um")
        colour = raw.number("noise_colour") or 0.0
        names = tuple(_item(one) for one in raw.entries("may_name"))
        must_name = tuple(_item(one) for one in raw.entries("must_name")) if "must_name" in raw.raw else None
        must_locate = tuple(_place(one) for one in raw.entries("must_locate")) if "must_locate" in raw.raw else None
        says = _says(raw.inner("file"))
    except (ValueError, RecursionError) as error:
        wish = "want a truth file with kind, truth and noise_um"
        raise InputFileError(path, found=f"no truth ({error})", wish=wish) from None
    _check_kind(path, kind, items)
    if kind == "missing":  # what has a shape only lies beside what has a name
        background += tuple(one for one in items if not one.physics)
        items = tuple(one for one in items if one.physics)
        if not items:
            raise InputFileError(path, where="truth", found="no physics", wish="want one, or kind none or unknown")
    for one in background:
        if one.physics or (one.order is None and one.hz is None):
            wish = "want waves of no physics: order and gear, or hz"
            raise InputFileError(path, where="background", found=repr(one.label), wish=wish)
    called, z = _declared(pair, called=called)
    return Truth(
        kind=kind,
        items=items,
        background=background,
        klass=klass or kind,
        pair=called,
        noise_um=noise,
        z=z,
        hunting_cycles=hunting_cycles,
        depth=depth,
        concealed_by=concealed_by,
        may_name=names if "may_name" in raw.raw else None,
        must_name=must_name,
        must_locate=must_locate,
        says=says,
        tempting=any(declared_um) and colour >= COLOURED,
    )


def _check_kind(path: Path, kind: str, items: tuple[Item, ...]) -> None:
    """Raise ``InputFileError`` for a kind of truth that there is not, or a physics that no bench hides."""
    if kind not in ("none", "missing", "unknown", WRONG_FILE):
        raise InputFileError(path, where="kind", found=repr(kind), wish=f"want none, missing, unknown or {WRONG_FILE}")
    for one in items:
        if kind == "missing" and one.physics and one.physics not in SIZE_PARAMETERS:
            wish = f"want one of {', '.join(SIZE_PARAMETERS)}, or a shape for what is none of them"
            raise InputFileError(path, where="truth.physics", found=repr(one.physics), wish=wish)


def _declared(pair: Path, *, called: str) -> tuple[str, tuple[int, int]]:
    """Name of a pair, its file's where it is not ``called`` anything, and tooth numbers. Raises ``InputFileError``."""
    try:
        declared = Fields(parse(pair, read_text(pair)))
        name = called or declared.word("name", "")
        z = (int(declared.inner("driving").needed("teeth")), int(declared.inner("driven").needed("teeth")))
    except (ValueError, OverflowError) as error:
        raise InputFileError(
            pair, found=f"no pair file ({error})", wish="want a pair file with driving.teeth and driven.teeth"
        ) from None
    return name, z


def _place(raw: Fields) -> Item:
    """Somewhere that something is."""
    return replace(_item(raw), kind=raw.word("kind", "any"))


def _says(file: Fields) -> tuple[str, ...]:
    """Words for a wrong file whose fault shows by at least ``DETECTED`` times the theoretical limit."""
    over = file.number("over_limit")
    words = tuple(str(word) for word in file.values("says"))
    return words if over is None or over >= DETECTED else ()


def _item(raw: Fields) -> Item:
    physics = raw.word("physics", "")
    names = (SIZE_PARAMETERS.get(physics, ""), *BESIDE_SIZE)
    limit = raw.number("over_limit")
    return Item(
        physics=physics,
        shape=raw.word("shape", "" if physics else "line"),
        gear=raw.gear(),
        tooth=raw.whole("tooth"),
        teeth=raw.whole("teeth"),
        encoder_deg=raw.number("encoder_deg"),
        order=raw.number("order"),
        hz=raw.number("hz"),
        images_hz=raw.numbers("images_hz"),
        aliases=raw.numbers("aliases"),
        parameters={name: value for name in names if (value := raw.number(name)) is not None},
        over_limit=math.inf if limit is None else limit,
        rivals=tuple(
            MistakenFor(
                physics=one.word("physics"),
                gear=one.gear(),
                separability=one.needed("separability"),
                apart=one.number("apart_um"),
            )
            for one in raw.entries("rivals")
        ),
        unknown=_unknown(raw.inner("unknown")) if raw.raw.get("unknown") else None,
    )


def _unknown(raw: Fields) -> NoCause | None:
    """None where an older truth has it by odds alone."""
    left = raw.number("left")
    return None if left is None else NoCause(separability=raw.needed("separability"), left=left)
