"""A diagnosis as one page that a browser opens from disk: words and tables in it, plots drawn by its own scripts."""

from __future__ import annotations

import json
import re
from html import escape
from importlib.resources import files

from gearpoly import __version__
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.report import diagnosis_findings, diagnosis_tables
from gearpoly.report.diagnosis_data import document

SHARED = ("data.js", "charts.js")
"""Scripts that the contact debugger draws with too."""

SCRIPTS = ("levels.js", "plot.js", "hands.js", "painters.js", "start.js")
"""The page's own, in the order in which they build on one another."""


def page(diagnosis: Diagnosis) -> str:
    """The page as HTML; it loads nothing from anywhere."""
    view, own = files("gearpoly.view") / "page", files("gearpoly.report") / "page"
    scripts = [(view / name).read_text(encoding="utf-8") for name in SHARED]
    scripts += [(own / name).read_text(encoding="utf-8") for name in SCRIPTS]
    # A name that holds "</script>" must not end the script that holds it.
    data = json.dumps(document(diagnosis), allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    comparison = diagnosis.comparison
    pieces = {
        "TITLE": escape(f"{comparison.name} - gearpoly diagnosis"),
        "STYLE": (own / "style.css").read_text(encoding="utf-8"),
        "NAME": escape(comparison.name),
        "ABOUT": escape(_about(diagnosis)),
        "VERDICT": diagnosis_findings.verdict(diagnosis),
        "FINDINGS": diagnosis_findings.findings(diagnosis),
        "FIT": diagnosis_findings.fit(diagnosis),
        "WHERE": diagnosis_tables.entries(
            comparison.located.entries,
            none="Nothing beyond noise, and beyond what inspection or grade leave open of each tooth.",
            sky=sky_of(comparison),
        ),
        "UNEXPLAINED": diagnosis_tables.entries(
            diagnosis.unexplained, none="Nothing is left that stands out of the noise.", sky=sky_of(comparison)
        ),
        "AS_BUILT": diagnosis_tables.as_built(diagnosis),
        "ALIGNMENT": diagnosis_tables.alignment(diagnosis),
        "RECORDINGS": diagnosis_tables.recordings(diagnosis),
        "NOT_EXCLUDED": diagnosis_tables.bullets(
            diagnosis.not_excluded, none="These recordings could have shown all of the catalogue."
        ),
        "REMARKS": diagnosis_tables.bullets(diagnosis.remarks, none="None."),
        "TIMINGS": diagnosis_tables.timings(diagnosis),
        "DATA": data,
        "SCRIPT": "(() => {\n\"use strict\";\n" + "\n".join(scripts) + "\n})();",
    }  # fmt: skip
    return filled((own / "template.html").read_text(encoding="utf-8"), pieces)


def filled(template: str, pieces: dict[str, str]) -> str:
    """``template`` with every ``{{NAME}}`` replaced; in one go, since a pair may be named like a placeholder.

    Raises ``KeyError`` for a name without a piece.
    """
    return re.sub(r"\{\{([A-Z_]+)\}\}", lambda found: pieces[found[1]], template)


def _about(diagnosis: Diagnosis) -> str:
    comparison = diagnosis.comparison
    pair = comparison.assembled.pair
    count = len(comparison.aligned)
    return (
        f"{pair.driving.gear.z} teeth drive {pair.driven.gear.z}, module {pair.driving.gear.m:g} mm; {count} "
        f"recording{'s' if count > 1 else ''}; gearpoly {__version__}"
    )
