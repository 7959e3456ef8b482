"""Hand-made cases, truths, verdicts, and diagnosers that only pretend."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearpoly.prove.diagnoser import How

PAIR = """name = "made"
[driving]
teeth = 18
module_mm = 2.0
[driven]
teeth = 25
module_mm = 2.0
"""


def claim(physics: str, gear: str | None = None, *, rivals: Sequence[dict[str, Any]] = (), **more: Any) -> Any:
    """An entry of ``missing``; ``more`` are parameters as (value, std), and tooth or encoder_deg."""
    out: dict[str, Any] = {"physics": physics, "parameters": {}, "indistinguishable_from": list(rivals)}
    if gear:
        out["gear"] = gear
    for name, value in more.items():
        if name in ("tooth", "encoder_deg"):
            out[name] = value
        else:
            out["parameters"][name] = {"value": value[0], "std": value[1]}
    return out


def verdict(*claims: Any, unexplained: Sequence[Any] = (), before: float = 2.0, after: float = 1.0) -> dict[str, Any]:
    """A verdict with some claims."""
    status = "explained" if claims else "unexplained" if unexplained else "nothing_missing"
    return {
        "status": status,
        "missing": list(claims),
        "unexplained": list(unexplained),
        "fit": {"heldout_rms_um": {"before": before, "after": after}},
    }


def write_cases(folder: Path, truths: dict[str, dict[str, Any]]) -> Path:
    """A folder as `gearpoly prove --on` wants it; each recording holds the name of its case."""
    for name, truth in truths.items():
        place = folder / name
        place.mkdir(parents=True)
        (place / "pair.toml").write_text(PAIR)
        for k in range(2):
            (place / f"rec_{k}.csv").write_text(f"# name = {name}\ntime_s\n{k}\n")
        (folder / f"{name}.truth.json").write_text(json.dumps({"noise_um": 1.0, "concealed_by": "", **truth}))
    return folder


BENCH: dict[str, dict[str, Any]] = {
    "alpha": {"kind": "none", "truth": []},
    "beta": {"kind": "missing", "truth": [{"physics": "eccentricity", "gear": 1, "amplitude_um": 5.0}]},
    "gamma": {
        "kind": "missing",
        "truth": [
            {"physics": "tooth_spall", "gear": 2, "tooth": 9, "teeth": 25, "encoder_deg": 100.0, "depth_um": 6.0}
        ],
    },
    "delta": {"kind": "unknown", "truth": [{"order": 4.41, "gear": 1, "amplitude_um": 0.6}]},
}


def fake(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Knows the cases by name: right on beta, the wrong tooth on gamma, a false alarm on alpha, delta located."""
    name = recordings[0].read_text().split()[3]
    assert [path.name for path in recordings] == ["rec_0.csv", "rec_1.csv"]
    assert not list(pair.parent.glob("*.truth.json"))
    said = {
        "alpha": verdict(claim("friction", coefficient=(0.01, 0.001))),
        "beta": verdict(claim("eccentricity", "driving", amplitude_um=(5.1, 0.2))),
        "gamma": verdict(claim("tooth_spall", "driven", tooth=10, encoder_deg=114.4, depth_um=(6.0, 0.1))),
        "delta": verdict(unexplained=[{"kind": "shaft_order", "gear": "driving", "order": 4.41}]),
    }
    return said[name]


def slow(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """The same, and leaves a mark of every run beside the folder of cases; slow enough to be killed between."""
    with (pair.parents[1].parent / "runs.txt").open("a") as log:
        log.write(pair.parent.name + "\n")
    time.sleep(0.4)
    return fake(pair, recordings, how)


def stuck(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Right and quick on two cases, and on the others not done for an hour."""
    if pair.parent.name in ("beta", "gamma"):
        (pair.parents[1].parent / f"{pair.parent.name}.begun").touch()
        time.sleep(3600.0)
    return fake(pair, recordings, how)


def broken(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Fails on one case."""
    if pair.parent.name == "beta":
        raise ZeroDivisionError("no such luck")
    return fake(pair, recordings, how)


def silent(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Finds nothing, ever."""
    return verdict()


def endless(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Comes to no end on one case."""
    while pair.parent.name == "beta":
        pass
    return fake(pair, recordings, how)
