"""The answers as one page that needs nothing else: pictures inside, no scripts, no network."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearpoly.files.output import write_text
from gearpoly.page.render import render
from gearpoly.study.answers import Answers
from gearpoly.study.causes import count_words
from gearpoly.study.groups import PERCENTILES, counted
from gearpoly.study.labels import asked_words, axis_label
from gearpoly.study.outputs import output
from gearpoly.study.statistics import Interval
from gearpoly.study.words import factor_words
from gearpoly.study.yields import DOES_NOT, KEEPS, NONE_DRAWN, yield_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TONES = {KEEPS: "good", DOES_NOT: "bad", NONE_DRAWN: "bad"}


def write_page(answers: Answers, target: Path) -> None:
    """Write the page of ``answers`` to ``target``, whole or not at all."""
    from matplotlib import rc_context

    from gearpoly.study.pictures import pictures

    # Letters as letters: the browser draws them in its own font, and none travels with each picture.
    with rc_context({"svg.fonttype": "none"}):
        figures = [
            {
                "caption": one.caption,
                "key": one.key,
                "panels": [_svg(figure) for figure in one.drawn()],
            }
            for one in pictures(answers)
        ]
    write_text(target, page(answers, figures))


def _svg(figure: Figure) -> str:
    """A picture as SVG in base64."""
    aside = io.BytesIO()
    figure.savefig(aside, format="svg", dpi=150, metadata={"Date": None})
    return base64.b64encode(aside.getvalue()).decode("ascii")


def page(answers: Answers, figures: Sequence[dict[str, Any]]) -> str:
    """The page as text, with ready-made ``figures``."""
    words = factor_words(answers.store.plan.file.sweep)
    seed, version = answers.manifest["seed"], answers.manifest["gearpoly"]
    return render(
        "report/page/study.html",
        name=answers.name,
        about=f"gearpoly {version} study, {answers.pairs} pairs ({counted(len(answers.groups))}), seed {seed}, "
        f"intervals of {100.0 * answers.confidence:g} %",
        remarks=answers.remarks,
        causes=_causes(answers),
        cheapest=[(_heading(asked_words(one.found)), line) for one in answers.cheapest for line in one.says],
        yields=_yields(answers),
        figures=figures,
        sensitivity=[
            (output(name).says, words.get(one.factor, one.factor), part_words(one.first), part_words(one.total))
            for name, indices in answers.sensitivity
            for one in indices
        ],
        head=["combination", "pairs", "mean", "std", *(f"{p:g} %" for p in PERCENTILES), "greatest"],
        outputs=[
            {"name": name, "says": _heading(axis_label(name, line=200)), "rows": _percentile_rows(answers, name)}
            for name in answers.store.plan.file.outputs
        ],
    )


def _causes(answers: Answers) -> dict[str, Any] | None:
    """Why pairs have no result, and what that means for the yields."""
    rows = [(one.pairs, one.status.replace("_", " "), one.reason, one.example) for one in answers.causes]
    return {"says": " ".join(count_words(answers.causes, pairs=answers.pairs)), "rows": rows} if rows else None


def _yields(answers: Answers) -> list[dict[str, Any]]:
    """How many pairs of each combination keep each limit, and what that means."""
    return [
        {
            "words": _heading(asked_words(found)),
            "outputs": [limit.output for limit in found.limits],
            "rows": [
                (
                    group.words,
                    yield_words(found, answers.groups, k),
                    {"tone": TONES.get(found.verdicts[k], ""), "verdict": found.verdicts[k]},
                )
                for k, group in enumerate(answers.groups)
            ],
        }
        for found in answers.yields
    ]


def _percentile_rows(answers: Answers, name: str) -> list[list[str]]:
    rows = []
    for group in answers.groups:
        sample = group.sample(name)
        greatest = number(float(sample.values[-1])) if sample.values.size else ""
        rows.append([group.words, str(sample.values.size), interval(sample.mean), number(sample.std),
                     *(interval(found) for _, found in sample.percentiles), greatest])  # fmt: skip
    return rows


def _heading(words: str) -> str:
    """Words as a heading begins."""
    return words[:1].upper() + words[1:]


def number(value: float) -> str:
    """A number as a table shows it."""
    return f"{value:.3g}" if math.isfinite(value) else ""


def part_words(one: Interval) -> str:
    """A share of the variance with its interval, which estimates may leave on both sides."""
    return f"{one.value:.2f} ({one.low:.2f} to {one.high:.2f})".replace("-0.00", "0.00")


def interval(one: Interval) -> str:
    """An estimate with its interval, open ends as such."""
    low = number(one.low) or "open"
    high = number(one.high) or "open"
    return f"{number(one.value)} ({low} to {high})" if math.isfinite(one.value) else ""
