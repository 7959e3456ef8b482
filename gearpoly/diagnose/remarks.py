"""What is said of a diagnosis beside its findings: what teeth and keys of the pair file to check, and what to doubt."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gearpoly.compare.beside import Comparison
from gearpoly.diagnose.built import contradicted
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.nuisance import SCALE_STD
from gearpoly.diagnose.search import MOST_CLAIMS, doubted
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.verdict import BuiltGear, Finding
from gearpoly.files.models import PairFile
from gearpoly.infer.posterior import WORTH_A_WORD_PROBABILITY
from gearpoly.infer.prior import SHAPED_BY_KEYS

DOUBTED_COMPLIANCE_SIGMAS = 3.0
"""Standard deviations of what is known of a declared compliance, by which teeth have to be softer or harder for a key
to be doubted. Of recordings at 0.4 times the stated torque they were 3.2 off; under a tilt that nobody stated, 11."""


def of_search(
    search: Fit,
    file: PairFile,
    built: tuple[BuiltGear, BuiltGear],
    comparison: Comparison,
    *,
    sure: bool,
    stopped: bool,
) -> Iterator[str]:
    """What teeth break: their inspection, where the fit is ``sure`` of them, their limits, their grade; and whether the
    pair is another. ``stopped``: time was over before all was asked."""
    if comparison.another is None:
        yield from (contradicted(search, stopped=stopped) if sure else ())
        yield from _of_another_pair(search)
    for name, section, gear in (("driving", file.driving, 0), ("driven", file.driven, 1)):
        needed = built[gear].grade_needed
        known = comparison.gears[gear]
        for one in built[gear].exceeded:
            at = " and ".join(f"{known.encoder_deg(tooth):.1f}" for tooth in one.teeth if known.zero is not None)
            yield one.says(name) + (f", at {at} deg of its encoder" if at else "")
        if any(one.limit.grade is not None for one in built[gear].exceeded):
            shown = "fits no grade" if needed is None else f"needs grade {needed} or a coarser one"
            yield f"by pitch and slope the {name} gear as it runs {shown}, not its declared grade {section.grade}"


def beyond_laws(scale: tuple[float, float] | None) -> bool:
    """Whether teeth give far more or less than declared: no law of compliance is so far off."""
    return scale is not None and abs(scale[0] - 1.0) > DOUBTED_COMPLIANCE_SIGMAS * SCALE_STD


def of_compliance(scale: tuple[float, float] | None) -> Iterator[str]:
    """A word where teeth give far more or less than declared."""
    if scale is not None and beyond_laws(scale):
        softer = "; shafts that give, and flanks that carry on a part of their width, look alike"
        yield (
            f"teeth give {scale[0]:.2f} times as much as declared, and laws of compliance are not so far off: check "
            "torque_nm (is it that of the driving shaft?), face_width_mm, youngs_modulus_gpa and profile_shift"
            + (softer if scale[0] > 1.0 else "")
        )


def of_the_file(unearned: Sequence[Unearned]) -> Iterator[str]:
    """Which keys of the pair file may be wrong, where something looks as though they were."""
    for one in unearned:
        likely = one.posterior is not None and one.posterior.of(one.claim) > WORTH_A_WORD_PROBABILITY
        if one.claim.physics.name in SHAPED_BY_KEYS and likely:
            name, size = one.claim.physics.name.replace("_", " "), one.claim.values[0]
            yield (
                f"a {name} off by {size:.0f} um would explain it, and so would a wrong profile_shift, "
                "pressure_angle_deg, addendum or centre_distance_mm in the pair file: check these"
            )


def of_untouched(findings: Sequence[Finding]) -> Iterator[str]:
    """A word about claims whose teeth are out of the mesh where they deviate."""
    for one in findings:
        if one.at_least:
            name = one.claim.physics.name.replace("_", " ")
            yield f"where the {name} is, teeth do not touch under these conditions: its size is the least it can have"


def _of_another_pair(search: Fit) -> Iterator[str]:
    """A word of doubt about the whole where most of what the recordings repeat stays, or claims do not end."""
    claims, left = len(search.model.claims), search.linear.system.whiteness
    if claims >= MOST_CLAIMS or doubted(search) or search.disowned:
        named = f"{claims} physics are named" if claims else "nothing is named"
        if search.disowned:
            named += f", since {search.disowned} more would explain but a part of what is missing"
        more = f", and {math.sqrt(left - 1.0):.1f} times the noise is left" if doubted(search) else ""
        yield (
            f"{named}{more}: perhaps something beside the gears is recorded, or the pair file is of another pair, or "
            "of another state of this one"
        )
