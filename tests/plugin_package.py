"""Packages as an installer leaves them: modules on the path, and the metadata that hold their entry points.

One is the package of docs/howto/own_package.md, as it stands there.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "howto" / "own_package.md"


def files_of_the_page() -> dict[str, str]:
    """The files that the page shows, by their paths in the package, and the empty one that it speaks of."""
    shown = re.findall(r"^`([\w./]+)`\n\n```\w+\n(.*?)^```", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    return {"gearpoly_rig/__init__.py": "", **dict(shown)}


def install(folder: Path, name: str, modules: dict[str, str], points: str, *, version: str = "1.0") -> Path:
    """Lay ``modules`` by path and the metadata of package ``name`` with its ``points`` into ``folder``."""
    for path, text in modules.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    info = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(points, encoding="utf-8")
    return folder


def install_page(folder: Path) -> Path:
    """Install the package of the page."""
    held = files_of_the_page()
    project = tomllib.loads(held.pop("pyproject.toml"))["project"]
    points = "".join(
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in mine.items())
        for group, mine in project["entry-points"].items()
    )
    return install(folder, project["name"], held, points, version=project["version"])
