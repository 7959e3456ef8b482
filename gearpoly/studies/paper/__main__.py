"""The whole study: ``python -m gearpoly.studies.paper --out docs/explanation [--quick] [--only NAME]``."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from gearpoly.errors import GearpolyError, OutOfRangeError
from gearpoly.files.output import check_target, write_text
from gearpoly.studies.paper import questions
from gearpoly.studies.paper.base import PaperAnswer, PaperRow, PaperStudy, Question

PAPER_PAGE_HEAD = """# The paper, asked again

Liu, Shi, Cura, Mura: *A novel method to predict static transmission error for spur gear pair based on accuracy grade*,
J. Cent. South Univ. 27 (2020) 3334-3349. Every question is a module of `gearpoly/studies/paper/`; this page and its
figures are made by

    python -m gearpoly.studies.paper --out docs/explanation

## What was taken

- **Table 1 is lost.** Taken: m = 2 mm, b = 20 mm, steel (206 GPa, 0.3), ISO 53 A, the true trochoid; 18/25 teeth follow
  from the contact ratio 1.5707. The last question looks for the module and face width that the paper's numbers ask for.
- **Error gears** (Eqs. 1-7): closed chains of single pitch within f_pt and F_p, each tooth's thickness on its own and
  verified by W_k, profiles scattered point by point within F_alpha, {points} points per flank. Smooth profiles stand
  beside them where it matters. Edition 1995 of ISO 1328-1 unless said: f_pt is its symbol; 2013 stands beside it.
- **Thickness**: E_sns = -j_bn/(2 cos alpha), E_sni = E_sns - 2 tan(alpha) sqrt(F_r^2 + b_r^2), the handbook rule that
  goes with ISO/TR 10064-2 (`allowances.py`). Its lower deviations are nearly equal over grades 4 to 6, as the paper's.
- **Words**: ' is an arc minute. A *set* is one pair of error gears, drawn from one seed. Rand(1) is drawn evenly
  between 0 and 1. F_r is the tolerance of runout, b_r the allowance of the cutter's radial feed.
- **Positions**: 0 to 360 deg of the driven gear in 1 deg steps, both ends, 361 in all, as in the paper.
- **Seeds**: set k of every grade is seed k, 0 to {last}; driving and driven gear have streams of their own.
- **Load**: the published cantilever, Cornell's foundation, Palmgren as printed, the paper's load sharing; forces along
  the line of action, since a scattered flank has no normal that a force could follow.
- **Verdicts**: *agrees*: within the tolerance that the reason gives, or within the range of the sets; *same trend*: the
  sign or the order holds, the number does not or cannot be compared; *does not*.

## The table
"""


def table(rows: list[PaperRow]) -> str:
    """Rows as a markdown table."""
    lines = ["| what | paper | gearpoly | verdict | why |", "| --- | --- | --- | --- | --- |"]
    for row in rows:
        cells = (row.what, row.paper, row.gearpoly, row.verdict, row.why)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def page(study: PaperStudy, answers: list[tuple[Question, PaperAnswer]]) -> str:
    """The page of all ``answers`` in markdown."""
    parts = [PAPER_PAGE_HEAD.format(points=study.points, last=study.sets - 1)]
    parts.append(table([row for _, finding in answers for row in finding.rows]))
    for question, finding in answers:
        parts.append(f"\n## {question.title}\n")
        parts += [paragraph + "\n" for paragraph in finding.text]
        parts += [f"![{p.caption}](figures/{file_name(p.name)})\n\n{p.caption}\n" for p in finding.pictures]
    return "\n".join(parts).rstrip() + "\n"


def file_name(picture: str) -> str:
    """File of a picture."""
    return f"paper_{picture}.png"


def run(
    out: Path, *, study: PaperStudy, only: str | None = None, say: bool = True
) -> list[tuple[Question, PaperAnswer]]:
    """Ask all questions, or ``only`` one, and write figures and page into the folder ``out``.

    One question alone renews its figures and leaves the page as it is. Raises ``OutOfRangeError`` for a question that
    there is not.
    """
    from gearpoly.report.study_plots import draw_picture

    asked = [question for question in questions() if only in (None, question.name)]
    if not asked:
        names = ", ".join(question.name for question in questions())
        raise OutOfRangeError(f"no question {only!r}; there are {names}")
    figures = out / "figures"
    check_target(out / "paper.md")
    figures.mkdir(exist_ok=True)
    answers = []
    for question in asked:
        start = time.perf_counter()
        finding = question.ask(study)
        for picture in finding.pictures:
            draw_picture(picture, figures / file_name(picture.name))
        answers.append((question, finding))
        if say:
            print(f"{question.name}: {time.perf_counter() - start:.1f} s", file=sys.stderr)
            if only is not None:
                print(table(list(finding.rows)))
    if only is None:
        write_text(out / "paper.md", page(study, answers))
    return answers


def main(
    out: Annotated[Path, typer.Option(help="Folder for paper.md and figures/paper_*.png.")],
    quick: Annotated[bool, typer.Option("--quick", help="A few small sets: trends, no statistics.")] = False,
    only: Annotated[str | None, typer.Option(help="One question by name; prints its rows, leaves paper.md.")] = None,
) -> None:
    """Ask the paper's questions again: figures and the table paper, gearpoly, verdict."""
    try:
        run(out, study=PaperStudy.quick() if quick else PaperStudy(), only=only)
    except GearpolyError as error:
        print(f"error: {error}", file=sys.stderr)
        raise typer.Exit(2) from None


if __name__ == "__main__":
    typer.run(main)
