"""3MF: solids with units and names, as slicers prefer them. A zip of three small XML parts, written directly: trimesh's
own 3MF states neither a name nor magnification nor chord error."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from gearpoly import __version__
from gearpoly.export.drawing import Drawing
from gearpoly.units import FloatArray, IntArray

ENDINGS = (".3mf",)
CURVES = ("lines",)

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""

COMPRESSION = 2
"""Compression: 5 takes three times as long for a file a fifth smaller."""

_DAY_ZERO = (1980, 1, 1, 0, 0, 0)
"""A zip's first date: the same gears give the same file, byte for byte."""


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as 3MF in millimetres, one object per gear, vertices to 1e-9 mm; the statement is its description."""
    from gearpoly.export.solid import solids

    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}">',
        f'<metadata name="Title">{escape(drawing.title)}</metadata>',
        f'<metadata name="Application">gearpoly {__version__}</metadata>',
        f'<metadata name="Description">{escape(drawing.words())}</metadata>',
        "<resources>",
    ]
    meshes = solids(drawing, single=False)
    for number, mesh in enumerate(meshes, start=1):
        name = f"{mesh.metadata['name']} gear"
        if drawing.request.magnify != 1.0:
            name += f", deviations {drawing.request.magnify:g} times"
        lines.append(f'<object id="{number}" type="model" name={quoteattr(name)}><mesh><vertices>')
        lines.append(_rows('<vertex x="%.9f" y="%.9f" z="%.9f"/>\n', mesh.vertices))
        lines.append("</vertices><triangles>")
        lines.append(_rows('<triangle v1="%d" v2="%d" v3="%d"/>\n', mesh.faces))
        lines.append("</triangles></mesh></object>")
    lines.append("</resources><build>")
    lines += [f'<item objectid="{number}"/>' for number in range(1, len(meshes) + 1)]
    lines.append("</build></model>")
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=COMPRESSION) as archive:
        for name, text in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELS),
            ("3D/3dmodel.model", "\n".join(lines) + "\n"),
        ):
            part = zipfile.ZipInfo(name, date_time=_DAY_ZERO)
            part.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(part, text)
    return drawing.chord_error


def _rows(template: str, values: FloatArray | IntArray) -> str:
    """One line of ``template`` per row; a single long template is filled four times faster than many short ones."""
    cells: list[float | int] = list(values.ravel().tolist())
    return str((template * values.shape[0]) % tuple(cells))
