"""The scoreboard as a page: ``python -m gearpoly.prove.page SCOREBOARD.json docs/proof.md`` draws its figure, too."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from gearpoly.files.output import write_text
from gearpoly.prove.expert import FAILURES
from gearpoly.prove.show import EXPERT, UNLISTED, percent, value

MARKS = {True: "reached", False: "**missed**", None: ""}

MEANING = {
    "false_alarms": "false alarm",
    "false_names": "false name for a healthy pair",
    "detected": "not detected",
    "named_first": "right name not first",
    "both_named": "not all of several named",
    "right_tooth": "wrong tooth",
    "extras": "a further claim",
    "in_reported_set": "truth not in the reported set",
    "look_alikes_named_singly": "look-alike named singly",
    "smallest_tooth_pitch_um": "not named",
    "smallest_order_line_um": "not named",
    "relief_named": "relief not named to 0.3 um",
    "relief_found": "relief not named",
    "parameter_right": "size off",
    "coverage_1": "beyond 1 sigma",
    "coverage_2": "beyond 2 sigma",
    "energy_removed_share": "mismatch left",
    "strangers_located": "not located",
    "strangers_named": "false name for a stranger",
    "background_located": "background not located",
    "background_named": "false name beside a background",
    "false_alarms_background": "false alarm",
    "errors": "error",
}
"""What a case that misses a row did, in words."""


def board_text(board: dict[str, Any]) -> str:
    """The scoreboard as JSON; nothing in it is infinite or no number."""
    return json.dumps(board, allow_nan=False, indent=1) + "\n"


def page(board: dict[str, Any], *, figure: str | None = None) -> str:
    """The page, from the scoreboard alone."""
    out = [
        "# The proof",
        "",
        f"Made from the scoreboard of the {board['of']}: {board['cases']} cases, gearpoly "
        f"{board['gearpoly']}. Nothing on this page is written by hand.",
        "",
        "A bench of its own (`proving/`) makes recordings of pairs in which something is concealed; it shares no code "
        "with the simulator. Truths are written apart, hashed before anything is scored, and opened by the scorer "
        "only. What counts as right stands in `proving/thresholds.toml`.",
        "",
        f"- truths: sha256 `{board['truths_sha256']}`",
        f"- thresholds: sha256 `{board['thresholds_sha256']}`",
        "- repeat it: `gearpoly prove"
        + (f" --ground {board['ground']}" if board["ground"] not in ("", "bench") else "")
        + (f" --seed {board['seed']}" if board["seed"] is not None else f" --on {board['of']}")
        + (" --quick`" if board["quick"] else "`"),
        "",
        "## Goals and figures",
        "",
        f"{sum(row['reached'] is True for row in board['rows'])} of "
        f"{sum(row['reached'] is not None for row in board['rows'])} goals are reached. Intervals are Wilson's, 95 %.",
        "",
        "| figure | found | goal | |",
        "| --- | --- | --- | --- |",
    ]
    for row in board["rows"]:
        note = f" ({row['note']})" if row["note"] else ""
        out.append(f"| {row['text']}{note} | {value(row)} | {row['goal']} | {MARKS[row['reached']]} |")
    out += ["", *_time(board["seconds"]), "### Cases that miss a goal", "", *_missed(board["rows"])]
    out += ["", "## Size against detection", ""]
    if figure:
        out += [f"![share of effects reported and named against size]({figure})", ""]
    out += [
        "Single effects. Size is over the theoretical limit sigma/||s_perp||, what the best method could see as one "
        "standard deviation.",
        "",
        *_profiles("size over the limit", [(_range(one["over_limit"]), one) for one in board["by_size"]]),
        "",
        "## By class",
        "",
        "How deep: rms of the effects over the rms of what hides them (the pair's transmission error, or the noise), "
        "and over the noise per sample; medians.",
        "",
        *_depths(board["by_class"]),
        "",
        *_profiles("class", board["by_class"].items()),
        "",
        "## Beside what a careful expert could know",
        "",
        *_experts(board["by_expert"]),
        "",
        "## By physics",
        "",
        *_profiles("concealed", board["by_physics"].items()),
        "",
        "## By pair",
        "",
        *_profiles("pair", board["by_pair"].items()),
        "",
        "## Controls and ablations",
        "",
        *_controls(board["controls"]),
        "",
        "## Failures",
        "",
        *_failures(board["failures"]),
    ]
    return "\n".join(out) + "\n"


def _time(spent: dict[str, Any]) -> list[str]:
    if spent.get("seconds") is None:
        return []
    return [
        f"Processor seconds per case: median {spent['seconds']:.1f}, 95th percentile {spent['seconds_95']:.1f}, "
        f"{spent['seconds_all']:.0f} for all.",
        "",
    ]


def _missed(rows: list[dict[str, Any]]) -> list[str]:
    """Every goal that a case misses, whether or not enough others reach it."""
    return [
        f"- {row['text']}: {value(row)}, goal {row['goal']}, {MARKS[row['reached']] or 'not judged'}. "
        + ", ".join(row["cases"]) for row in rows if row["goal"] and row["cases"]
    ] or ["None."]  # fmt: skip


def _depths(classes: dict[str, Any]) -> list[str]:
    out = ["| class | concealed | cases | over what hides it | over the noise |", "| --- | --- | --- | --- | --- |"]
    for name, one in classes.items():
        deep = ["" if one[key] is None else f"{one[key]:.2g}" for key in ("over_what_hides_it", "over_noise")]
        out.append(f"| {name} | {one['concealed']} | {one['cases']} | {deep[0]} | {deep[1]} |")
    return out


def _experts(classes: dict[str, Any]) -> list[str]:
    heads = ["class", "cases", *EXPERT.values(), *FAILURES.values()]
    out = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    for name, one in classes.items():
        shares = [f"{one[key]['hits']} of {one[key]['of']}" if one[key]["of"] else "" for key in EXPERT]
        cells = [name, str(one["cases"]), *shares, *(str(one[key]) for key in FAILURES)]
        out.append("| " + " | ".join(cells) + " |")
    return out


def _range(ends: list[float | None]) -> str:
    low, high = ends
    return f"from {low:g}" if high is None else f"{low:g} to {high:g}"


def _profiles(head: str, rows: Any) -> list[str]:
    out = [
        f"| {head} | cases | something reported | named, tooth included | in the reported set | further claims |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, one in rows:
        if one["cases"]:
            out.append(
                f"| {name} | {one['cases']} | {percent(one['reported'])} | {percent(one['named'])} | "
                f"{percent(one['in_set'])} | {one['extras']} |"
            )
    return out


def _controls(controls: dict[str, Any]) -> list[str]:
    names = {
        "false_alarms": "false alarms",
        "healthy_named_otherwise": "healthy, given a name that the wrong declaration does not account for",
        "reported": "concealed effects reported",
        "named": "named rightly",
        "in_set": "in the reported set",
        "false_names": "with a claim that stands for nothing",
        "look_alike_named": "a look-alike named",
    }
    out = ["| control | figure | so | the whole method, same cases |", "| --- | --- | --- | --- |"]
    for key, one in controls.items():
        if "arm" not in one:
            if one["right_tooth"]["of"]:
                out.append(
                    f"| {one['text']} | right tooth | {percent(one['right_tooth'])} | "
                    f"chance: {100 * one['expected']:.1f} % |"
                )
            continue
        first = f"{one['text']}, {one['cases']} cases"
        for name, text in names.items():
            if one["arm"][name]["of"] and (name != "healthy_named_otherwise" or key == "known_wrong"):
                out.append(f"| {first} | {text} | {percent(one['arm'][name])} | {percent(one['plain'][name])} |")
                first = ""
    return out


def _failures(failures: list[dict[str, Any]]) -> list[str]:
    out = [
        "Every case that misses a row (all but 1-sigma coverage, which a third of honest errors misses).",
        "",
        "| case | class, pair | concealed (size over limit) | said | what is wrong |",
        "| --- | --- | --- | --- | --- |",
    ]
    for one in failures:
        misses = [MEANING.get(key, key) for key in one["misses"] if key not in UNLISTED]
        if not misses:
            continue
        concealed = [
            label + ("" if size is None else f" ({size:.1f})")
            for label, size in zip(one["truth"], one["over_limit"], strict=True)
        ]
        said = one["error"] or "; ".join(one["said"]) or ("located, not named" if one["unexplained"] else "nothing")
        out.append(
            f"| {one['case']} | {one['class']}, {one['pair']} | {'; '.join(concealed) or 'nothing'} | "
            f"{said.replace('|', '/')} | {', '.join(misses)} |"
        )
    if len(out) == 4:
        return ["None."]
    return out


def draw(board: dict[str, Any], target: Path) -> None:
    """Share of single effects reported, named and in the reported set over their size, with Wilson bars."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    some = [one for one in board["by_size"] if one["cases"]]
    colours = {"reported": "#0072B2", "in_set": "#009E73", "named": "#D55E00"}
    texts = {"reported": "something reported", "in_set": "in the reported set", "named": "named, right tooth"}
    for shift, (key, colour) in zip((-0.12, 0.0, 0.12), colours.items(), strict=True):
        here = [(k, one[key]) for k, one in enumerate(some) if one[key]["of"]]
        x = [k + shift for k, _ in here]
        y = [100 * one["rate"] for _, one in here]
        low = [100 * (one["rate"] - one["interval_95"][0]) for _, one in here]
        high = [100 * (one["interval_95"][1] - one["rate"]) for _, one in here]
        axes.errorbar(x, y, yerr=[low, high], fmt="o-", color=colour, capsize=2, elinewidth=1, label=texts[key])
    axes.set_xticks(range(len(some)), [f"{_range(one['over_limit'])}\n({one['cases']})" for one in some])
    axes.set_xlabel("size over the theoretical limit (cases)")
    axes.set_ylabel("share of single effects, %")
    axes.set_ylim(-3, 103)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(target, dpi=150, metadata={"Software": None})


def main(source: Path, target: Path) -> None:
    """Write the page and its figure beside it, under ``figures/``."""
    board = json.loads(source.read_text(encoding="utf-8"))
    folder = target.parent / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    draw(board, folder / "proof_size.png")
    write_text(target, page(board, figure="figures/proof_size.png"))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
