"""A diagnosis as one page that a browser opens from disk: words and tables in it, plots drawn by its own scripts."""

from __future__ import annotations

from gearpoly import __version__
from gearpoly.compare.on_sky import sky_of
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.page.render import render
from gearpoly.report import diagnosis_findings as words
from gearpoly.report import diagnosis_tables as tables
from gearpoly.report.alike import together
from gearpoly.report.diagnosis_data import document
from gearpoly.report.diagnosis_words import number
from gearpoly.units import UM


def page(diagnosis: Diagnosis) -> str:
    """The page as HTML; it loads nothing from anywhere."""
    comparison = diagnosis.comparison
    sky = sky_of(comparison)
    return render(
        "report/page/template.html",
        name=comparison.name,
        about=_about(diagnosis),
        data=document(diagnosis),
        verdict=words.verdict(diagnosis),
        findings=words.findings(diagnosis),
        fit=words.fit(diagnosis),
        unseen=words.unseen(diagnosis),
        told_from=number(words.told_from(diagnosis) / UM, 3),
        where=tables.entries(comparison.located.where, sky=sky),
        unexplained=tables.entries(diagnosis.unexplained, sky=sky),
        as_built=tables.as_built(diagnosis),
        alignment=tables.alignment(diagnosis),
        recordings=tables.recordings(diagnosis),
        not_excluded=tables.sentences(diagnosis.not_excluded),
        remarks=tables.sentences(together(diagnosis.remarks)),
        timings=tables.timings(diagnosis),
    )


def _about(diagnosis: Diagnosis) -> str:
    comparison = diagnosis.comparison
    pair = comparison.assembled.pair
    count = len(comparison.aligned)
    return (
        f"{pair.driving.gear.z} teeth drive {pair.driven.gear.z}, module {pair.driving.gear.m:g} mm; {count} "
        f"recording{'s' if count > 1 else ''}; gearpoly {__version__}"
    )
