"""What was found and where, as data, as the contract's JSON, and as an engineer would say it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

Gear = Literal["driving", "driven"]

OF_THE_READINGS = "the rounding of the readings"
"""What an entry comes with that coarse readings may have made: no place of its own."""

EVERY_MESH_KINDS = ("mesh_order", "mesh_phase")
"""Kinds of entries about what is the same at every mesh."""

Kind = Literal["shaft_order", "mesh_order", "time", "drift", "step", "tooth", "mesh_phase", "condition"]

IN_TIME = ("time", "drift", "step")
"""Kinds of entries that are told by when they are: a wave or a burst, a slow course, a jump."""


@dataclass(frozen=True, kw_only=True)
class Cause:
    """A physics that may be behind an entry, with its ``probability`` there and the sizes that it would have; ``says``
    it as a sentence."""

    physics: str
    gear: Gear | None
    probability: float
    parameters: tuple[tuple[str, float], ...]
    says: str

    def to_json(self) -> dict[str, object]:
        """The cause under the contract's keys."""
        out: dict[str, object] = {"physics": self.physics}
        if self.gear is not None:
            out["gear"] = self.gear
        sizes = {name: {"value": value} for name, value in self.parameters}
        return out | {"probability": self.probability, "parameters": sizes}


@dataclass(frozen=True, kw_only=True)
class Curve:
    """The own deviation of a flank, of one ``tooth`` or of all (None) of ``gear`` 0 (driving) or 1: ``deviation_um`` at
    ``roll_length_mm``, each with its standard error."""

    gear: int
    tooth: int | None
    flank: str
    roll_length_mm: tuple[float, ...]
    deviation_um: tuple[float, ...]
    std_um: tuple[float, ...]

    def to_json(self) -> dict[str, object]:
        """The curve, for JSON."""
        names = ("roll_length_mm", "deviation_um", "std_um")
        return {"flank": self.flank} | {name: [round(v, 4) for v in getattr(self, name)] for name in names}


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One place where recordings and simulation differ. Sizes in um (these go to the edge), angles in deg.

    ``kind`` as in the contract. ``amplitude_um`` with ``std_um``; ``rms_um`` where a shape has no single amplitude.
    ``order`` of the shaft of ``gear``, or of the mesh; ``hz``; ``time_s`` of a jump, or ``driving_turn`` since the
    beginning where no time was recorded; ``during_s``, ``during_turns`` (begin, end) of a burst likewise; ``tooth``,
    ``encoder_deg``; ``rise`` of a jump, how long it takes, in the unit of its moment; ``phase`` (begin, end) in pitches
    from the pitch point; ``recordings`` in which it was found.
    ``p_value`` bounds the chance that any such entry arises from noise anywhere in the search. ``companion_of`` the
    order or tooth that it comes along with; ``rivals`` other readings of the same evidence, in words. ``phase_deg`` of
    a wave: it is amplitude cos(order theta - phase). ``label`` a plain word for the kind of wave. ``aliases`` the
    next frequencies (Hz, or orders) that even samples show alike. ``together``: it stands out only with others like it.
    ``as_built``: teeth within what inspection or grade leave open could make it. ``probability`` that it is there at
    all and ``could_be``, the physics that may make it, where explanations were weighed; ``curves`` of the flanks, as
    they stand in the fitted file. ``parts``: what other parts
    of the drive, which the pair file states, have a line there, in words. ``turning_um``: of what recordings differ by,
    what turns with shafts and teeth, rms.
    """

    kind: Kind
    p_value: float
    recordings: tuple[int, ...]
    gear: Gear | None = None
    order: float | None = None
    order_std: float | None = None
    hz: float | None = None
    hz_std: float | None = None
    time_s: float | None = None
    time_s_std: float | None = None
    driving_turn: float | None = None
    driving_turn_std: float | None = None
    rise: float = 0.0
    during_s: tuple[float, float] | None = None
    during_turns: tuple[float, float] | None = None
    amplitude_um: float | None = None
    std_um: float | None = None
    rms_um: float | None = None
    amplitude_um_by_recording: tuple[float, ...] | None = None
    phase_deg: float | None = None
    tooth: int | None = None
    encoder_deg: float | None = None
    phase: tuple[float, float] | None = None
    label: str = ""
    companion_of: str | None = None
    rivals: tuple[str, ...] = ()
    aliases: tuple[float, ...] = ()
    gain: float = 0.0
    together: bool = False
    as_built: bool = False
    probability: float | None = None
    could_be: tuple[Cause, ...] = ()
    curves: tuple[Curve, ...] = ()
    parts: tuple[str, ...] = ()
    turning_um: float | None = None

    @property
    def moment(self) -> str | None:
        """When a jump happened, in words; ``None`` where the entry is none."""
        if self.time_s is not None:
            return f"{_figures(self.time_s, self.time_s_std)} s"
        if self.driving_turn is not None:
            return f"turn {_figures(self.driving_turn, self.driving_turn_std)} of the driving shaft"
        return None

    @property
    def burst(self) -> str | None:
        """From when to when a burst lasts, in words; ``None`` where the entry is none."""
        if self.during_s is not None:
            return f"from {self.during_s[0]:.4g} to {self.during_s[1]:.4g} s"
        if self.during_turns is not None:
            return f"from turn {self.during_turns[0]:.4g} to {self.during_turns[1]:.4g} of the driving shaft"
        return None

    @property
    def drift(self) -> bool:
        """Whether it is a slow course."""
        return self.kind == "drift"

    @property
    def of_the_pair(self) -> bool:
        """Whether it is at an order that the pair itself makes: a whole one of a shaft, or the mesh's."""
        return self.kind in ("shaft_order", "mesh_order") and self.order_std is None

    def mean_square(self, z_1: int, z_2: int) -> float:
        """What it adds to the mean square of a recording's mismatch, um^2: a tooth or a stretch of every mesh only
        while it is in contact; a jump as if it were half way."""
        size = self.rms_um if self.rms_um is not None else abs(self.amplitude_um or 0.0) / math.sqrt(2.0)
        if self.kind == "tooth":
            low, high = self.phase or (0.0, 1.0)
            return size**2 * (high - low) / (z_1 if self.gear == "driving" else z_2)
        if self.kind == "mesh_phase" and self.phase is not None:
            return size**2 * ((self.phase[1] - self.phase[0]) % 1.0)
        return size**2

    def turned_round(self, turns: float) -> Entry:
        """What was found with time counting back from 0, as the recording of ``turns`` driving turns has it, or the
        other way round: a step up is then one down."""
        if self.kind not in IN_TIME:
            return self
        jump = self.kind == "step"
        return replace(
            self,
            time_s=None if self.time_s is None else -self.time_s,
            driving_turn=None if self.driving_turn is None else turns - self.driving_turn,
            during_s=None if self.during_s is None else (-self.during_s[1], -self.during_s[0]),
            during_turns=None
            if self.during_turns is None
            else (turns - self.during_turns[1], turns - self.during_turns[0]),
            amplitude_um=-self.amplitude_um if jump and self.amplitude_um is not None else self.amplitude_um,
            phase_deg=None if self.phase_deg is None else -self.phase_deg,
        )

    def to_json(self) -> dict[str, object]:
        """The entry under the contract's keys; what does not apply is left out, but a tooth's number may be null."""
        out: dict[str, object] = {"kind": self.kind}
        names = (
            "gear", "order", "order_std", "hz", "hz_std", "time_s", "time_s_std", "driving_turn", "driving_turn_std",
            "during_s", "during_turns",
            "amplitude_um", "std_um", "rms_um", "amplitude_um_by_recording", "phase_deg", "encoder_deg", "phase",
            "label", "companion_of", "aliases", "p_value",
        )  # fmt: skip
        if self.kind == "tooth":
            out["gear"] = self.gear
            out["tooth"] = self.tooth
        for name in names:
            value = getattr(self, name)
            if value is None or value in ("", ()):
                continue
            if name == "order" and float(value).is_integer():
                value = int(value)
            out[name] = list(value) if isinstance(value, tuple) else value
        out["recordings"] = list(self.recordings)
        if self.as_built:
            out["as_built"] = True
        if self.probability is not None:
            out["probability"] = self.probability
        if self.could_be:
            out["could_be"] = [one.to_json() for one in self.could_be]
        if self.curves:
            out["flank_curves"] = [one.to_json() for one in self.curves]
        if self.rivals:
            out["rivals"] = list(self.rivals)
        if self.parts:
            out["also_turns"] = list(self.parts)
        return out


