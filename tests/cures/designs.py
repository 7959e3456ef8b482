"""Refusals of REXS designs: XML, JSON, zips."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

from gearpoly.files.rexs.source import REXS_SIZE_LIMIT_BYTES
from tests.cures.cure import Cure, command, put
from tests.test_gde import BOMB
from tests.test_rexs import OLD


def design(
    name: str,
    says: str,
    bad: str | bytes,
    good: str | bytes = OLD,
    *,
    file: str = "a.rexs",
    to: str = "",
    words: tuple[str, ...] = (),
    good_words: tuple[str, ...] = (),
) -> Cure:
    """A design that is refused, and one that becomes a pair file."""

    def attempt(folder: Path, content: str | bytes, name: str, words: tuple[str, ...]) -> None:
        put(folder, name, content)
        command("pair", "--from", folder / name, folder / "pair.toml", *words)

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad, file, words),
        good=lambda folder, message: attempt(folder, good, to or file, good_words),
    )


def edited(name: str, says: str, old: str, new: str) -> Cure:
    """The design with one piece changed, and as it was."""
    assert old in OLD, old
    return design(name, says, OLD.replace(old, new, 1))


def zipped(parts: dict[str, bytes]) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return out.getvalue()


def locked(data: bytes) -> bytes:
    """A zip that calls itself encrypted, in both of its headers."""
    local, central = data.index(b"PK\3\4") + 6, data.index(b"PK\1\2") + 8
    out = bytearray(data)
    out[local] |= 1
    out[central] |= 1
    return bytes(out)


WHOLE = zipped({"a.rexs": OLD.encode()})
TWO = OLD.replace(
    "</relations>",
    """<relation id="21" type="stage"><ref id="20" role="stage"/>
<ref id="1" role="gear_1"/><ref id="2" role="gear_2"/></relation></relations>""",
).replace("</components>", '<component id="20" type="cylindrical_stage" name="b"></component></components>')
SILENT = OLD.replace('"none">false', '"none">true', 1)

CURES = [
    edited("no version", "want REXS 1.0 to 1.7 or 2.0: export it in one of these versions", 'version="1.2" ', ""),
    edited("unit", "want mm", 'unit="mm">2.5', 'unit="inch">2.5'),
    edited("word", "want a number", 'unit="mm">2.5', 'unit="mm">two'),
    edited("infinite", "want a number", 'unit="mm">2.5', 'unit="mm">inf'),
    edited("no module", "want it in mm", 'unit="mm">2.5', 'unit="mm">0'),
    edited("part of a tooth", "want a whole number", 'unit="none">17', 'unit="none">17.5'),
    edited("few teeth", "5 or more", 'unit="none">17', 'unit="none">3'),
    edited("flanks apart", "want the same on both flanks", 'unit="none">0.1', 'unit="none">0.2'),
    edited("truth", "want true or false", '"none">false', '"none">perhaps'),
    edited(
        "lost component",
        "want every component that a relation names: export it again",
        'id="2" role="gear_2"',
        'id="99" role="gear_2"',
    ),
    edited("id twice", "want each id once", 'component id="8"', 'component id="7"'),
    edited("id", "want a whole number", 'component id="8"', 'component id="x"'),
    edited("helical", "want external spur gears", 'unit="°">0.0', 'unit="°">12.5'),
    edited("tip", "want a diameter in mm from", 'unit="mm">48.0', 'unit="mm">1'),
    edited("cut off", "want the whole REXS model: export it again", "</model>", ""),
    edited(
        "entities",
        "take <!DOCTYPE ...> out",
        '<?xml version="1.0" encoding="UTF-8"?>',
        BOMB,
    ),
    edited(
        "class",
        "want a class from 1 to 11",
        '<attribute id="face_width" unit="mm">20</attribute>',
        '<attribute id="global_tolerance_class_iso_1328_2013" unit="none">A</attribute>',
    ),
    design("another root", "want a REXS file, which begins with <model>", OLD.replace("model", "muddle")),
    design(
        "no stage", "want a cylindrical_stage with two gears", OLD.replace('"cylindrical_stage"', '"planetary_stage"')
    ),
    design("deep", "want a REXS model: export it again", '{"a":' * 100_000, OLD, file="a.rexsj", to="a.rexs"),
    design("no json", "want the whole REXS model in UTF-8: export it again", "{", OLD, file="a.rexsj", to="a.rexs"),
    design("no model", 'want a REXS file, {"model": {...}}', "{}", OLD, file="a.rexsj", to="a.rexs"),
    design("two stages", "say which with --stage: 10", TWO, TWO, good_words=("--stage", "10")),
    design(
        "another stage", "want --stage with one of 10", OLD, OLD, words=("--stage", "7"), good_words=("--stage", "10")
    ),
    design("which drives", "--as driving or --as driven", SILENT, SILENT, good_words=("--as", "driving")),
    design("drives otherwise", "leave --as out, the file says which gear drives", OLD, OLD, words=("--as", "driving")),
    design("flank", "leave --flank out: designs need none", OLD, OLD, words=("--flank", "left")),
    design(
        "zip of many", "pack the model alone", zipped({f"{k}.txt": b"" for k in range(1001)}), WHOLE, file="a.rexsz"
    ),
    design(
        "zip of two",
        "unpack it and name the one you mean",
        zipped({"a.rexs": OLD.encode(), "b.rexs": b""}),
        OLD,
        file="a.rexsz",
        to="a.rexs",
    ),
    design("password", "want it without a password", locked(WHOLE), WHOLE, file="a.rexsz"),
    design("no zip", "pack it again", WHOLE[:200], WHOLE, file="a.rexsz"),
    design(
        "large zip",
        "want a model of at most 32 MB",
        zipped({"a.rexs": b" " * (REXS_SIZE_LIMIT_BYTES + 1)}),
        WHOLE,
        file="a.rexsz",
    ),
    Cure(
        name="file there",
        says="want a new name, since what was filled in would be lost",
        bad=lambda folder: (
            put(folder, "a.rexs", OLD),
            put(folder, "p.toml", ""),
            command("pair", "--from", folder / "a.rexs", folder / "p.toml"),
        ),
        good=lambda folder, message: command("pair", "--from", folder / "a.rexs", folder / "q.toml"),
    ),
]
