"""Words and numbers that the terminal and the page share."""

from __future__ import annotations

from typing import Any

UNLISTED = (
    "coverage_1", "false_alarms_60um", "false_names", "relief_found", "named_first_unknown", "named_first_shape",
    "refused", "time_out", "traceback",
)  # fmt: skip
"""Rows that a case misses by design, or along with another that says the same."""

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
    "strangers_named": "false name for what is outside the catalogue",
    "background_located": "background not located",
    "background_named": "false name beside a background",
    "false_alarms_background": "false alarm",
    "errors": "error",
    "false_name_cases": "a name that may not stand",
    "to_be_named": "not named that was to be",
    "to_be_located": "not located that was to be",
    "silent": "nothing said",
    "refused": "refused",
    "time_out": "time-out",
    "traceback": "traceback",
    "unseen_rises": "unseen data fit worse",
}
"""What a case that misses a row did, in words."""

EXPERT = {
    "false_names": "with a false name", "named": "named, tooth included", "located": "located",
    "silent": "nothing said where something could be known", "said": "wrong file: said so",
}  # fmt: skip
"""Shares of the table by class, and what they are called."""


def percent(found: dict[str, Any]) -> str:
    """A share with its counts and its interval."""
    if not found["of"]:
        return "no case"
    low, high = found["interval_95"]
    return f"{100 * found['rate']:.1f} % ({found['hits']} of {found['of']}; {100 * low:.1f} to {100 * high:.1f})"


def short_percent(found: dict[str, Any]) -> str:
    """A share with its counts; empty where there is no case."""
    return f"{100 * found['rate']:.1f} % ({found['hits']} of {found['of']})" if found["of"] else ""


def value(row: dict[str, Any]) -> str:
    """The figure of a row in words."""
    if "of" in row:
        return percent(row)
    if row["value"] is None:
        return "no case"
    return f"{row['value']:.3g} {row['unit']}".strip()


def number(value: float | None, unit: str = "") -> str:
    """Three digits; empty where there is none."""
    return "" if value is None else f"{value:.3g} {unit}".strip()


def missing_unknown(count: int) -> str:
    """What to say of truths that were written before they told of the unknown."""
    return (
        f"{count} concealed effects whose truths do not say how near an unknown comes (`truth[].unknown`) are in no "
        "row that asks for it; a ground that is written anew has it"
    )
