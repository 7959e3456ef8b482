"""Still pictures of gears: the mesh at a contact, what every tooth deviates by, and the gaps of near pairs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from matplotlib.figure import Figure

from gearpoly.arguments import GEARS
from gearpoly.assemble import Assembled
from gearpoly.gear.deviations import Deviations, Index, Span, total
from gearpoly.gear.gear import Gear
from gearpoly.gear.polygon import rotate, tooth_outline
from gearpoly.mesh.pair import Flank, GearPair, Mounted
from gearpoly.mesh.transmission import FlankContacts, contacts
from gearpoly.report.plots import BLUE, GREEN, GREY, ORANGE, ShownFigure
from gearpoly.units import DEG, UM, BoolArray, FloatArray

CLOSE_UP = 0.06
"""Half width of the close-up in modules: 1 um of gap is a thousandth of it, and the flanks' curvature still shows."""

OVERVIEW = 3.2
"""Half width of the overview in modules: three teeth on either side of the line of centres."""

BODY = 0.7
"""The gears' bodies are shown down to this share of the root radius."""

DRAWN_WITHIN = 60.0 * UM
"""mm. Pairs that would close within this of the first are drawn; it covers the approach of the next pair."""

GAP_PITCHES = 2.0
"""Pitches that the gap curves cover, centred on the driven angle asked for: a pair comes, carries and goes."""

GAP_CURVE_POINTS_PER_PITCH = 120
"""Positions per pitch of the gap curves."""

STYLES = ("-", "--", "-.", ":")
"""Besides colour, line styles tell neighbouring pairs apart."""


PICTURES = ("mesh", "deviations", "gaps")
"""What can be drawn of a pair."""


def pair_figure(assembled: Assembled, what: str, theta_2: float, *, flank: Flank, name: str) -> Figure:
    """One of ``PICTURES`` at driven rotation ``theta_2`` (rad); deviations stand in no rotation."""
    if what == "deviations":
        return deviation_figure(assembled, name=name)
    if what == "gaps":
        return gap_figure(assembled, theta_2, flank=flank, name=name)
    return mesh_figure(assembled, theta_2, flank=flank, name=name)


def mesh_figure(assembled: Assembled, theta_2: float, *, flank: Flank, name: str) -> Figure:
    """The teeth about the line of centres at driven rotation ``theta_2`` (rad), and the leading contact close up."""
    pair = assembled.pair
    found = contacts(pair, np.array([theta_2]), flank=flank, near=DRAWN_WITHIN)
    theta_1 = float((found.theta_2[0] - found.te[0]) / pair.ratio)
    lead = int(np.argmin(found.gap))
    teeth = f"driving tooth {found.driving[lead]} on driven tooth {found.driven[lead]}"
    figure = ShownFigure(figsize=(13.0, 7.2))
    axes = figure.subplots(1, 2)
    # Square panels of fixed size: the automatic layout lets titles run into each other there.
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.08, top=0.88, wspace=0.16)
    m = pair.driving.gear.m
    pitch_point = np.array([pair.a * pair.r_b1 / (pair.r_b1 + pair.r_b2), 0.0])
    rings = {
        names: _teeth(mounted, angle, axis)
        for names, mounted, angle, axis in (
            ("driving", pair.driving, theta_1, 0.0),
            ("driven", pair.driven, -theta_2, pair.a),
        )
    }
    for axis, centre, half in ((axes[0], pitch_point, OVERVIEW * m), (axes[1], found.point[lead], CLOSE_UP * m)):
        _mesh_panel(axis, pair, rings, centre, half, flank)
    axes[0].set_title(
        f"teeth in mesh: {found.pairs[0]} touching, {found.gap.size} within {DRAWN_WITHIN / UM:g} um of it", fontsize=10
    )
    axes[0].set_xlabel("x / mm (driving axis at 0)")
    axes[0].set_ylabel("y / mm")
    for k in range(found.gap.size):
        touch = bool(found.touching[k])
        axes[0].plot(
            *found.point[k],
            marker="o" if touch else "s",
            markersize=8,
            color="black",
            fillstyle="full" if touch else "none",
            linestyle="none",
        )
        says = "touches" if touch else f"gap {found.gap[k] / UM:.3g} um"
        axes[0].annotate(says, found.point[k], textcoords="offset points", xytext=(12, -4), fontsize=9)
    _numbers(axes[0], pair, theta_1, theta_2, pitch_point, OVERVIEW * m)
    _close_up(axes[1], found, lead, teeth)
    figure.suptitle(
        f"{name}: {flank} flanks at driven angle {theta_2 / DEG:g} deg, driving angle {theta_1 / DEG:.6f} deg, "
        f"TE {found.te[0] * pair.r_b2 / UM:.3f} um, unloaded",
        fontsize=11,
    )
    return figure


