"""The lost Table 1 as an inverse problem: which module, face width and lower thickness deviation bring the paper's own
numbers out?

Tooth compliance times face width is the same at every module, so deflection under a torque goes with 1/(m b) and the
softening by thinning with E_sni/(m b). The contact ratios therefore say m b, the compliance differences E_sni, and only
the angle of TEpp and the tolerances' own dependence on m say m.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.gear import Gear
from gearpoly.mesh.deflection import PairCompliance, pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.pair import mount
from gearpoly.mesh.transmission import NEAR_PAIR_MM
from gearpoly.studies.paper.allowances import handbook_thickness
from gearpoly.studies.paper.base import (
    LOADS,
    PAPER_ELASTICITY,
    PAPER_POSITIONS,
    PairRecipe,
    PaperAnswer,
    PaperRow,
    PaperStudy,
    Question,
    along_line_of_action,
    flanks_of,
    peak_to_peak,
    touch,
    verdict,
)
from gearpoly.studies.paper.kinds import PAPER as PAPER_TEPP
from gearpoly.studies.paper.loads import PAPER_COUNTS
from gearpoly.studies.paper.picture import Line, Panel, PaperPicture
from gearpoly.studies.paper.thickness import PAPER_TIP, compliance
from gearpoly.units import NM, UM, FloatArray

ISO_54_SERIES_1_MODULES = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
"""mm. ISO 54, series I."""

PRODUCTS = np.geomspace(12.0, 120.0, 15)
"""mm^2. Module times face width."""

MODULES_WIDE, MODULES_NARROW = 10.0, 5.0
"""Modules of face width at which tables are made: plane strain begins at 7.85, five thicknesses."""

THINNING = np.linspace(0.0, 0.2, 21)
"""-E_sni over the module."""

FITS = 3.5
"""Chi square of three contact ratios, one number fitted to them, and TEpp, below which a pair is not worse than chance
makes one in three."""


@dataclass(frozen=True, kw_only=True)
class PairTried:
    """One module of one edition with the face width that suits the contact ratios best.

    ``counts`` (3,) mean over sets at 5, 15 and 25 N.m with their ``spread``; ``chi2`` against the paper's;
    ``te``, ``te_spread`` TEpp in arcmin; ``E_sni`` in um for the paper's tip difference, ``handbook`` by the rule.
    """

    edition: int
    m: float
    b: float
    counts: FloatArray
    spread: FloatArray
    chi2: FloatArray
    te: float
    te_spread: float
    E_sni: float
    handbook: float

    @property
    def te_chi2(self) -> float:
        """Squared distance of the paper's TEpp from the sets' mean in their standard deviations."""
        return ((PAPER_TEPP[0] - self.te) / self.te_spread) ** 2

    @property
    def score(self) -> float:
        """Chi square of contact ratios and TEpp."""
        return float(np.min(self.chi2)) + self.te_chi2


def softening() -> dict[bool, FloatArray]:
    """Softening of the tip times face width, um mm/N, at ``THINNING``; by whether the tooth is wide."""
    out = {}
    for wide, b in ((True, MODULES_WIDE), (False, MODULES_NARROW)):
        gear = Gear(z=18, m=1.0, b=b)
        tip = np.array([gear.r_a])
        c = np.array([compliance(gear, tip, E_s=-share)[0] for share in THINNING]) * b
        out[wide] = c - c[0]
    return out


def _scaled(tables: dict[bool, PairCompliance], m: float, b: float) -> PairCompliance:
    """The pair at face width ``b`` mm: tooth compliance goes with 1/b but for plane strain or stress."""
    base = tables[b / m > 0.5 * (MODULES_WIDE + MODULES_NARROW)]
    share = base.b / b
    return replace(
        base,
        b=b,
        driving=replace(base.driving, c=base.driving.c * share),
        driven=replace(base.driven, c=base.driven.c * share),
    )


def counts_of(recipe: PairRecipe, products: FloatArray, *, seed: int) -> tuple[FloatArray, float]:
    """Touching pairs at the paper's positions for all face widths and its three loads (k, 3), nan where deflections are
    no longer small, and TEpp in arcmin."""
    m = recipe.m
    pair = mount(*flanks_of(recipe, seed=seed))
    # Scatter on a small module folds the outline as a beam sees it, and adds nothing to compliance.
    plain = {
        wide: pair_compliance(mount(*flanks_of(recipe.with_(profile="none", b=b * m), seed=seed)), PAPER_ELASTICITY)
        for wide, b in ((True, MODULES_WIDE), (False, MODULES_NARROW))
    }
    widths = products / m
    reach = load_reach(_scaled(plain, m, float(widths[0])), LOADS[-1] * NM)
    found = along_line_of_action(pair, touch(pair, PAPER_POSITIONS, near=NEAR_PAIR_MM + reach))
    counts = np.full((widths.size, 3), np.nan)
    for k, b in enumerate(widths):
        bends = _scaled(plain, m, float(b))
        try:
            for i, torque in enumerate(LOADS[1:]):
                counts[k, i] = np.sum(loaded(found, bends, torque=torque * NM).pairs)
        except OutOfRangeError:
            counts[k] = np.nan
    return counts, peak_to_peak(found.te)


def candidate(recipe: PairRecipe, *, sets: int, soft: dict[bool, FloatArray]) -> PairTried:
    """The best face width for ``recipe``'s module, from ``sets`` draws."""
    runs = [counts_of(recipe, PRODUCTS, seed=seed) for seed in range(sets)]
    counts = np.array([run[0] for run in runs])
    te = np.array([run[1] for run in runs])
    # The paper's is one draw: its distance counts in the standard deviation of single sets.
    mean, spread = np.mean(counts, axis=0), np.maximum(np.std(counts, axis=0, ddof=1), 3.0)
    chi2 = np.sum(((mean - np.array(PAPER_COUNTS[1:])) / spread) ** 2, axis=1)
    chi2 = np.where(np.isnan(chi2), np.inf, chi2)
    best = int(np.argmin(chi2))
    b = float(PRODUCTS[best]) / recipe.m
    gear = recipe.gears[0]
    a = 0.5 * sum(recipe.z) * recipe.m
    return PairTried(
        edition=recipe.edition,
        m=recipe.m,
        b=b,
        counts=mean[best],
        spread=spread[best],
        chi2=chi2,
        te=float(np.mean(te)),
        te_spread=float(np.std(te, ddof=1)),
        E_sni=needed_thinning(PAPER_TIP[0], m=recipe.m, b=b, soft=soft),
        handbook=handbook_thickness(gear, a=a, grade=4, edition=recipe.edition)[1] / UM,
    )


