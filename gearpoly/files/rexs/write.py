"""A REXS model as a file: XML, JSON, or a zip that holds the XML."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from gearpoly import __version__
from gearpoly.files.rexs.model import Component, RexsModel, Value

DATE = "2026-01-01T00:00:00+00:00"
"""The format wants a date; one and the same lets the same pair give the same file, byte for byte."""

DAY_ZERO = (1980, 1, 1, 0, 0, 0)
"""A zip's first date."""


def write_model(model: RexsModel, target: Path, *, ending: str) -> None:
    """Write ``model`` to ``target`` as ``ending`` says: .rexs, .rexsj or .rexsz."""
    if ending == ".rexsj":
        target.write_text(json_text(model), encoding="utf-8")
    elif ending == ".rexs":
        target.write_text(xml_text(model), encoding="utf-8")
    else:
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            part = zipfile.ZipInfo("model.rexs", date_time=DAY_ZERO)
            part.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(part, xml_text(model))


def xml_text(model: RexsModel) -> str:
    """The model as XML."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<model version="{model.version}" applicationId="gearpoly" applicationVersion="{__version__}" date="{DATE}">',
        "  <relations>",
    ]
    for one in model.relations:
        order = "" if one.order is None else f' order="{one.order}"'
        lines.append(f'    <relation id="{one.id}" type="{one.type}"{order}>')
        lines += [
            f'      <ref id="{ref}" role="{role}" hint="{model.components[ref].type}"/>' for role, ref in one.refs
        ]
        lines.append("    </relation>")
    lines += ["  </relations>", "  <components>"]
    for part in model.components.values():
        lines.append(f'    <component id="{part.id}" type="{part.type}" name={quoteattr(part.name)}>')
        lines += [
            f'      <attribute id="{key}" unit="{one.unit}">{escape(_text(one.value))}</attribute>'
            for key, one in part.attributes.items()
        ]
        lines.append("    </component>")
    return "\n".join([*lines, "  </components>", "</model>"]) + "\n"


def json_text(model: RexsModel) -> str:
    """The model as JSON."""
    relations: list[dict[str, Any]] = [
        {"id": one.id, "type": one.type}
        | ({} if one.order is None else {"order": one.order})
        | {"refs": [{"id": ref, "role": role, "hint": model.components[ref].type} for role, ref in one.refs]}
        for one in model.relations
    ]
    components = [
        {"id": part.id, "type": part.type, "name": part.name, "attributes": _attributes(part)}
        for part in model.components.values()
    ]
    head = {"version": model.version, "applicationId": "gearpoly", "applicationVersion": __version__, "date": DATE}
    return json.dumps({"model": {**head, "relations": relations, "components": components}}, indent=1) + "\n"


def _attributes(part: Component) -> list[dict[str, Any]]:
    return [
        {"id": key} | ({} if one.unit == "none" else {"unit": one.unit}) | {_kind(one.value): one.value}
        for key, one in part.attributes.items()
    ]


def _kind(value: Value) -> str:
    for kind, name in ((bool, "boolean"), (int, "integer"), (float, "floating_point")):
        if isinstance(value, kind):
            return name
    return "enum"


def _text(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else value if isinstance(value, str) else repr(value)
