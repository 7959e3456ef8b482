"""``gearpoly prove``: the proving ground of concealed effects."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearpoly.arguments import WORKERS

if TYPE_CHECKING:
    from gearpoly.report.terminal import Terminal

ORDER = 70


def prove(
    quick: Annotated[bool, typer.Option("--quick", help="A few cases of every class, without controls.")] = False,
    ground: Annotated[
        str | None, typer.Option(help="bench (default), short (half a hunting cycle to two) or real-life.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the ground (default: 1); another one makes cases that nobody has seen.")
    ] = None,
    json: Annotated[
        Path | None, typer.Option(help="Write every figure of the scoreboard (JSON; - for standard output).")
    ] = None,
    on: Annotated[
        Path | None, typer.Option(help="Score a folder of NAME/pair.toml, NAME/rec_K.csv and NAME.truth.json instead.")
    ] = None,
    real: Annotated[
        Path | None, typer.Option(help="Score a folder of real recordings with NAME.judgement.json instead.")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default: one per core.", min=WORKERS.least)] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of cases and verdicts; a killed run goes on there.")] = None,
) -> None:
    """Conceal effects, diagnose them, open the truths, and print the scoreboard."""
    import os
    import sys

    from gearpoly.files.output import check_target, say_written, write_text
    from gearpoly.prove.board import board_json
    from gearpoly.prove.page import board_text
    from gearpoly.prove.run import prove_folder, prove_ground
    from gearpoly.prove.show import print_board
    from gearpoly.proving.grounds import BENCH
    from gearpoly.report.terminal import Terminal

    if json is not None:
        check_target(json)
    _refuse_contradictions(quick=quick, ground=ground, seed=seed, on=on, real=real)
    ground = BENCH if ground is None else ground
    seed = 1 if seed is None else seed
    stream = sys.stderr if str(json) == "-" else sys.stdout
    console = Terminal(file=stream, width=None if stream.isatty() else 160)

    def say(what: str) -> None:
        console.print(what, highlight=False, soft_wrap=True)

    count = workers or os.cpu_count() or 1
    if real is not None:
        _prove_real(real, json=json, workers=count, out=out, console=console, say=say)
        return
    if on is not None:
        place = out or Path("out") / "prove" / f"on-{os.path.basename(os.path.abspath(on))}"
        proof = prove_folder(on, out=place, workers=count, say=say)
    else:
        which = "" if ground == BENCH else f"{ground}-"
        place = out or Path("out") / "prove" / f"{which}seed-{seed}{'-quick' if quick else ''}"
        proof = prove_ground(seed, quick=quick, out=place, workers=count, say=say, ground=ground)
    board = board_json(proof)
    if json is not None:
        write_text(json, board_text(board))
    if str(json) != "-":
        print_board(console, board)
    sys.stdout.flush()
    say_written(place, "cases and verdicts")
    say_written(json, "the scoreboard")


def _refuse_contradictions(
    *, quick: bool, ground: str | None, seed: int | None, on: Path | None, real: Path | None
) -> None:
    """Raise ``OutOfRangeError`` for options that do not go together, or a ground or seed that is none."""
    from gearpoly.errors import OutOfRangeError
    from gearpoly.proving.grounds import GROUNDS

    if real is not None and (on is not None or quick or seed is not None or ground is not None):
        wish = "it goes without --on, --quick, --seed and --ground"
        raise OutOfRangeError(f"--real scores a folder of judged recordings; {wish}")
    if on is not None and quick:
        raise OutOfRangeError("--quick is for the seeded ground; a folder given with --on is scored as it is")
    if on is not None and seed is not None:
        raise OutOfRangeError("--seed is for the seeded ground; a folder given with --on is scored as it is")
    if on is not None and ground is not None:
        raise OutOfRangeError("--ground is for seeded cases; a folder given with --on is scored as it is")
    if ground is not None and ground not in GROUNDS:
        raise OutOfRangeError(f"--ground {ground}: want one of {', '.join(GROUNDS)}")
    if seed is not None and seed < 0:
        raise OutOfRangeError(f"--seed {seed}: want 0 or a positive whole number")


def _prove_real(
    real: Path, *, json: Path | None, workers: int, out: Path | None, console: Terminal, say: Callable[[str], None]
) -> None:
    """Score a folder of judged recordings. Raises ``GearpolyError`` for those that could not be read."""
    import sys
    from json import dumps

    from gearpoly.errors import GearpolyError
    from gearpoly.files.output import say_written, write_text
    from gearpoly.prove.real import prove_real, real_json
    from gearpoly.prove.show import print_real

    place = out or Path("out") / "prove" / f"real-{real.resolve().name}"
    scores, wrong = prove_real(real, out=place, workers=workers, say=say)
    if json is not None:
        write_text(json, dumps(real_json(scores), indent=1))
    if str(json) != "-":
        print_real(console, scores)
    sys.stdout.flush()
    say_written(place, "verdicts")
    say_written(json, "the scores")
    if wrong:
        # The others are scored; what could not be read is said last, where it is seen.
        raise GearpolyError("; ".join(wrong))