def _teeth(mounted: Mounted, angle: float, axis: float) -> list[FloatArray]:
    """All teeth (k, 2) in mm, placed, each with its slice of the body."""
    lines = mounted.centre_lines + angle
    centre = rotate(mounted.centre[None], angle)[0] + np.array([axis, 0.0])
    hub, half = BODY * mounted.gear.r_f, 0.5 * mounted.gear.tau
    foot = hub * np.array([[math.cos(half), math.sin(half)], [math.cos(half), -math.sin(half)]])
    return [
        rotate(np.concatenate((tooth_outline(mounted.flanks, k), foot)), float(direction)) + centre
        for k, direction in enumerate(lines.tolist())
    ]


def _mesh_panel(
    axis: Any, pair: GearPair, rings: dict[str, list[FloatArray]], centre: FloatArray, half: float, flank: Flank
) -> None:
    """Material of both gears within ``half`` mm of ``centre``, in um from it where that is close, and the line of
    action."""
    close = half < pair.driving.gear.m
    unit, origin = (UM, centre) if close else (1.0, np.zeros(2))
    frame = shapely.box(*(centre - 1.2 * half), *(centre + 1.2 * half))
    for name, colour, hatch in (("driving", BLUE, "//"), ("driven", ORANGE, "\\\\")):
        for tooth in rings[name]:
            # Only what is seen is drawn: a whole gear has more points than a vector file should hold.
            seen = shapely.intersection(shapely.polygons(tooth), frame)
            if shapely.is_empty(seen):
                continue
            for piece in shapely.get_parts(seen):
                points = (shapely.get_coordinates(piece) - origin) / unit
                axis.fill(
                    *points.T, facecolor=colour, alpha=0.18, hatch=hatch if close else None, edgecolor=colour, lw=0.0
                )
            edge = shapely.intersection(shapely.linestrings(tooth[:-2]), frame)
            for piece in shapely.get_parts(edge) if not shapely.is_empty(edge) else []:
                axis.plot(*((shapely.get_coordinates(piece) - origin) / unit).T, color=colour, linewidth=1.3)
    c, s = math.cos(pair.alpha_w), math.sin(pair.alpha_w)
    side = 1.0 if flank == "drive" else -1.0
    ends = np.array([[pair.r_b1 * c, -side * pair.r_b1 * s], [pair.a - pair.r_b2 * c, side * pair.r_b2 * s]])
    axis.plot(*((ends - origin) / unit).T, color=GREY, linewidth=1.0, linestyle="--", label="line of action")
    low, high = (centre - half - origin) / unit, (centre + half - origin) / unit
    axis.set_xlim(low[0], high[0])
    axis.set_ylim(low[1], high[1])
    axis.set_aspect("equal")
    axis.grid(color=GREY, alpha=0.25, linewidth=0.5)


