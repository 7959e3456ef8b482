"""The contact debugger as one self-contained page."""

from __future__ import annotations

from typing import Any

from gearpoly.page.render import render


def page_text(document: dict[str, Any]) -> str:
    """The page for ``document`` (of ``gearpoly.view.document``) as HTML; it loads nothing from anywhere."""
    return render("view/page/template.html", name=document["name"], data=document)
