"""ES modules as one script: a page that is opened from disk can import nothing.

Modules import by ``import { a, b } from "./other.js";`` and export what they declare at the top level. They are put one
after the other, what they import first, and share one scope: no name may be declared at the top level of two. They may
await at the top level; ``window.started`` is kept once all have run, for scripts and tests that ask the page.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable

IMPORT = re.compile(r'^import \{[^}]*\} from "(\.[^"]+\.js)";\n', re.MULTILINE)
EXPORTED = re.compile(r"^export (?=(?:const|let|class|function) )", re.MULTILINE)


def bundle(entry: str, read: Callable[[str], str]) -> str:
    """The module ``entry`` and all that it needs as a script of its own scope; ``read`` gives a module's text by its
    path. Raises ``ValueError`` where modules import each other in a ring."""
    done: dict[str, str] = {}

    def add(path: str, ring: tuple[str, ...]) -> None:
        if path in ring:
            raise ValueError(f"scripts import each other: {' imports '.join([*ring[ring.index(path) :], path])}")
        if path in done:
            return
        text = read(path)
        for other in IMPORT.findall(text):
            add(posixpath.normpath(posixpath.join(posixpath.dirname(path), other)), (*ring, path))
        done[path] = EXPORTED.sub("", IMPORT.sub("", text))

    add(entry, ())
    scripts = "\n".join(text.strip("\n") + "\n" for text in done.values())
    return f'window.started = (async () => {{\n"use strict";\n{scripts}}})();'