def _numbers(axis: Any, pair: GearPair, theta_1: float, theta_2: float, centre: FloatArray, half: float) -> None:
    for mounted, angle, x, colour in (
        (pair.driving, theta_1, 0.0, BLUE),
        (pair.driven, -theta_2, pair.a, ORANGE),
    ):
        radius = 0.5 * (mounted.gear.r + mounted.gear.r_f)
        for k, direction in enumerate((mounted.centre_lines + angle).tolist()):
            place = np.array([x + radius * math.cos(direction), radius * math.sin(direction)])
            if np.all(np.abs(place - centre) < 0.95 * half):
                axis.text(*place, str(k), color=colour, ha="center", va="center", fontsize=11, fontweight="bold")


def _close_up(axis: Any, found: FlankContacts, lead: int, teeth: str) -> None:
    """The contact itself and its normal, which points from the driving into the driven tooth."""
    normal = found.normal[lead]
    length = 0.35 * axis.get_xlim()[1]
    axis.annotate(
        "",
        xy=tuple(normal * length),
        xytext=(0.0, 0.0),
        arrowprops={"arrowstyle": "-|>", "color": "black", "linewidth": 1.4},
    )
    axis.plot(0.0, 0.0, marker="o", color="black", markersize=7, linestyle="none", label="contact and its normal")
    feature = ("flank on flank", "driving tip corner", "driven tip corner")[int(found.feature[lead])]
    x, y = found.point[lead]
    axis.set_title(f"{teeth}, {feature}, at ({x:.4f}, {y:.4f}) mm", fontsize=10)
    axis.set_xlabel("x from the contact / um")
    axis.set_ylabel("y from the contact / um")
    axis.legend(loc="upper left", fontsize=8, title="blue: driving, orange: driven", title_fontsize=8)


def deviation_figure(assembled: Assembled, *, name: str) -> Figure:
    """Maps of the deviation of every tooth over the roll length, both flanks of both gears, pitch beside them."""
    pair = assembled.pair
    figure = ShownFigure(figsize=(13.5, 9.5), layout="constrained")
    rows: Any = figure.subplots(2, 3, width_ratios=(4, 4, 2.6), squeeze=False)
    for k, mounted in enumerate((pair.driving, pair.driven)):
        _maps(figure, rows[k], mounted, assembled.deviations[k], GEARS[k], assembled.origin[k])
    figure.suptitle(
        f"{name}: normal deviations of every tooth, positive = more material; "
        "maps without each flank's index deviation, which stands beside them",
        fontsize=11,
    )
    return figure


