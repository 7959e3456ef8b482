"""The keys of an inspection: what was measured of a gear, as deviations or as an inspection sheet has it."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Discriminator, Field, Strict, Tag, model_validator

from gearpoly.keys.kinds import (
    LIST_TAG,
    NUMBER_TAG,
    ONE_FAULT,
    PerTooth,
    Section,
    Um,
    UmSize,
    broken,
    field,
    number_or_list,
)

MOST_HALF_WAVES = 12
"""Half waves of form at most: finer ones are for whole traces."""

Size = Annotated[float, Field(gt=0.0, le=1e5)]

Sizes = Annotated[
    Annotated[Size, Tag(NUMBER_TAG)]
    | Annotated[Annotated[tuple[Size, ...], Strict(False), ONE_FAULT, Field(min_length=1)], Tag(LIST_TAG)],
    Discriminator(number_or_list),
]
"""A length that was measured once, or at several places round the gear."""

Forms = Annotated[
    tuple[Annotated[tuple[Um, ...], Strict(False), ONE_FAULT, Field(min_length=1, max_length=MOST_HALF_WAVES)], ...],
    Strict(False),
    ONE_FAULT,
]
"""The form of every tooth: amplitudes in um of 2, 3, 4 and more half waves."""

FOR_THE_GEAR = ("span_mm", "over_pins_mm")
"""Keys whose list is no list of teeth."""

WAYS = (
    ("single_pitch_um", "pitch_um"),
    ("single_pitch_coast_um", "pitch_coast_um"),
    ("span_mm", "tooth_thickness_um"),
    ("over_pins_mm", "tooth_thickness_um"),
    ("over_pins_mm", "span_mm"),
)
"""Two ways each to state the same."""


class Inspection(Section):
    """Measured deviations in um; each a number for all teeth or a list with one per tooth."""

    uncertainty_um: UmSize = field("standard uncertainty of the inspection in um, 0 or more", 0.5)
    sheet_csv: str | None = field(
        "table of measured deviations in quotes, relative to the pair file: columns gear, tooth and keys of this "
        "section that have one value per tooth; empty columns were not measured",
        min_length=1,
    )
    pitch_um: PerTooth | None = field(
        "index deviation of the drive flanks in um, positive = more material; not f_p, which single_pitch_um takes"
    )
    pitch_coast_um: PerTooth | None = field(
        "index deviation of the coast flanks in um; default: from pitch and thickness"
    )
    single_pitch_um: PerTooth | None = field(
        "single pitch deviations f_p of the drive flanks in um as on the sheet, instead of pitch_um: arc, tooth n "
        "against n - 1 in the order of meshing, positive = pitch too large"
    )
    single_pitch_coast_um: PerTooth | None = field(
        "single pitch deviations f_p of the coast flanks in um, instead of pitch_coast_um"
    )
    profile_slope_um: PerTooth | None = field(
        "rise of material from active root to tip in um, of both flanks unless per flank"
    )
    profile_slope_coast_um: PerTooth | None = field(
        "profile slope of the coast flanks in um; default: the drive flanks'"
    )
    profile_crowning_um: PerTooth | None = field("material missing at both ends in um, of both flanks unless per flank")
    profile_crowning_coast_um: PerTooth | None = field(
        "profile crowning of the coast flanks in um; default: the drive flanks'"
    )
    profile_form_um: Forms | None = field(
        "form of the drive flanks in um, a list per tooth: amplitudes of cos(k pi u), k from 2 on, u from 0 at the "
        "active root to 1 at the tip"
    )
    profile_form_coast_um: Forms | None = field("the same of the coast flanks; default: the drive flanks'")
    tooth_thickness_um: PerTooth | None = field(
        "tooth thickness deviation E_s in um along the reference circle; negative thins"
    )
    span_mm: Sizes | None = field(
        "measured base tangent length W_k in mm, one or a list whose mean counts, instead of tooth_thickness_um"
    )
    span_teeth: int | None = field("number k of teeth that it spans, 2 or more", ge=2, le=10_000)
    over_pins_mm: Sizes | None = field(
        "measured size over two pins or balls in mm, one or a list whose mean counts, instead of tooth_thickness_um"
    )
    pin_diameter_mm: float | None = field("diameter of these pins in mm, above 0", gt=0.0, le=1e4)
    profile_csv: str | None = field("file of measured traces in quotes, relative to the pair file", min_length=1)
    gde: str | None = field("inspection file (XML), relative to the pair file; keys beside it go first", min_length=1)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.gde is not None:
            # What a diagnosis adds to a measured pitch or thickness stands beside the file that says the rest.
            beside = {"gde", "uncertainty_um", "pitch_um", "pitch_coast_um", "tooth_thickness_um"}
            for key in sorted(self.model_fields_set - beside):
                if getattr(self, key) is not None:
                    broken(
                        "gde",
                        f'"{self.gde}", and {key} too',
                        "want one of the two, since each states what was measured",
                    )
        for key in ("profile_form_um", "profile_form_coast_um"):
            rows = getattr(self, key)
            if rows is not None and len(waves := {len(row) for row in rows}) > 1:
                found = f"lists of {min(waves)} to {max(waves)} amplitudes"
                broken(key, found, "want as many of each tooth; 0 where a half wave is missing")
        for key, other in WAYS:
            if getattr(self, key) is not None and getattr(self, other) is not None:
                broken(key, f"stated, and {other} too", "want one of the two, since each states the same")
        for key, needs in (("span_mm", "span_teeth"), ("over_pins_mm", "pin_diameter_mm")):
            for one, mate in ((key, needs), (needs, key)):
                if getattr(self, one) is not None and getattr(self, mate) is None:
                    broken(one, f"stated without {mate}", f"want {mate} beside it")
        return self
