"""What can be kept of each pair: names with their units, what they need, and how they come from the pair's curves."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearpoly.arguments import GEARS
from gearpoly.errors import OutOfRangeError
from gearpoly.files.traces import nearest
from gearpoly.mesh.pair import GearPair
from gearpoly.study.composite import grade_of, own_curve, tooth_composite, total_composite
from gearpoly.units import ARCMIN, UM, URAD, FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Curves:
    """One pair as it ran: ``te`` (N,) in rad, loaded where there is load, and what else was asked for.

    ``j_bn`` (N,) normal backlash in mm; ``contact_ratio`` mean number of touching pairs; ``share`` and ``force``
    (rows,) of the carrying contacts, force in N; ``stiffness`` (N,) in N/mm. ``editions`` of ISO 1328-1 by gear.
    """

    pair: GearPair
    te: FloatArray
    per_mesh: int
    editions: tuple[int, int]
    j_bn: FloatArray | None = None
    contact_ratio: float | None = None
    share: FloatArray | None = None
    force: FloatArray | None = None
    stiffness: FloatArray | None = None

    @cached_property
    def lines(self) -> npt.NDArray[np.complex128]:
        """Fourier lines of TE along the line of action in um, of which line k makes k waves in the whole run."""
        return np.asarray(np.fft.rfft(self.te * self.pair.r_b2 / UM) / (0.5 * self.te.size))

    @property
    def meshes(self) -> int:
        """Whole meshes in the run."""
        return self.te.size // self.per_mesh

    def line(self, waves: float) -> float:
        """Amplitude in um of what makes so many waves in the run; 0 where there is no such line."""
        k = round(waves)
        return float(np.abs(self.lines[k])) if 0 < k < self.lines.size else 0.0

    def teeth(self, gear: int) -> int:
        """Teeth of gear 0 (driving) or 1."""
        return (self.pair.driving, self.pair.driven)[gear].gear.z

    def own(self, gear: int) -> FloatArray:
        """The gear's own TE over one revolution, mm along the line of action."""
        return own_curve(self.te * self.pair.r_b2, z=self.teeth(gear), per_mesh=self.per_mesh)


@dataclass(frozen=True, kw_only=True)
class Output:
    """One thing that is kept: what it ``needs`` ("coast", "count", "load", "cycle", "meshes") and how it is read."""

    says: str
    unit: str
    read: Callable[[Curves], float]
    needs: frozenset[str] = frozenset()


def _known(array: FloatArray | None) -> FloatArray:
    return np.array([math.nan]) if array is None or array.size == 0 else array


def _plain() -> dict[str, Output]:
    coast, load = frozenset({"coast"}), frozenset({"load"})
    out = {
        "te_pp_um": Output(
            says="peak-to-peak TE along the line of action",
            unit="um",
            read=lambda c: float(np.ptp(c.te)) * c.pair.r_b2 / UM,
        ),
        "te_mean_um": Output(
            says="mean TE along the line of action", unit="um", read=lambda c: float(np.mean(c.te)) * c.pair.r_b2 / UM
        ),
        "te_rms_um": Output(
            says="standard deviation of TE along the line of action",
            unit="um",
            read=lambda c: float(np.std(c.te)) * c.pair.r_b2 / UM,
        ),
        "backlash_least_um": Output(
            says="least normal backlash", unit="um", read=lambda c: float(np.min(_known(c.j_bn))) / UM, needs=coast
        ),
        "backlash_mean_um": Output(
            says="mean normal backlash", unit="um", read=lambda c: float(np.mean(_known(c.j_bn))) / UM, needs=coast
        ),
        "backlash_most_um": Output(
            says="greatest normal backlash", unit="um", read=lambda c: float(np.max(_known(c.j_bn))) / UM, needs=coast
        ),
        "contact_ratio": Output(
            says="mean number of touching pairs",
            unit="",
            read=lambda c: math.nan if c.contact_ratio is None else c.contact_ratio,
            needs=frozenset({"count"}),
        ),
        "load_share_peak": Output(
            says="largest share of the load on one tooth pair",
            unit="",
            read=lambda c: float(np.max(_known(c.share))),
            needs=load,
        ),
        "force_peak_n": Output(
            says="largest normal force on a tooth", unit="N", read=lambda c: float(np.max(_known(c.force))), needs=load
        ),
        "mesh_stiffness_mean_n_per_um": Output(
            says="mean tangent mesh stiffness",
            unit="N/um",
            read=lambda c: float(np.mean(_known(c.stiffness))) * UM,
            needs=load,
        ),
    }
    out |= _angles()
    cycle = frozenset({"cycle"})
    for k, gear in enumerate(GEARS):
        for which, name in enumerate(("F_i", "f_i")):
            says = ("total", "tooth-to-tooth")[which] + f" single-flank composite deviation of the {gear} gear"
            read = _composite(k, which)
            out[f"{name}_{gear}_um"] = Output(says=says, unit="um", read=_in_um(read), needs=cycle)
            out[f"{name}_{gear}_grade"] = Output(
                says=f"ISO 1328-1 grade that allows the {says}", unit="", read=_graded(k, which, read), needs=cycle
            )
    return out