def _maps(figure: Any, axes: Any, mounted: Mounted, made: Deviations, which: str, origin: str) -> None:
    gear, span, z = mounted.gear, mounted.flanks.span, mounted.gear.z
    l = np.linspace(span.l_start, span.l_a, 400)
    whole = [total(shapes, np.broadcast_to(l, (z, l.size)), z=z, span=span) for shapes in (made.drive, made.coast)]
    index = [_index(shapes, l, gear) for shapes in (made, _flipped(made))]
    profile = [(rows - p[:, None]) / UM for rows, p in zip(whole, index, strict=True)]
    top = max(float(np.max(np.abs(rows))) for rows in profile)
    top = max(top, 1e-3)
    for axis, rows, flank in zip(axes[:2], profile, ("drive", "coast"), strict=True):
        picture = axis.imshow(
            rows, aspect="auto", origin="lower", cmap="RdBu_r", vmin=-top, vmax=top, interpolation="nearest",
            extent=(l[0], l[-1], -0.5, z - 0.5),
        )  # fmt: skip
        axis.set_title(f"{which} gear ({origin}), {flank} flanks: profile", fontsize=9)
        axis.set_xlabel("roll length / mm (active start to tip)")
        axis.set_ylabel(f"{which} tooth")
        axis.set_yticks(range(0, z, max(1, z // 12)))
        axis.axvline(gear.l_pitch, color="black", linewidth=0.7, linestyle=":")
    figure.colorbar(picture, ax=axes[1], label="deviation / um", shrink=0.9)
    teeth = np.arange(z)
    for p, flank, colour, marker in ((index[0], "drive", BLUE, "o"), (index[1], "coast", ORANGE, "s")):
        mean = float(np.mean(p)) / UM
        axes[2].plot(
            p / UM - mean, teeth, color=colour, marker=marker, markersize=3, linewidth=0.8, label=f"{flank} {mean:.2f}"
        )
    axes[2].axvline(0.0, color=GREY, linewidth=0.7)
    axes[2].set_yticks(range(0, z, max(1, z // 12)))
    axes[2].set_xlabel("index deviation less its mean / um")
    axes[2].set_ylabel(f"{which} tooth")
    axes[2].set_title(f"{which} gear: pitch", fontsize=9)
    # Room for the legend above the last tooth.
    axes[2].set_ylim(-0.5, 1.14 * z)
    axes[2].legend(fontsize=8, loc="upper center", ncols=2, title="mean / um", title_fontsize=8)
    axes[2].grid(color=GREY, alpha=0.25, linewidth=0.5)


def _flipped(made: Deviations) -> Deviations:
    return Deviations(drive=made.coast, coast=made.drive)


def _index(made: Deviations, l: FloatArray, gear: Gear) -> FloatArray:
    """How far each drive flank (z,) as a whole stands off, mm: its index deviation alone."""
    shapes = tuple(shape for shape in made.drive if isinstance(shape, Index))
    at = total(shapes, l[None, :1], z=gear.z, span=Span(l_start=float(l[0]), l_a=float(l[-1])))
    out: FloatArray = at[:, 0]
    return out


def gap_figure(assembled: Assembled, theta_2: float, *, flank: Flank, name: str) -> Figure:
    """Gaps of all near pairs along the line of action over two pitches about driven rotation ``theta_2`` (rad), with TE
    below."""
    pair = assembled.pair
    tau = pair.driven.gear.tau
    at = theta_2 + np.linspace(-0.5, 0.5, round(GAP_PITCHES * GAP_CURVE_POINTS_PER_PITCH) + 1) * GAP_PITCHES * tau
    found = contacts(pair, at, flank=flank, near=DRAWN_WITHIN)
    angle = at / DEG
    figure = ShownFigure(figsize=(11.0, 7.5), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    meetings = sorted({(int(i), int(j)) for i, j in zip(found.driving, found.driven, strict=True)})
    first = {pair_: float(angle[found.position[_rows(found, pair_)]].min()) for pair_ in meetings}
    for k, meeting in enumerate(sorted(meetings, key=lambda one: first[one])):
        rows = _rows(found, meeting)
        gaps = np.full(angle.size, np.nan)
        gaps[found.position[rows]] = found.gap[rows] / UM
        colour = (BLUE, ORANGE, GREEN, "black")[k % 4]
        upper.plot(
            angle, gaps, color=colour, linestyle=STYLES[k % 4], linewidth=1.5,
            label=f"driving {meeting[0]} on driven {meeting[1]}",
        )  # fmt: skip
    upper.set_ylabel("gap along the line\nof action / um")
    # Room for the legend above the curves.
    upper.set_ylim(-1.0, 1.2 * DRAWN_WITHIN / UM)
    upper.set_title(f"{name}: gaps of near pairs, {flank} flanks, unloaded (0 touches)", loc="left", fontsize=10)
    upper.legend(fontsize=8, loc="upper center", ncols=4)
    lower.plot(angle, found.te * pair.r_b2 / UM, color=BLUE, linewidth=1.2)
    lower.set_ylabel("TE along the line\nof action / um")
    lower.set_xlabel("driven angle / deg")
    for axis in (upper, lower):
        axis.axvline(theta_2 / DEG, color=GREY, linewidth=1.0, linestyle="--")
        axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
        axis.margins(x=0.0)
        axis.ticklabel_format(useOffset=False, axis="y")
    return figure


def _rows(found: FlankContacts, meeting: tuple[int, int]) -> BoolArray:
    rows: BoolArray = (found.driving == meeting[0]) & (found.driven == meeting[1])
    return rows
