"""Limits in words, such as ``te_pp_um<=12``, instead of the study's own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from gearpoly.errors import OutOfRangeError, shown_value
from gearpoly.files.traces import nearest
from gearpoly.study.models import OutputLimit
from gearpoly.study.store import read_store

_LIMIT = re.compile(r"^\s*(\w+)\s*(<=|>=)\s*(\S+)\s*$")


def parse_limits(texts: Sequence[str] | None, *, share: float, folder: Path) -> list[OutputLimit] | None:
    """Limits as a caller words them, or None where there are none. Raises ``OutOfRangeError`` for one that is none."""
    if not texts:
        return None
    known = read_store(folder)[0].plan.file.outputs
    out = []
    for text in texts:
        match = _LIMIT.match(text) if isinstance(text, str) else None
        if match is None:
            raise OutOfRangeError(f'--limit {shown_value(text)}; want "output<=number" or "output>=number"')
        if match[1] not in known:
            raise OutOfRangeError(
                f'--limit "{text}": the study kept no "{match[1]}"; the nearest is "{nearest(match[1], known)}"'
            )
        try:
            bound = float(match[3])
            keys = {"at_most" if match[2] == "<=" else "at_least": bound}
            out.append(OutputLimit(output=match[1], share=share, **keys))
        except ValidationError:
            raise OutOfRangeError(f"--share {share:g}: want a share above 0 and below 1") from None
        except ValueError:
            raise OutOfRangeError(f'--limit "{text}": "{match[3]}" is no number') from None
    return out
