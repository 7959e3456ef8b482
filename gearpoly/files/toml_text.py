"""Values and tables as TOML text."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

TOML_LINE_WIDTH = 110
"""Characters of a line of a long list."""


def value_text(value: object) -> str:
    """A number, text, truth or list as TOML has it."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")  # TOML also forbids a bare DEL
    if isinstance(value, tuple | list):
        return "[" + ", ".join(value_text(item) for item in value) + "]"
    return str(value).lower() if isinstance(value, bool) else repr(value)


def table(name: str, keys: Mapping[str, object], comment: str = "") -> Iterator[str]:
    """The lines of a table; long lists are broken."""
    yield f"[{name}]" + (f"  # {comment}" if comment.isprintable() and comment else "")
    for key, value in keys.items():
        text = f"{key} = {value_text(value)}"
        if len(text) <= TOML_LINE_WIDTH or not isinstance(value, tuple | list):
            yield text
            continue
        yield f"{key} = ["
        line = "   "
        for item in value:
            part = f" {value_text(item)},"
            if len(line) + len(part) > TOML_LINE_WIDTH:
                yield line
                line = "   "
            line += part
        yield line
        yield "]"
