"""The section of a page that one run has to itself."""

from __future__ import annotations

from typing import Any

from gearpoly.prove.side import known, table
from gearpoly.prove.words import MEANING, UNLISTED, missing_unknown, percent, value
from gearpoly.proving.ground import CLASS_WORDS

PAGE_MARKS = {True: "reached", False: "**missed**", None: "not judged"}


def run_section(board: dict[str, Any], name: str, *, figure: str | None = None) -> list[str]:
    """Everything of one run that is not laid beside others: hashes, cases that miss a goal, groups, failures."""
    ground = board["ground"]
    repeat = (
        "gearpoly prove"
        + (f" --ground {ground}" if ground not in ("", "bench") else "")
        + (f" --seed {board['seed']}" if board["seed"] is not None else f" --on {board['of']}")
        + (" --quick" if board["quick"] else "")
    )
    groups = board["seconds"].get("by_group", {})
    sizes = [(_range(one["over_limit"]), one) for one in board["by_size"]]
    out = [
        f"## {name[:1].upper()}{name[1:]}",
        "",
        f"{board['cases']} cases. {sum(row['reached'] is True for row in board['rows'])} of "
        f"{sum(row['reached'] is not None for row in board['rows'])} goals are reached.",
        "",
        f"- truths: sha256 `{board['truths_sha256']}`",
        f"- thresholds: sha256 `{board['thresholds_sha256']}`",
        f"- repeat it: `{repeat}`",
    ]
    if board["without_unknown"]:
        out.append(f"- {missing_unknown(board['without_unknown'])}")
    out += ["", "### Cases that miss a goal", "", *_missed(board["rows"]), "", "### Size against detection", ""]
    if figure:
        out += [f"![share of effects reported and named against size]({figure})", ""]
    out += [
        "Single effects. Size is over the theoretical limit sigma/||s_perp||, what the best method could see as one "
        "standard deviation.",
        "",
        *_profiles("size over the limit", sizes),
        "",
        "### By class",
        "",
        "How deep: rms of the effects over the rms of what hides them (the pair's transmission error, or the noise), "
        "and over the noise per sample; medians.",
        "",
        *_depths(board["by_class"]),
        "",
        *_profiles("class", board["by_class"].items()),
        "",
        "### Beside what a careful expert could know",
        "",
        *known(
            [(CLASS_WORDS.get(klass, klass), one, groups.get(klass, {})) for klass, one in board["by_expert"].items()],
            "class",
        ),
        "",
        "### By physics",
        "",
        *_profiles("concealed", board["by_physics"].items()),
        "",
        "### By pair",
        "",
        *_profiles("pair", board["by_pair"].items()),
    ]
    controls = _controls(board["controls"])
    if controls:
        out += ["", "### Controls and ablations", "", *controls]
    return [*out, "", "### Failures", "", *_failures(board["failures"])]


def _missed(rows: list[dict[str, Any]]) -> list[str]:
    """Every goal that a case misses, whether or not enough others reach it."""
    missed = [
        [row["text"], value(row), row["goal"], PAGE_MARKS[row["reached"]], ", ".join(row["cases"])]
        for row in rows
        if row["goal"] and row["cases"]
    ]
    return table(["figure", "found", "goal", "", "cases"], missed) if missed else ["None."]


def _depths(classes: dict[str, Any]) -> list[str]:
    rows = [
        [
            CLASS_WORDS.get(name, name), one["concealed"], str(one["cases"]),
            *("" if one[key] is None else f"{one[key]:.2g}" for key in ("over_what_hides_it", "over_noise")),
        ]
        for name, one in classes.items()
    ]  # fmt: skip
    return table(["class", "concealed", "cases", "over what hides it", "over the noise"], rows)


def _range(ends: list[float | None]) -> str:
    low, high = ends
    return f"from {low:g}" if high is None else f"{low:g} to {high:g}"


def _profiles(head: str, rows: Any) -> list[str]:
    return table(
        [head, "cases", "something reported", "named, tooth included", "in the reported set", "further claims"],
        [
            [CLASS_WORDS.get(name, name), str(one["cases"]),
             *(percent(one[key]) for key in ("reported", "named", "in_set")), str(one["extras"])]
            for name, one in rows if one["cases"]
        ],
    )  # fmt: skip


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
    out = []
    for key, one in controls.items():
        if "arm" not in one:
            if one["right_tooth"]["of"]:
                chance = f"chance: {100 * one['expected']:.1f} %"
                out.append([one["text"], "right tooth", percent(one["right_tooth"]), chance])
            continue
        first = f"{one['text']}, {one['cases']} cases"
        for name, text in names.items():
            if one["arm"][name]["of"] and (name != "healthy_named_otherwise" or key == "known_wrong"):
                out.append([first, text, percent(one["arm"][name]), percent(one["plain"][name])])
                first = ""
    return table(["control", "figure", "so", "the whole method, same cases"], out) if out else []


def _failures(failures: list[dict[str, Any]]) -> list[str]:
    rows = []
    for one in failures:
        misses = [MEANING.get(key, key) for key in one["misses"] if key not in UNLISTED]
        if not misses:
            continue
        concealed = [
            label + ("" if size is None else f" ({size:.1f})")
            for label, size in zip(one["truth"], one["over_limit"], strict=True)
        ]
        said = one["error"] or "; ".join(one["said"]) or ("located, not named" if one["unexplained"] else "nothing")
        rows.append(
            [
                one["case"], f"{CLASS_WORDS.get(one['class'], one['class'])}, {one['pair']}",
                "; ".join(concealed) or "nothing",
                said.replace("|", "/"), ", ".join(misses),
            ]
        )  # fmt: skip
    if not rows:
        return ["None."]
    return [
        "Every case that misses a row (all but 1-sigma coverage, which a third of honest errors misses).",
        "",
        *table(["case", "class, pair", "concealed (size over limit)", "said", "what is wrong"], rows),
    ]