def _digits(std: float) -> int:
    """Decimals that show one figure of a standard error, two where it begins with 1."""
    return 2 if std <= 0.0 else max(0, min(4, -math.floor(math.log10(std)) + (1 if f"{std:e}"[0] == "1" else 0)))


def _figures(value: float, std: float | None) -> str:
    """A value with as many decimals as its standard error has."""
    return f"{value:.{_digits(std or 0.0)}f}"


def _size(entry: Entry) -> str:
    if entry.amplitude_um is None or entry.std_um is None:
        return f"{entry.rms_um:.2g} um rms"
    digits = _digits(entry.std_um)
    return f"{abs(entry.amplitude_um):.{digits}f} +- {entry.std_um:.{digits}f} um"


def _side(phase: tuple[float, float]) -> str:
    low, high = phase
    if high <= 0.15:
        return "entry side"
    if low >= -0.15:
        return "exit side"
    return "whole contact" if high - low > 0.8 else "about the pitch point"


def named(entry: Entry) -> str:
    """A few words for an entry."""
    if entry.kind == "tooth":
        return f"a tooth of the {entry.gear} gear" if entry.tooth is None else f"{entry.gear} tooth {entry.tooth}"
    if entry.kind == "drift":
        return "drift"
    if entry.kind == "step":
        return f"the jump at {entry.moment}"
    if entry.kind == "time":
        return f"{entry.hz:.4g} Hz" if entry.burst is None else f"the burst {entry.burst}"
    if entry.kind == "condition":
        return f"the change of condition in recording {entry.recordings[0]}"
    if entry.kind == "mesh_phase":
        return "the mean tooth's shape"
    if entry.kind == "mesh_order":
        return f"mesh order {entry.order:.0f}"
    return f"order {entry.order:.4g} of the {entry.gear} shaft"


