"""REXS files opened: XML, JSON, or a zip that holds one of them; from anywhere, so bounded and without entities."""

from __future__ import annotations

import json
import lzma
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from gearpoly.errors import InputFileError, MissingExtraError, shown
from gearpoly.files.paths import unreadable
from gearpoly.files.rexs.model import Attribute, Component, Relation, RexsModel, Value
from gearpoly.files.traces import check_file

REXS_ENDINGS = (".rexs", ".rexsj", ".rexsz")

UNREADABLE = (
    zipfile.BadZipFile,
    zipfile.LargeZipFile,
    zlib.error,
    lzma.LZMAError,
    NotImplementedError,
    EOFError,
    OSError,
    RuntimeError,
    ValueError,
)
"""What zipfile and the methods of compression raise for a damaged archive; NotImplementedError for a method that they
do not know, RuntimeError for a password."""

REXS_SIZE_LIMIT_BYTES = 32 * 2**20
"""Bytes of a model, unpacked; the transmissions that FVA publishes have 0.1 MB."""

MEMBERS_LIMIT = 1000
"""Files in a zip: a model and its attached tables and pictures."""

VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0")

JSON_VALUE_KINDS = ("floating_point", "integer", "boolean", "enum", "string")
"""Kinds of JSON values that are kept."""


def is_design(file: Path, start: bytes) -> bool:
    """Whether ``file``, which begins with ``start``, is a REXS model."""
    return file.suffix.lower() in REXS_ENDINGS or b"<model" in start


def read_model(path: Path | str) -> RexsModel:
    """The model of a ``.rexs``, ``.rexsj`` or ``.rexsz`` file.

    Raises ``InputFileError`` naming what stands in the way: no XML or JSON, entities, a zip that unpacks to too much,
    another version. ``MissingExtraError`` without defusedxml.
    """
    file = Path(path)
    check_file(file, limit_bytes=REXS_SIZE_LIMIT_BYTES)
    try:
        data = file.read_bytes()
    except OSError as error:
        raise unreadable(file, error) from None
    if data.startswith(b"PK"):
        data = _unpacked(file)
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    try:
        return _from_json(file, text) if text.startswith(b"{") else _from_xml(file, data)
    except RecursionError:
        raise InputFileError(file, found="blocks nested too deep", wish="want a REXS model: export it again") from None


def _unpacked(file: Path) -> bytes:
    """The one model in a zip, never more than the limit of it."""
    try:
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if len(members) > MEMBERS_LIMIT:
                wish = f"want at most {MEMBERS_LIMIT}: pack the model alone"
                raise InputFileError(file, found=f"a zip of {len(members)} files", wish=wish)
            models = [one for one in members if one.filename.lower().endswith((".rexs", ".rexsj"))]
            if len(models) != 1:
                wish = "want one .rexs or .rexsj in it: unpack it and name the one you mean"
                raise InputFileError(file, found=f"a zip with {len(models)} models", wish=wish)
            if models[0].flag_bits & 0x1:
                raise InputFileError(file, found="an encrypted zip", wish="want it without a password")
            with archive.open(models[0]) as stream:
                data = stream.read(REXS_SIZE_LIMIT_BYTES + 1)  # what a zip says of its sizes may be untrue
    except InputFileError:
        raise
    except UNREADABLE as error:
        raise InputFileError(
            file, found=f"no zip that can be read ({shown(str(error))})", wish="pack it again"
        ) from None
    if len(data) > REXS_SIZE_LIMIT_BYTES:
        wish = f"want a model of at most {REXS_SIZE_LIMIT_BYTES // 2**20} MB"
        raise InputFileError(file, found="a zip that unpacks to more", wish=wish)
    return data


def _from_xml(file: Path, data: bytes) -> RexsModel:
    try:
        from defusedxml import DefusedXmlException
        from defusedxml.ElementTree import ParseError, fromstring
    except ImportError:
        raise MissingExtraError("REXS files need defusedxml: pip install 'gearpoly[rexs]'") from None
    try:
        root = fromstring(data, forbid_dtd=True)
    except DefusedXmlException as error:
        found = f"XML that declares entities or fetches others ({type(error).__name__})"
        raise InputFileError(
            file, found=found, wish="want plain data: nothing of the kind is expanded; take <!DOCTYPE ...> out"
        ) from None
    except (ParseError, ValueError, LookupError) as error:
        line = getattr(error, "position", (0, 0))[0]
        where = f"line {line}" if line else ""
        raise InputFileError(
            file, where=where, found=f"no XML ({shown(str(error))})", wish="want the whole REXS model: export it again"
        ) from None
    if _tag(root) != "model":
        raise InputFileError(file, found=f"<{shown(_tag(root))}>", wish="want a REXS file, which begins with <model>")
    parts: dict[str, list[Any]] = {}
    for block in root:
        parts.setdefault(_tag(block), []).append(block)
    components = [
        (one.get("id"), one.get("type"), one.get("name", ""), list(_xml_attributes(one)))
        for block in parts.get("components", [])
        for one in block
        if _tag(one) == "component"
    ]
    relations = [
        (one.get("id"), one.get("type"), one.get("order"), [(ref.get("role"), ref.get("id")) for ref in one])
        for block in parts.get("relations", [])
        for one in block
        if _tag(one) == "relation"
    ]
    cases = sum(_tag(case) == "load_case" for block in parts.get("load_spectrum", []) for case in block)
    return _model(file, root.get("version"), components, relations, cases)


