"""The site of the docs: Sphinx, the pages as they stand in Markdown, one search that needs no network (`make docs`)."""

from __future__ import annotations

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

from gearpoly import __version__

project = "gearpoly"
author = "the gearpoly authors"
copyright = "MIT licence"
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["tutorial/pictures.py"]
myst_enable_extensions = ["dollarmath", "attrs_inline"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]
nitpicky = False

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
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True


def _inline(visitor: HTML5Translator, node: nodes.math) -> None:
    """An equation as MathML, which browsers draw by themselves: nothing is loaded from anywhere."""
    visitor.body.append(convert(node.astext()))
    raise nodes.SkipNode


def _block(visitor: HTML5Translator, node: nodes.math_block) -> None:
    visitor.body.append(f'<div class="math">{convert(node.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Draw equations as MathML."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    app.config.html_math_renderer = "mathml"
