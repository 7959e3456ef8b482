"""What all pages are made with: templates that escape, scripts in modules, and nothing from outside."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from jinja2 import DictLoader, UndefinedError

from gearpoly.page.bundle import bundle
from gearpoly.page.render import data_text, environment, part

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "gearpoly"
SCRIPTS = sorted([*PACKAGE.glob("*/page/*.js"), *PACKAGE.glob("page/kit/*.js")])
ENTRIES = ["report/page/start.js", "view/page/start.js"]

WEIGHT = 100_000
"""Bytes of a page's scripts together; with a long recording's data the whole page stays below 1.5 MB."""


def test_a_name_that_looks_like_a_template_is_left_alone_and_html_is_escaped() -> None:
    made = environment().overlay(loader=DictLoader({"a": "<p>{{ name }}</p>", "b": "{{ other }}"}))
    assert made.get_template("a").render(name="{{ 7 * 7 }} <b>") == "<p>{{ 7 * 7 }} &lt;b&gt;</p>"
    with pytest.raises(UndefinedError):
        made.get_template("b").render(name="x")


def test_data_do_not_end_their_script() -> None:
    assert data_text({"name": "</script>"}) == '{"name":"\\u003c/script>"}'
    with pytest.raises(ValueError, match="JSON compliant"):
        data_text([float("nan")])


def test_modules_come_after_what_they_import_and_once() -> None:
    files = {
        "a/x.js": (
            '// X.\n\nimport { y } from "./y.js";\nimport {\n  z,\n} from "../b/z.js";\nexport const x = y + z;\n'
        ),
        "a/y.js": 'import { z } from "../b/z.js";\nexport function y() { return z; }\n',
        "b/z.js": "export const z = 1; // import nothing\n",
    }
    made = bundle("a/x.js", files.__getitem__)
    lines = [line for line in made.splitlines() if line and not line.startswith("//")]
    assert lines == [
        "window.started = (async () => {", '"use strict";',
        "const z = 1; // import nothing", "function y() { return z; }", "const x = y + z;",
        "})();",
    ]  # fmt: skip
    files["b/z.js"] = 'import { x } from "../a/x.js";\n'
    with pytest.raises(ValueError, match=r"a/x\.js imports a/y\.js imports b/z\.js imports a/x\.js"):
        bundle("a/x.js", files.__getitem__)


@pytest.mark.parametrize("entry", ENTRIES)
def test_a_page_has_one_script_in_which_no_name_stands_twice(entry: str) -> None:
    text = bundle(entry, part)
    assert not re.search(r"^(import|export)\b", text, re.MULTILINE)
    declared = re.findall(r"^(?:const|let|class|function) (\{[^}]*\}|\[[^\]]*\]|\w+)", text, re.MULTILINE)
    names = [name for one in declared for name in re.findall(r"\w+", one)]
    assert len(names) == len(set(names)) > 40
    assert len(text.encode()) < WEIGHT


def test_every_script_is_in_a_page() -> None:
    seen: set[str] = set()

    def read(path: str) -> str:
        seen.add(path)
        return part(path)

    for entry in ENTRIES:
        bundle(entry, read)
    assert seen == {file.relative_to(PACKAGE).as_posix() for file in SCRIPTS}


def test_pages_name_nothing_outside_and_forbid_it() -> None:
    for file in [*SCRIPTS, *PACKAGE.rglob("page/**/*.css"), *PACKAGE.rglob("page/**/*.html")]:
        text = file.read_text(encoding="utf-8")
        assert not re.search(r"https?:|//[a-z]+\.[a-z]|@import|fetch\(|XMLHttpRequest|import\(", text), file.name
    assert "default-src 'none'" in part("page/kit/page.html")


def test_every_page_prints_on_a4() -> None:
    """All pages have the kit's style, and none a size of its own."""
    assert "@page { size: A4;" in part("page/kit/kit.css")
    styles = [file.read_text(encoding="utf-8") for file in PACKAGE.rglob("page/*.css")]
    assert styles and not any("@page" in style for style in styles)


def test_a_type_checker_finds_nothing_in_the_scripts() -> None:
    """TypeScript reads them as JavaScript with types in comments; a name that is not imported is an error, too."""
    found = shutil.which("tsc")
    if found is None:
        pytest.skip("no TypeScript on this machine; npm install --global typescript")
    ran = subprocess.run([found, "--project", str(ROOT)], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout


def test_templates_are_loaded_with_the_first_page_only() -> None:
    code = (
        "import sys\nimport gearpoly.view.html, gearpoly.page.render, gearpoly.commands.view\n"
        "assert 'jinja2' not in sys.modules\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, cwd=ROOT).returncode == 0
