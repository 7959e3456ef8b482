"""The site of the docs: Sphinx, the pages as they stand in Markdown, one search that needs no network (`make docs`)."""

from __future__ import annotations

import html
import io
import json
import re
from pathlib import Path
from typing import Any

import matplotlib
from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import math_to_image
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

import gearpoly
from gearpoly import __version__

project = "gearpoly"
author = "the gearpoly authors"
copyright = "the gearpoly authors, MIT licence"
version = release = __version__

SIZE = 12.0
"""Points that a formula is drawn at; it is scaled with the text."""

extensions = ["myst_nb", "sphinx.ext.autodoc"]
source_suffix = {".md": "myst-nb"}
exclude_patterns = ["tutorial/pictures.py", "reference/gallery.py"]
myst_enable_extensions = ["dollarmath", "attrs_inline"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]
nitpicky = False

nb_execution_mode = "auto"
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_merge_streams = True

html_theme = "furo"
html_title = f"gearpoly {release}"
html_copy_source = False
html_show_sphinx = False
html_static_path: list[str] = ["static"]
html_css_files = ["site.css"]
highlight_language = "none"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {
    name: name
    for name in ("BoolArray", "Flank", "FloatArray", "IntArray", "Maps", "Recorded", "Side", "Status", "Turn", "Which")
}
python_use_unqualified_type_names = True


def _drawn(formula: str) -> tuple[str, float]:
    """A formula as SVG in the colour of the text, and how far it reaches below the line, in em: no script, no network,
    and no font on the reader's machine."""
    svg = io.BytesIO()
    with matplotlib.rc_context(
        {"svg.hashsalt": formula, "mathtext.fontset": "dejavuserif", "savefig.transparent": True}
    ):
        font = FontProperties(size=SIZE)
        depth = math_to_image(f"${formula}$", svg, prop=font, dpi=72, format="svg")
    drawn = re.sub(r"^.*?(?=<svg )|<metadata>.*?</metadata>", "", svg.getvalue().decode(), flags=re.DOTALL).strip()
    name = html.escape(formula, quote=True)
    drawn = drawn.replace("<svg ", f'<svg role="img" aria-label="{name}" fill="currentColor" overflow="visible" ', 1)
    return re.sub(r'(width|height)="([\d.]+)pt"', lambda m: f'{m[1]}="{float(m[2]) / SIZE:.3f}em"', drawn), depth / SIZE


def _inline(visitor: HTML5Translator, node: nodes.math) -> None:
    drawn, depth = _drawn(node.astext())
    visitor.body.append(drawn.replace("<svg ", f'<svg style="vertical-align: {-depth:.3f}em" ', 1))
    raise nodes.SkipNode


def _block(visitor: HTML5Translator, node: nodes.math_block) -> None:
    visitor.body.append(f'<div class="math">{_drawn(" ".join(node.astext().split()))[0]}</div>')
    raise nodes.SkipNode


def _made_by_the_package(app: Sphinx, page: str, source: list[str]) -> None:
    """Outputs of a notebook are made anew where any module of gearpoly is newer than they are."""
    if page.startswith("tutorial/python_"):
        for module in Path(gearpoly.__file__).parent.rglob("*.py"):
            app.env.note_dependency(str(module))


def _options_whole(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: object) -> None:
    """Keep options of commands in one piece: a browser may end a line between the hyphens of --html."""
    context["body"] = re.sub(
        r'(?<=<div class="highlight-none notranslate">).*?(?=</pre>)',
        lambda block: re.sub(r"(?<= )--[a-z-]+", r'<span class="option">\g<0></span>', block[0]),
        context.get("body", ""),
        flags=re.DOTALL,
    )


def _aliases_by_name(
    app: Sphinx, what: str, name: str, one: object, options: object, signature: str | None, result: str | None
) -> tuple[str | None, str | None]:
    """Types that the reference explains by name stand in a union by name too."""

    def plain(text: str | None) -> str | None:
        return text and re.sub(r"TypeAliasForwardRef\('(\w+)'\)", r"\1", text)

    return plain(signature), plain(result)


def _text(node: nodes.Node) -> str:
    """What a search shows of a page: its words, in sections that its anchors find."""
    if isinstance(node, nodes.Text):
        return html.escape(node.astext())
    if isinstance(node, nodes.Invisible | nodes.raw | nodes.image):
        return ""
    if isinstance(node, nodes.math | nodes.math_block):
        return " "  # a formula's source is no sentence
    inside = "".join(_text(child) for child in node.children)
    if isinstance(node, nodes.TextElement) and not isinstance(node, nodes.Inline):
        inside = f" {inside} "
    for name in node["ids"] if isinstance(node, nodes.section) else []:
        inside = f'<section id="{html.escape(name, quote=True)}">{inside}</section>'
    return inside


def _write_text(app: Sphinx, tree: nodes.document, page: str) -> None:
    """The text of a page as a script, for `static/search_texts.js`."""
    target = Path(app.outdir) / "_texts" / f"{page}.js"
    target.parent.mkdir(parents=True, exist_ok=True)
    words = re.sub(r"\s+", " ", _text(tree))
    text = json.dumps(f'<div role="main">{words}</div>', ensure_ascii=False)
    target.write_text(f"searchText({json.dumps(page)}, {text});\n", encoding="utf-8")


def _excerpts(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: object) -> None:
    """The page of the search shows its excerpts from disk too."""
    if page == "search":
        app.add_js_file("search_texts.js")


def setup(app: Sphinx) -> None:
    """Draw equations by matplotlib, which gearpoly brings anyway."""
    app.connect("source-read", _made_by_the_package)
    app.connect("autodoc-process-signature", _aliases_by_name)
    app.connect("html-page-context", _options_whole)
    app.connect("html-page-context", _excerpts)
    app.connect("doctree-resolved", _write_text)
    app.add_html_math_renderer("drawn", inline_renderers=(_inline, None), block_renderers=(_block, None))
    app.config.html_math_renderer = "drawn"
