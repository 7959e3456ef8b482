"""The gears as the recordings show them, and whether they still fit their grade or their inspection."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.limits import exceeded, figures_of, grade_kept, grade_needed, graded_by_iso, limits_of
from gearpoly.diagnose.running import Running, about_mean, running, thicknesses
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import UNCLAIMED_PROBABILITY
from gearpoly.diagnose.unseen import LACK_OF_FIT
from gearpoly.diagnose.verdict import BuiltFlank, BuiltGear
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import gear_section
from gearpoly.units import read_only

TEETH_MET = 0.75
"""Part of its teeth that have to be near the pitch point in some sample, or a fit makes up those between. Of 36 of 72
teeth that a dividing head stopped at, and of 37 readings per turn of 74, sound gears broke three limits."""

OF_ANOTHER = "cannot be judged: the lines are those of another pair or stage, and no grade is told"
"""What is told of a gear in the stead of its grade where the recordings are of other teeth."""

CONTRADICTED_TOOTH_SIGMAS = 4.0
"""Standard deviations beyond which a tooth contradicts its inspection: one of 43 does by chance in 400 sets."""


def built_gears(
    search: Fit, file: PairFile, *, left: float, unearned: Sequence[Unearned] = (), of_this_pair: bool = True
) -> tuple[BuiltGear, BuiltGear]:
    """Both gears, driving first; ``left``: the rms of unseen samples over what is expected of it; ``unearned`` what did
    not earn its name; ``of_this_pair``: whether the recordings are of this pair."""
    unsure = _why_unsure(left, unearned) if of_this_pair else OF_ANOTHER
    return _built(search, file, 0, unsure), _built(search, file, 1, unsure)


def _why_unsure(left: float, unearned: Sequence[Unearned]) -> str:
    """Why the fit says nothing of any grade, in words; "" where it does. Teeth take up what they can of whatever is not
    understood: a shaft that bows while it warms made grade 7 of a gear of grade 6, a loose key grade 11 of one of grade
    7, and another pressure angle in the drawing than in the file grade 10 and 11 of sound gears."""
    if left > LACK_OF_FIT:
        return (
            f"runs with more than is understood: {left:.2g} times what is expected is left of unseen data, and no "
            "grade is told"
        )
    if any(
        one.claim.physics.mean_tooth and (one.posterior is None or one.posterior.nothing < UNCLAIMED_PROBABILITY)
        for one in unearned
    ):
        return "runs with something at every mesh that has no sure cause and may be of all its teeth: no grade is told"
    return ""


def _built(search: Fit, file: PairFile, gear: int, unsure: str) -> BuiltGear:
    flanks = search.model.as_built.flanks
    plain = [running(search, gear, flank, claimed=False) for flank in flanks]
    whole = [running(search, gear, flank, claimed=True) for flank in flanks]
    section = gear_section(file, gear)
    mean = None
    if (found := thicknesses(search, plain, gear)) is not None:
        mean = float(np.mean(found[0])), math.sqrt(float(np.mean(found[1])))
    figures = figures_of(whole, math.cos(search.model.scope.gears[gear].alpha), thicknesses(search, whole, gear))
    ungraded = _ungraded(search, file, gear) or unsure
    broken = [] if ungraded else [one for limit in limits_of(section) if (one := exceeded(figures, limit)) is not None]
    return BuiltGear(
        flanks=tuple(_flank(one) for one in plain),
        thickness=mean,
        grade_needed=None if ungraded else grade_needed(section, figures),
        grade_kept=None if ungraded else grade_kept(section, figures),
        grade_edition=section.grade_edition,
        exceeded=tuple(broken),
        ungraded=ungraded,
        estimated=search.model.as_built.gears[gear].graded or section.inspection is not None,
    )


def _ungraded(search: Fit, file: PairFile, gear: int) -> str:
    """Why the teeth of a gear say nothing of a grade, in words; "" where they do."""
    if file.worm is not None and gear == 1:
        return "turns with the worm: what comes once per turn may be the worm's, and no grade is told"
    if others := search.model.scope.others_at(gear, 1):
        parts = " and ".join(others)
        return f"turns with other parts ({parts}): what comes once per turn may be theirs, and no grade is told"
    section = gear_section(file, gear)
    if not graded_by_iso(section):
        return f"is of a size for which ISO 1328-1 ({section.grade_edition}) has no tolerances, and no grade is told"
    z = search.model.as_built.gears[gear].z
    met = [
        np.mod(np.rint((scene.samples.theta_1, scene.samples.theta_2)[gear] * (z / (2.0 * math.pi))), z)
        for scene in search.scenes
    ]
    part = np.unique(np.concatenate(met)).size / z
    if part >= TEETH_MET:
        return ""
    return (
        f"was recorded at {100.0 * part:.0f} in 100 of its teeth: what lies between is not known, and no grade is told"
    )


def _flank(one: Running) -> BuiltFlank:
    """Where all teeth of a flank stand as one is the mean's matter, or their thickness's."""
    pitch, pitch_std = about_mean(one.pitch, one.pitch_covariance)
    return BuiltFlank(
        flank=one.flank,
        pitch=read_only(pitch),
        pitch_std=read_only(pitch_std),
        slope=read_only(one.slope),
        slope_std=read_only(np.sqrt(np.maximum(np.diag(one.slope_covariance), 0.0))),
    )


def compliance_scale(search: Fit) -> tuple[float, float] | None:
    """The compliance over the declared and its standard error, where the recordings bend declared teeth."""
    place, model = search.nuisance.scale, search.model
    if place is None or model.bending is not None:
        return None
    at = search.linear.layout.nuisance.start + place
    scale = model.ratio * model.scale
    return scale, scale * math.sqrt(max(float(search.linear.system.covariance[at, at]), 0.0))


def contradicted(search: Fit, *, stopped: bool = False) -> list[str]:
    """Teeth that stand farther off their inspection than its uncertainty allows, or off what is declared free of
    deviations, in words. Of a search that time has ``stopped`` what was not asked may stand so."""
    model, out = search.model, []
    for flank in model.as_built.flanks:
        for gear, name in ((0, "driving"), (1, "driven")):
            prior = model.as_built.gears[gear]
            if prior.graded:
                continue
            for what, values, std in (
                ("pitch", model.as_built.pitch(model.built, flank, gear), math.sqrt(prior.pitch[0, 0])),
                ("slope", model.as_built.slope(model.built, flank, gear), prior.slope),
            ):
                if what == "slope" and not prior.slope_measured:
                    continue
                far = np.flatnonzero(np.abs(values) > CONTRADICTED_TOOTH_SIGMAS * std)
                if far.size:
                    teeth = ", ".join(str(k) for k in far[:6].tolist())
                    most = f"by up to {float(np.max(np.abs(values))):.1f} um"
                    out.append(
                        f"{what} of {name} tooth {teeth} ({flank} flank) differs "
                        + (
                            f"from the inspection {most}, more than {CONTRADICTED_TOOTH_SIGMAS:.0f} times "
                            f"its uncertainty of {std:g} um: "
                            + ("what was not asked any more may do it; give it longer before you " if stopped else "")
                            + "inspect again"
                            if gear_section(model.declared, gear).inspection is not None
                            else f"{most} from the ideal gear that the pair file declares: state a grade, or inspect it"
                        )
                    )
    return out
