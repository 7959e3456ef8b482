"""What a diagnosis found, in a few lines read from its JSON: the end of `make run`.

python examples/first_run.py out/diagnosis.json out/*.html out/*.png
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def told(verdict: dict[str, Any]) -> list[str]:
    """What was missing, and how well unseen data fit before and after."""
    missing = [one["says"] for one in verdict["missing"]] or ["Nothing is missing."]
    unseen = verdict["fit"]["heldout_rms_um"]
    return [
        "What was missing in the simulation:",
        *(f"  {k}. {says}" for k, says in enumerate(missing, start=1)),
        f"Unseen data: {unseen['before']:.2f} um rms before, {unseen['after']:.2f} um after. "
        f"The noise is {verdict['noise_um']:.2f} um.",
    ]


def main(verdict: Path, *written: Path) -> None:
    """Print what was found, and where to look."""
    print("\n".join(told(json.loads(verdict.read_text(encoding="utf-8")))))
    print("Look at:")
    for path in written:
        print(f"  {path}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