def needed_thinning(difference: float, *, m: float, b: float, soft: dict[bool, FloatArray]) -> float:
    """E_sni in um that softens the tip of 18 teeth by ``difference`` um/N; nan beyond ``THINNING``."""
    curve = soft[b / m > 0.5 * (MODULES_WIDE + MODULES_NARROW)]
    share = np.interp(difference * b, curve, THINNING, right=np.nan)
    return -float(share) * m / UM


def ask(study: PaperStudy) -> PaperAnswer:
    """Every module of ISO 54 with its best face width, judged by contact ratios and TEpp, and E_sni from the tips."""
    soft = softening()
    modules = ISO_54_SERIES_1_MODULES if study.refine == 1 else (1.5, 2.0, 4.0)
    sets = max(3, study.sets // 2)
    points = min(study.points, 1000)
    found = [
        candidate(PairRecipe(m=m, edition=edition, points=points), sets=sets, soft=soft)
        for edition in ((1995, 2013) if study.refine == 1 else (1995,))
        for m in modules
    ]
    best = min(found, key=lambda c: c.score)
    by_tip = min(found, key=lambda c: abs(np.log(c.E_sni / c.handbook)) if np.isfinite(c.E_sni) else np.inf)
    fits = [c for c in found if c.score <= FITS]
    products = np.array([c.m * c.b for c in found])
    good = [float(np.min(c.chi2)) for c in found]
    counted = ", ".join(f"{n / 361:.4f}" for n in best.counts)
    E_4 = needed_thinning(PAPER_TIP[0], m=best.m, b=best.b, soft=soft)
    E_5 = needed_thinning(sum(PAPER_TIP), m=best.m, b=best.b, soft=soft)
    rows = (
        PaperRow(
            what="inverse: module and face width from contact ratios and TEpp",
            paper="Table 1 lost; 1.1634, 1.4100, 1.6066; 2.8083'",
            gearpoly=(
                f"best m = {best.m:g} mm, b = {best.b:.0f} mm, edition {best.edition}: {counted}; TEpp "
                f"{best.te:.2f} +- "
                f"{best.te_spread:.2f}'"
            ),
            verdict=verdict(best.score <= FITS, best.score <= 3.0 * FITS),
            why=(
                f"chi square {best.score:.1f} for 4 numbers. Not unique: "
                + (", ".join(f"m {c.m:g} b {c.b:.0f} ({c.edition})" for c in fits) or "none")
                + f" fit as well. Contact ratios say m b = {np.min(products):.0f} to {np.max(products):.0f} mm^2 only"
            ),
        ),
        PaperRow(
            what="inverse: pair at which the handbook's E_sni also makes the tip difference",
            paper="one pair made all",
            gearpoly=f"m = {by_tip.m:g} mm, b = {by_tip.b:.1f} mm ({by_tip.edition}): E_sni {by_tip.E_sni:.0f} um "
            f"by the tip, "
            f"{by_tip.handbook:.0f} um by the rule, but TEpp {by_tip.te:.2f} +- {by_tip.te_spread:.2f}'",
            verdict=verdict(by_tip.score <= FITS, False),
            why="TEpp asks for a small module, the tip difference for a large one or for teeth thinned twice as much",
        ),
        *_thickness_rows(best, E_4=E_4, E_5=E_5),
    )
    return PaperAnswer(
        rows=rows,
        pictures=(_picture(found),),
        text=_text(found, sets=sets, points=points),
        values={
            "score": [c.score for c in found],
            "count_chi2": good,
            "product": products,
            "best": [best.m, best.b, best.score],
            "ratio": E_5 / E_4,
            "counts": [c.counts for c in found],
        },
    )


def _thickness_rows(best: PairTried, *, E_4: float, E_5: float) -> tuple[PaperRow, ...]:
    """What the tips ask of E_sni in um of two grades, beside the handbook's rule."""
    grade_5 = handbook_thickness(best_gear(best), a=21.5 * best.m, grade=5, edition=best.edition)[1] / UM
    return (
        PaperRow(
            what="inverse: E_sni of grade 4 from the tip difference",
            paper="0.3797e-3 um/N",
            gearpoly=f"{E_4:.0f} um at the best pair; handbook rule {best.handbook:.0f} um",
            verdict=verdict(abs(E_4 / best.handbook - 1.0) < 0.15, abs(E_4 / best.handbook - 1.0) < 0.5),
            why="one number for three unknowns: only E_sni/(m b) is determined",
        ),
        PaperRow(
            what="inverse: E_sni of grade 5 over grade 4",
            paper="0.0484/0.3797 at the tip; backlash +8.11 %",
            gearpoly=f"{100.0 * (E_5 / E_4 - 1.0):+.1f} % by the tips; "
            f"{100.0 * (grade_5 / best.handbook - 1.0):+.1f} % by the "
            "handbook rule",
            verdict=verdict(abs(E_5 / E_4 - grade_5 / best.handbook) < 0.02, E_5 < E_4),
            why="the ratio does not depend on m or b; the paper's own two numbers ask for different steps of E_sni",
        ),
    )


def _text(found: list[PairTried], *, sets: int, points: int) -> tuple[str, ...]:
    """What was tried, and all pairs that were."""
    good = [float(np.min(c.chi2)) for c in found]
    lines = [
        "| edition | m / mm | b / mm | m b | counts at 5, 15, 25 N.m | chi2 | TEpp / arcmin | chi2 | E_sni by tip "
        "/ um | by rule / um |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    lines += [
        f"| {c.edition} | {c.m:g} | {c.b:.1f} | {c.m * c.b:.0f} | {', '.join(f'{n:.0f}' for n in c.counts)} | "
        f"{np.min(c.chi2):.1f} | "
        f"{c.te:.2f} +- {c.te_spread:.2f} | {c.te_chi2:.1f} | {c.E_sni:.0f} | {c.handbook:.0f} |"
        for c in found
    ]
    return (
        f"{sets} sets for each module, {points} points per flank, paper's counts {PAPER_COUNTS[1:]} and TEpp "
        f"{PAPER_TEPP[0]}'. Contact "
        f"ratios alone are met by every module (chi square {min(good):.1f} to {max(good):.1f}); TEpp, which is one "
        f"draw, prefers small "
        "ones. Material, law, edition and the way profiles are drawn are assumptions too.",
        "\n".join(lines),
    )


def best_gear(best: PairTried) -> Gear:
    """The driving gear of a candidate."""
    return Gear(z=18, m=best.m, b=best.b)


def _picture(found: list[PairTried]) -> PaperPicture:
    editions = sorted({c.edition for c in found})
    by_edition = {e: [c for c in found if c.edition == e] for e in editions}
    scores, thin = [], []
    for k, (edition, mine) in enumerate(by_edition.items()):
        m = [c.m for c in mine]
        scores.append(
            Line(x=m, y=[c.score for c in mine], colour=k, style="joined", label=f"contact ratios and TEpp, {edition}")
        )
        scores.append(
            Line(
                x=m,
                y=[float(np.min(c.chi2)) for c in mine],
                colour=k,
                style="dashed",
                label=f"contact ratios, {edition}",
            )
        )
        thin.append(
            Line(x=m, y=[-c.E_sni for c in mine], colour=k, style="joined", label=f"from the tip difference, {edition}")
        )
        thin.append(
            Line(x=m, y=[-c.handbook for c in mine], colour=k, style="dashed", label=f"handbook rule, {edition}")
        )
    products = [
        Line(
            x=PRODUCTS, y=np.where(np.isfinite(c.chi2), c.chi2, np.nan), colour=k, label=f"m = {c.m:g} mm", style="line"
        )
        for k, c in enumerate(c for c in by_edition[editions[0]] if c.m in (1.5, 2.0, 4.0, 8.0))
    ]
    return PaperPicture(
        name="inverse",
        caption="What the paper's contact ratios, TEpp and tip compliance say of its lost module, face width and "
        "E_sni.",
        panels=(
            Panel(x="module / mm", y="chi square", lines=tuple(scores), log=True),
            Panel(
                x="module times face width / mm^2",
                y="chi square of the contact ratios",
                lines=tuple(products),
                log=True,
            ),
            Panel(x="module / mm", y="-E_sni of grade 4 / um", lines=tuple(thin)),
        ),
    )


QUESTION = Question(order=9, name="inverse", title="The lost Table 1", ask=ask)
