"""The answers as one page that needs nothing else: pictures inside, no scripts, no network."""

from __future__ import annotations

import base64
import html
import math
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from gearpoly.files.output import write_text
from gearpoly.study.answers import Answers
from gearpoly.study.causes import count_words
from gearpoly.study.groups import PERCENTILES
from gearpoly.study.outputs import describe
from gearpoly.study.statistics import Interval
from gearpoly.study.yields import DOES_NOT, KEEPS, NONE_DRAWN, yield_words

SHOWN = 60
"""Combinations that tables show; the JSON has all."""

STYLE = """
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --line: #d5dae0; --soft: #5b6672; --band: #f4f6f8; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --paper: #15181c; --line: #363d45; --soft: #9aa5b1; --band: #1d2126; }
  figure img { background: #ffffff; border-radius: 4px; }
}
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 72rem;
  margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin-bottom: .2rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
p.sub, figcaption, small { color: var(--soft); }
p.answer { font-size: 1.1rem; border-left: 4px solid #0072B2; padding-left: .8rem; }
div.wide { overflow-x: auto; } table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } thead th { background: var(--band); }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; }
table.words th, table.words td { text-align: left; white-space: normal; min-width: 4rem; vertical-align: top; }
.bad { color: #D55E00; } .good { color: #009E73; }
"""


def write_page(answers: Answers, target: Path) -> None:
    """Write the page of ``answers`` to ``target``, whole or not at all."""
    from gearpoly.study.pictures import draw_all

    with tempfile.TemporaryDirectory(prefix="gearpoly-") as folder:
        figures = [
            f'<figure><img alt="{_text(caption)}" src="data:image/svg+xml;base64,'
            f'{base64.b64encode(file.read_bytes()).decode("ascii")}"><figcaption>{_text(caption)}</figcaption></figure>'
            for file, caption in draw_all(answers, Path(folder))
        ]
    write_text(target, page(answers, figures))


def page(answers: Answers, figures: Sequence[str]) -> str:
    """The page as text, with ready-made ``figures``."""
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{_text(answers.name)}</title><style>{STYLE}</style></head><body>",
        f"<h1>{_text(answers.name)}</h1>",
        f'<p class="sub">gearpoly {_text(answers.manifest["gearpoly"])} study, {answers.pairs} pairs in '
        f"{len(answers.groups)} combinations, seed {answers.manifest['seed']}, "
        f"intervals of {100.0 * answers.confidence:g} %</p>",
        *(f'<p class="sub">{_text(remark)}</p>' for remark in answers.remarks),
    ]
    if answers.causes:
        parts += ["<h2>Pairs without a result</h2>", *_causes(answers)]
    for one in answers.cheapest:
        parts += [f'<p class="answer"><b>{_text(one.found.words)}:</b> {_text(line)}</p>' for line in one.says]
    if answers.yields:
        parts.append("<h2>Yield</h2>")
        for found in answers.yields:
            rows = [
                [_text(group.label), _text(yield_words(found, answers.groups, k)),
                 f'<span class="{_tone(found.verdicts[k])}">{_text(found.verdicts[k])}</span>']
                for k, group in enumerate(answers.groups)
            ]  # fmt: skip
            parts += [f"<p>{_text(found.words)}</p>", _table(["combination", "pairs that keep it", ""], rows)]
    parts.append("<h2>Pictures</h2>")
    parts += figures
    if any(indices for _, indices in answers.sensitivity):
        parts += ["<h2>What drives it</h2>", _sensitivity(answers)]
    parts.append("<h2>Percentiles</h2>")
    parts.append("<p><small>Estimate, and in brackets the interval between two order statistics; an open end is one "
                 "that so few pairs do not place.</small></p>")  # fmt: skip
    for name in answers.store.plan.file.outputs:
        parts.append(f"<h3>{_text(name)}</h3><p><small>{_text(describe(name))}</small></p>")
        head = ["combination", "pairs", "mean", "std", *(f"{p:g} %" for p in PERCENTILES), "greatest"]
        parts.append(_table(head, _percentile_rows(answers, name)))
    parts.append("</body></html>")
    return "\n".join(parts)


def _causes(answers: Answers) -> list[str]:
    """Why pairs have no result, and what that means for the yields."""
    rows = [[str(one.pairs), _text(one.status.replace("_", " ")), f'{_text(one.reason)}',
             f'{_text(one.example)}'] for one in answers.causes]  # fmt: skip
    says = " ".join(count_words(answers.causes, pairs=answers.pairs))
    return [
        f"<p>{_text(says)}</p>",
        _table(["pairs", "status", "cause, with the numbers of the example", "example"], rows, kind="words"),
    ]


def _percentile_rows(answers: Answers, name: str) -> list[list[str]]:
    rows = []
    for group in answers.groups:
        sample = group.sample(name)
        greatest = number(float(sample.values[-1])) if sample.values.size else ""
        rows.append([_text(group.label), str(sample.values.size), interval(sample.mean), number(sample.std),
                     *(interval(found) for _, found in sample.percentiles), greatest])  # fmt: skip
    return rows


def _sensitivity(answers: Answers) -> str:
    rows = [
        [_text(name), _text(one.factor), interval(one.first), interval(one.total)]
        for name, indices in answers.sensitivity
        for one in indices
    ]
    return _table(["output", "factor", "on its own", "has a part in"], rows, shown=4 * SHOWN)


def number(value: float) -> str:
    """A number as a table shows it."""
    return f"{value:.4g}" if math.isfinite(value) else ""


def interval(one: Interval) -> str:
    """An estimate with its interval, open ends as such."""
    low = number(one.low) or "open"
    high = number(one.high) or "open"
    return f"{number(one.value)} ({low} to {high})" if math.isfinite(one.value) else ""


def _tone(verdict: str) -> str:
    return {KEEPS: "good", DOES_NOT: "bad", NONE_DRAWN: "bad"}.get(verdict, "")


def _text(value: object) -> str:
    return html.escape(str(value))


def _table(head: Iterable[str], rows: Sequence[Sequence[str]], *, shown: int = SHOWN, kind: str = "") -> str:
    body = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows[:shown])
    more = f"<p><small>{len(rows) - shown} more rows are in the JSON.</small></p>" if len(rows) > shown else ""
    top = "".join(f"<th>{_text(cell)}</th>" for cell in head)
    table = f'<table class="{kind}"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>'
    return f'<div class="wide">{table}</div>{more}'