def _angles() -> dict[str, Output]:
    """What is an angle, on both shafts: a length along the line of action over that gear's base radius."""
    out = {}
    for k, gear in enumerate(GEARS):
        shaft = f"of the {gear} shaft ({('input', 'output')[k]})"
        for unit, size in (("urad", URAD), ("arcmin", ARCMIN)):
            out[f"te_pp_{gear}_{unit}"] = Output(
                says=f"peak-to-peak TE as an angle {shaft}",
                unit=unit,
                read=_angle(k, size, lambda c: np.ptp(_te_mm(c))),
            )
        for name, kind, of in (("least", "least", np.min), ("mean", "mean", np.mean), ("most", "greatest", np.max)):
            out[f"lost_motion_{name}_{gear}_arcmin"] = Output(
                says=f"{kind} lost motion {shaft}, the other one held",
                unit="arcmin",
                read=_angle(k, ARCMIN, _backlash(of)),
                needs=frozenset({"coast"}),
            )
    return out


def _te_mm(c: Curves) -> FloatArray:
    """TE (N,) in mm along the line of action."""
    return c.te * c.pair.r_b2


def _backlash(of: Callable[[FloatArray], float]) -> Callable[[Curves], float]:
    return lambda c: of(_known(c.j_bn))


def _angle(gear: int, size: float, read: Callable[[Curves], float]) -> Callable[[Curves], float]:
    """What is read in mm along the line of action as the angle of a gear's shaft, in units of ``size`` rad."""
    return lambda c: float(read(c)) / (c.pair.r_b1, c.pair.r_b2)[gear] / size


def _composite(gear: int, which: int) -> Callable[[Curves], float]:
    def read(c: Curves) -> float:
        curve = c.own(gear)
        return total_composite(curve) if which == 0 else tooth_composite(curve, per_mesh=c.per_mesh)

    return read


def _in_um(read: Callable[[Curves], float]) -> Callable[[Curves], float]:
    """What is read in mm, in um."""
    return lambda c: read(c) / UM


def _graded(gear: int, which: int, read: Callable[[Curves], float]) -> Callable[[Curves], float]:
    def grade(c: Curves) -> float:
        mine = (c.pair.driving, c.pair.driven)[gear].gear
        return grade_of(
            read(c), which, d=2.0 * mine.r, m=mine.m, edition=c.editions[gear], eps_alpha=max(c.pair.eps_alpha, 1.0)
        )

    return grade


PLAIN = _plain()
PATTERNS = ("mesh_order_N_um", "shaft_order_driving_N_um", "shaft_order_driven_N_um", "side_band_driving_N_um",
            "side_band_driven_N_um")  # fmt: skip
_PATTERN = re.compile(r"^(mesh_order|(?:shaft_order|side_band)_(driving|driven))_([1-9][0-9]{0,3})_um$")


def output(name: str) -> Output:
    """The output of this name. Raises ``OutOfRangeError`` with the nearest one where there is none."""
    if name in PLAIN:
        return PLAIN[name]
    match = _PATTERN.match(name)
    if match is None:
        # An angle without its shaft is no output: which of the two was meant, only its writer knows.
        bare, _, unit = name.rpartition("_")
        both = [f"{bare}_{gear}_{unit}" for gear in GEARS]
        if all(one in PLAIN for one in both):
            raise OutOfRangeError(f'"{name}" does not say of which shaft; want "{both[0]}" or "{both[1]}"')
        close = nearest(name, [*PLAIN, *PATTERNS])
        raise OutOfRangeError(f'there is no output "{name}"; the nearest is "{close}" (N: 1, 2, ...)')
    n = int(match[3])
    if match[2] is None:
        return Output(
            says=f"amplitude of mesh order {n}",
            unit="um",
            read=lambda c: c.line(n * c.meshes),
            needs=frozenset({"meshes"}),
        )
    gear, kind = GEARS.index(match[2]), match[1].split("_", 1)[0]

    def shaft(c: Curves) -> float:
        return c.line(n * c.meshes / c.teeth(gear))

    def side(c: Curves) -> float:
        apart = n * c.meshes / c.teeth(gear)
        return math.hypot(c.line(c.meshes - apart), c.line(c.meshes + apart))

    says = f"amplitude of {match[2]} shaft order {n}"
    if kind == "side":
        says = f"side bands of mesh order 1, {n} {match[2]} shaft order{'s' * (n > 1)} away (root sum of squares)"
    return Output(says=says, unit="um", read=side if kind == "side" else shaft, needs=frozenset({"cycle"}))


def describe(name: str) -> str:
    """What the output ``name`` is, with its unit."""
    one = output(name)
    return f"{one.says}, {one.unit}" if one.unit else one.says


def check_output(name: str, *, whole_cycle: bool, positions_per_mesh: int) -> None:
    """Raise ``OutOfRangeError`` where ``name`` is no output, or cannot be had from the positions that are asked for."""
    needs = output(name).needs
    if not whole_cycle and needs & {"cycle", "meshes"}:
        raise OutOfRangeError(f'"{name}" needs a whole hunting cycle; leave out turns, or this output')
    match = _PATTERN.match(name)
    if match and match[1] == "mesh_order" and 2 * int(match[3]) >= positions_per_mesh:
        raise OutOfRangeError(
            f'"{name}" needs more than {2 * int(match[3])} positions_per_mesh, found {positions_per_mesh}'
        )


def needs_of(names: Iterable[str]) -> frozenset[str]:
    """Everything that the outputs ``names`` need together."""
    return frozenset().union(*(output(name).needs for name in names))
