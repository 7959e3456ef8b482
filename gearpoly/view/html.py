"""One self-contained page: the template with style, scripts and data put in; it loads nothing from anywhere."""

from __future__ import annotations

import json
from html import escape
from importlib.resources import files
from typing import Any

SCRIPTS = (
    "data.js",
    "gear.js",
    "contact.js",
    "pair.js",
    "camera.js",
    "picture.js",
    "overlay.js",
    "charts.js",
    "strips.js",
    "flanks.js",
    "panels.js",
    "show.js",
    "act.js",
    "hands.js",
    "start.js",
)
"""In the order in which they build on one another; together they are one script."""


def page_text(document: dict[str, Any]) -> str:
    """The page for ``document`` (of ``gearpoly.view.document``) as HTML."""
    folder = files("gearpoly.view") / "page"

    def part(name: str) -> str:
        return (folder / name).read_text(encoding="utf-8")

    # A name that holds "</script>" must not end the script that holds it.
    data = json.dumps(document, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    scripts = "\n".join(part(name) for name in SCRIPTS)
    pieces = {
        "TITLE": escape(f"{document['name']} - gearpoly"),
        "STYLE": part("style.css"),
        "DATA": data,
        "SCRIPT": f'(() => {{\n"use strict";\n{scripts}\n}})();',
    }
    text = part("template.html")
    out: list[str] = []
    # Piece by piece, since a pair may be named like a placeholder.
    for chunk in text.split("{{"):
        name, closed, rest = chunk.partition("}}")
        out.append(pieces[name] + rest if closed and name in pieces else chunk)
    return "".join(out)
