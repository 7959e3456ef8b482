"""A diagnosis as one page that a browser opens from disk: words and tables in it, plots drawn by its own scripts."""

from __future__ import annotations

from markupsafe import Markup

from gearpoly import __version__
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.page.render import render
from gearpoly.report import diagnosis_findings, diagnosis_tables
from gearpoly.report.diagnosis_data import document


def page(diagnosis: Diagnosis) -> str:
    """The page as HTML; it loads nothing from anywhere."""
    comparison = diagnosis.comparison
    parts = {
        "verdict": diagnosis_findings.verdict(diagnosis),
        "findings": diagnosis_findings.findings(diagnosis),
        "fit": diagnosis_findings.fit(diagnosis),
        "where": diagnosis_tables.entries(
            comparison.located.entries,
            none="Nothing beyond noise, and beyond what inspection or grade leave open of each tooth.",
            sky=sky_of(comparison),
        ),
        "unexplained": diagnosis_tables.entries(
            diagnosis.unexplained, none="Nothing is left that stands out of the noise.", sky=sky_of(comparison)
        ),
        "as_built": diagnosis_tables.as_built(diagnosis),
        "alignment": diagnosis_tables.alignment(diagnosis),
        "recordings": diagnosis_tables.recordings(diagnosis),
        "not_excluded": diagnosis_tables.bullets(
            diagnosis.not_excluded, none="These recordings could have shown all of the catalogue."
        ),
        "remarks": diagnosis_tables.bullets(diagnosis.remarks, none="None."),
        "timings": diagnosis_tables.timings(diagnosis),
    }
    return render(
        "report/page/template.html",
        name=comparison.name,
        about=_about(diagnosis),
        data=document(diagnosis),
        **{name: Markup(text) for name, text in parts.items()},
    )


def _about(diagnosis: Diagnosis) -> str:
    comparison = diagnosis.comparison
    pair = comparison.assembled.pair
    count = len(comparison.aligned)
    return (
        f"{pair.driving.gear.z} teeth drive {pair.driven.gear.z}, module {pair.driving.gear.m:g} mm; {count} "
        f"recording{'s' if count > 1 else ''}; gearpoly {__version__}"
    )