def _both(parts: tuple[str, ...]) -> str:
    return f"{' and '.join(parts)} fall{'s' if len(parts) == 1 else ''}"


def chance_words(probability: float) -> str:
    """A probability as so many in 100."""
    if probability > 0.995:
        return "more than 99 in 100"
    if probability < 0.005:
        return "less than 1 in 100"
    return f"{100.0 * probability:.0f} in 100"


def causes(entry: Entry) -> str:
    """What may be behind an entry, each with its probability, or nothing where that was not weighed."""
    if not entry.could_be:
        return ""
    told = [
        f"{one.physics.replace('_', ' ')}{'' if one.gear is None else f' of the {one.gear} gear'} "
        f"({chance_words(one.probability)})"
        for one in entry.could_be[:MOST_CAUSES]
    ]
    known = sum(one.probability for one in entry.could_be)
    unknown = max(0.0, (1.0 if entry.probability is None else entry.probability) - known)
    return f"could be {', '.join(told)}, or a cause outside the catalogue ({chance_words(unknown)})"


MOST_CAUSES = 3
"""Causes of one place that are told in words; the rest stands in the JSON."""


def says(entry: Entry) -> str:
    """One sentence, as an engineer would say it."""
    size = _size(entry)
    extra = f" ({entry.label})" if entry.label else ""
    if entry.parts:
        extra += f", where {_both(entry.parts)} too" if entry.of_the_pair else f": {' or '.join(entry.parts)}"
    if entry.as_built:
        extra += ", which teeth could hold within what inspection or grade leave open"
    if entry.companion_of:
        extra += f", comes with {entry.companion_of}"
    if entry.rivals:
        extra += "; or " + ", or ".join(entry.rivals)
    if entry.could_be:
        extra += f"; {causes(entry)}"
    if entry.aliases and (entry.hz_std is not None or entry.order_std is not None):
        shown = f"{entry.aliases[0]:.6g} Hz" if entry.kind == "time" else f"order {entry.aliases[0]:.6g}"
        extra += f"; {shown} would look the same in samples so even"
    if entry.kind == "tooth":
        if entry.tooth is None:
            name = f"a tooth of the {entry.gear} gear (numbering unknown)"
        else:
            name = f"{entry.gear} tooth {entry.tooth}"
        side = f", {_side(entry.phase)}" if entry.phase else ""
        sense = "" if entry.amplitude_um is None else (" low" if entry.amplitude_um < 0.0 else " high")
        where = "" if entry.encoder_deg is None else f", at {entry.encoder_deg:.0f} deg of its encoder"
        return f"{name}{side}, {size}{sense}{where}{extra}"
    if entry.kind == "shaft_order":
        order = entry.order or 0.0
        shown = f"{order:.0f}" if float(order).is_integer() else f"{order:.4g}"
        return f"order {shown} of the {entry.gear} shaft, {size}{extra}"
    if entry.kind == "mesh_order":
        return f"mesh order {entry.order:.0f}, {size}{extra}"
    if entry.kind == "step":
        sign = "-" if (entry.amplitude_um or 0.0) < 0.0 else "+"
        extra = extra.removeprefix(f" ({entry.label})")
        return f"a jump by {sign}{size} at {entry.moment} of recording {entry.recordings[0]}{extra}"
    if entry.kind == "drift":
        if len(entry.recordings) > 1:
            which = " and ".join(str(k) for k in entry.recordings)
            return f"a slow course over the arc of recordings {which}, {size} in each{extra}"
        return f"a slow drift over recording {entry.recordings[0]}, {size}{extra}"
    if entry.kind == "time":
        if entry.burst is not None:
            tone = "" if entry.hz is None else f", ringing at {entry.hz:.3g} Hz"
            extra = extra.removeprefix(f" ({entry.label})")
            return f"a burst of {size} {entry.burst} of recording {entry.recordings[0]}{tone}{extra}"
        return f"{entry.hz:.4g} Hz, fixed in time, {size}{extra}"
    if entry.kind == "mesh_phase" and entry.phase is not None:
        low, high = entry.phase
        return f"every mesh, from {low:.2f} to {high:.2f} of a pitch after the pitch point, {size}{extra}"
    which = " and ".join(str(k) for k in entry.recordings)
    plural = "s" if len(entry.recordings) > 1 else ""
    return f"recording{plural} {which} against the others of the set, {size}{extra}"
