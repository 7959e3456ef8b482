"""The contact debugger as one self-contained page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gearpoly.errors import OutOfRangeError
from gearpoly.files.output import check_target
from gearpoly.page.render import render


def page_text(document: dict[str, Any]) -> str:
    """The page for ``document`` (of ``gearpoly.view.document``) as HTML; it loads nothing from anywhere."""
    return render("view/page/template.html", name=document["name"], data=document)


def check_page(target: Path) -> None:
    """Raise ``OutOfRangeError`` for a name that is no page's, ``InputFileError`` for a place that cannot be written."""
    if str(target) != "-" and target.suffix.lower() not in {".html", ".htm"}:
        raise OutOfRangeError(f"--html {target}: the contact debugger is a page; want a name ending in .html")
    check_target(target)
