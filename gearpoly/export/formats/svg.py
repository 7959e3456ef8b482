"""SVG at true size in mm, one layer per gear, for cutters, drawings and screens."""

from __future__ import annotations

import json
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from gearpoly.export.drawing import Drawing, Placed
from gearpoly.export.reference import circles, labels, line_of_action, touching
from gearpoly.units import FloatArray

ENDINGS = (".svg",)
CURVES = ("lines",)

# Okabe and Ito's palette keeps its contrasts for all common kinds of colour blindness.
GEAR_COLOURS = {"driving": "#0072B2", "driven": "#D55E00"}
_DASHES = {"tip": "", "reference": "3 1 0.5 1", "pitch": "3 1 0.5 1", "base": "1.5 1", "root": ""}


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as SVG: user units are mm, y points up on the page, layers as Inkscape knows them.

    Outlines are closed paths of straight edges to 1e-8 mm, bores true circles; the statement stands in ``metadata``.
    """
    target.write_text(svg_text(drawing), encoding="utf-8")
    return drawing.chord_error


def svg_text(drawing: Drawing) -> str:
    """The drawing as the text of an SVG file."""
    m = drawing.pair.driving.gear.m
    corners = np.concatenate([gear.ring for gear in drawing.gears])
    low, high = corners.min(axis=0) - m, corners.max(axis=0) + m
    width, height = (high - low).tolist()
    statement = drawing.statement(curves="lines")
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        f'width="{width:.6f}mm" height="{height:.6f}mm" '
        f'viewBox="{low[0]:.6f} {-high[1]:.6f} {width:.6f} {height:.6f}">',
        f"<title>{escape(drawing.title)}</title>",
        f"<desc>{escape(drawing.words(curves='lines'))}</desc>",
        f'<metadata id="gearpoly">{escape(json.dumps(statement, ensure_ascii=False))}</metadata>',
    ]
    for gear in drawing.gears:
        lines += _gear(gear, drawing, stroke=0.02 * m)
    lines += _mesh(drawing, stroke=0.02 * m)
    lines.append("</svg>")
    return "\n".join(lines) + "\n"


def _layer(identity: str, label: str, attributes: str = "") -> str:
    return f'<g id="{identity}" inkscape:groupmode="layer" inkscape:label={quoteattr(label)}{attributes}>'


def _path(points: FloatArray) -> str:
    # The page's y axis points down; the drawing's points up.
    return "M" + " ".join(f"{x:.8f},{-y:.8f}" for x, y in points.tolist()) + "Z"


def _gear(gear: Placed, drawing: Drawing, *, stroke: float) -> list[str]:
    name, colour = gear.name, GEAR_COLOURS[gear.name]
    axis, centre = gear.axis.tolist(), gear.centre.tolist()
    lines = [
        _layer(name, f"{name} gear", f' fill="none" stroke="{colour}" stroke-width="{stroke:.4f}"'),
        _layer(f"{name}-outline", f"{name} outline"),
        f'<path id="{name}-tooth-outline" fill="{colour}" fill-opacity="0.12" d="{_path(gear.ring)}"/>',
        "</g>",
        _layer(f"{name}-bore", f"{name} bore"),
        f'<circle cx="{axis[0]:.8f}" cy="{-axis[1]:.8f}" r="{gear.outline.r_bore:.8f}" fill="#ffffff"/>',
        "</g>",
        _layer(f"{name}-circles", f"{name} circles", ' stroke-opacity="0.7"'),
    ]
    for kind, radius in circles(gear, drawing).items():
        dash = " ".join(f"{float(step) * 10.0 * stroke:.3f}" for step in _DASHES[kind].split())
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        # Pitch circles belong to the axes; the others turn with an eccentric gear.
        x, y = axis if kind == "pitch" else centre
        lines.append(
            f'<circle id="{name}-{kind}" cx="{x:.8f}" cy="{-y:.8f}" r="{radius:.8f}" '
            f'stroke-width="{0.5 * stroke:.4f}"{dashes}><title>{kind} circle, r = {radius:.4f} mm</title></circle>'
        )
    arm = 2.0 * drawing.pair.driving.gear.m
    lines += [
        f'<path d="M{axis[0] - arm:.6f},{-axis[1]:.6f}h{2 * arm:.6f}M{axis[0]:.6f},{-axis[1] - arm:.6f}v{2 * arm:.6f}" '
        f'stroke-width="{0.5 * stroke:.4f}"/>',
        "</g>",
        _layer(f"{name}-numbers", f"{name} tooth numbers", f' fill="{colour}" stroke="none"'),
    ]
    lines += [
        f'<text x="{label.place[0]:.6f}" y="{-label.place[1] + 0.35 * label.height:.6f}" '
        f'font-size="{label.height:.4f}" font-family="sans-serif" text-anchor="middle">{label.text}</text>'
        for label in labels(gear)
    ]
    return [*lines, "</g>", "</g>"]


def _mesh(drawing: Drawing, *, stroke: float) -> list[str]:
    ends = line_of_action(drawing)
    if ends is None:
        return []
    (x1, y1), (x2, y2) = ends.tolist()
    lines = [
        _layer("mesh", "mesh", f' fill="none" stroke="#000000" stroke-width="{0.5 * stroke:.4f}"'),
        f'<line id="line-of-action" x1="{x1:.8f}" y1="{-y1:.8f}" x2="{x2:.8f}" y2="{-y2:.8f}">'
        "<title>line of action</title></line>",
    ]
    lines += [
        f'<circle class="contact" cx="{x:.8f}" cy="{-y:.8f}" r="{6.0 * stroke:.4f}"><title>contact</title></circle>'
        for x, y in touching(drawing).tolist()
    ]
    return [*lines, "</g>"]