def _tag(element: Any) -> str:
    return str(element.tag).rpartition("}")[2] if isinstance(element.tag, str) else ""


def _xml_attributes(component: Any) -> Iterator[tuple[object, object, Value]]:
    for one in component:
        text = (one.text or "").strip()
        if _tag(one) == "attribute" and text and not len(one):
            yield one.get("id"), one.get("unit", "none"), text


def _from_json(file: Path, text: bytes) -> RexsModel:
    def no_number(word: str) -> NoReturn:
        raise ValueError(f"{word} is no number of JSON")

    try:
        top = json.loads(text.decode("utf-8"), parse_constant=no_number)
    except ValueError as error:  # UnicodeDecodeError and JSONDecodeError too
        raise InputFileError(
            file, found=f"no JSON ({shown(str(error))})", wish="want the whole REXS model in UTF-8: export it again"
        ) from None
    model = top.get("model") if isinstance(top, dict) else None
    if not isinstance(model, dict):
        raise InputFileError(file, found='no "model"', wish='want a REXS file, {"model": {...}}')
    components = [
        (one.get("id"), one.get("type"), one.get("name", ""), list(_json_attributes(one)))
        for one in _tables(model.get("components"))
    ]
    relations = [
        (
            one.get("id"),
            one.get("type"),
            one.get("order"),
            [(ref.get("role"), ref.get("id")) for ref in _tables(one.get("refs"))],
        )
        for one in _tables(model.get("relations"))
    ]
    spectra = model.get("load_spectrum")
    cases = sum(
        len(_tables(one.get("load_cases"))) for one in _tables(spectra if isinstance(spectra, list) else [spectra])
    )
    return _model(file, model.get("version"), components, relations, cases)


def _tables(value: object) -> list[dict[str, Any]]:
    return [one for one in value if isinstance(one, dict)] if isinstance(value, list) else []


def _json_attributes(component: dict[str, Any]) -> Iterator[tuple[object, object, Value]]:
    for one in _tables(component.get("attributes")):
        for kind in JSON_VALUE_KINDS:
            value = one.get(kind)
            if isinstance(value, str | int | float | bool):
                yield one.get("id"), one.get("unit", "none"), value
                break


def _model(
    file: Path,
    version: object,
    components: list[tuple[object, object, object, list[tuple[object, object, Value]]]],
    relations: list[tuple[object, object, object, list[tuple[object, object]]]],
    cases: int,
) -> RexsModel:
    """The checked model: a known version, every id once, every relation between components that are there."""
    text = str(version)
    if ".".join(text.split(".")[:2]) not in VERSIONS:
        found = f'version "{shown(text)}"' if version is not None else "no version"
        raise InputFileError(file, found=found, wish="want REXS 1.0 to 1.7 or 2.0: export it in one of these versions")
    kept: dict[int, Component] = {}
    for number, kind, name, attributes in components:
        id_ = _id(file, number, "component")
        if id_ in kept:
            raise InputFileError(file, found=f"component {id_} twice", wish="want each id once")
        kept[id_] = Component(
            id=id_,
            type=str(kind),
            name=str(name or ""),
            attributes={str(key): Attribute(value=value, unit=str(unit)) for key, unit, value in attributes},
        )
    links = []
    for number, kind, order, refs in relations:
        ids = tuple((str(role), _id(file, ref, "component of a relation")) for role, ref in refs)
        lost = next((ref for _, ref in ids if ref not in kept), None)
        if lost is not None:
            found = f"relation {shown(str(number))} of component {lost}, which is not there"
            raise InputFileError(file, found=found, wish="want every component that a relation names: export it again")
        place = None if order is None else _id(file, order, "order")
        links.append(Relation(id=_id(file, number, "relation"), type=str(kind), refs=ids, order=place))
    return RexsModel(file=file, version=text, components=kept, relations=tuple(links), load_cases=cases)


def _id(file: Path, value: object, what: str) -> int:
    text = str(value)
    if not (text.isascii() and text.removeprefix("-").isdigit() and len(text) < 12):
        raise InputFileError(file, found=f'the id "{shown(text)}" of a {what}', wish="want a whole number")
    return int(text)
