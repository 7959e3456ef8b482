"""Pages that need nothing else: templates filled in, with style, scripts and data inside.

Whatever a template shows is escaped; what is HTML already is ``Markup``. Templates are named by their folder in the
package, as ``view/page/template.html``; the kit that all pages share is ``page/kit``.
"""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from gearpoly.page.bundle import bundle

if TYPE_CHECKING:
    from jinja2 import Environment


def render(template: str, **known: object) -> str:
    """The page that a ``template`` makes of what is ``known``; a name that it misses is an error of the template."""
    return environment().get_template(template).render(known)


@cache
def environment() -> Environment:
    """How all pages are made. The library is loaded with the first page that is written."""
    from jinja2 import Environment, FunctionLoader, StrictUndefined
    from markupsafe import Markup

    made = Environment(
        autoescape=True, loader=FunctionLoader(part), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    made.filters["json"] = lambda data: Markup(data_text(data))
    made.globals["script"] = lambda entry: Markup(bundle(entry, part))
    made.globals["style"] = lambda path: Markup(part(path))
    return made


def part(path: str) -> str:
    """A file of the package."""
    return files("gearpoly").joinpath(*path.split("/")).read_text(encoding="utf-8")


def data_text(data: Any) -> str:
    """``data`` as JSON in a script: a name that holds ``</script>`` must not end the script that holds it."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
