"""What of the method is in use: parts are left out only to show what they are worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearpoly.assemble import Assembled, assemble
from gearpoly.compare.noise import Noise
from gearpoly.diagnose.fidelity import FAINT_EFFECT_MM
from gearpoly.files.models import GearSection, PairFile
from gearpoly.keys.edit import changed, on_gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Physics
from gearpoly.physics.samples import Samples
from gearpoly.scene import Scene, stage
from gearpoly.threads import each
from gearpoly.units import UM

ECCENTRICITY_DIVISOR = 64.0
"""Part of a declared eccentricity from which its first-order effect is drawn: 60 um become 1 um, whose second order is
4000 times smaller, and whose first is still 10^6 times what contacts are known to."""


CHORDS, MOST_CHORD = 0.05, 0.01 * UM
"""By what a chord may stand off its flank where a diagnosis draws it: this part of the noise's innovations, and so many
mm at most. Its ripple in the transmission error is 0.42 of that (four pairs of module 2, rms), which is 0.02 of the
noise: 2 in misfit of 5000 samples. Points become 2.4 times fewer, and a diagnosis takes a sixth less time."""


@dataclass(frozen=True, kw_only=True)
class Method:
    """Options of a diagnosis: physics struck from the catalogue (``without``), whether the noise is whitened, whether
    eccentricity goes through the exact kernel or only by its first order. Chords may stand ``chord_error`` mm off the
    flanks that are simulated."""

    without: frozenset[str] = frozenset()
    whiten: bool = True
    exact: bool = True
    chord_error: float = 0.0

    def for_noise(self, noises: Sequence[Noise]) -> Method:
        """The same with chords as coarse as the noise of the recordings allows."""
        return replace(self, chord_error=min(MOST_CHORD, CHORDS * min(noise.innovation for noise in noises)))

    @property
    def physics(self) -> list[Physics]:
        """What may be named."""
        return [one for name, one in catalogue().items() if name not in self.without and not one.unsearched]

    def noise(self, noise: Noise) -> Noise:
        """The noise as the fit is to see it: what is less than the simulation is known to does not count as told by the
        recording. Of a simulated recording, written without noise, 4 nm were left and an order of 17 um was made."""
        if not self.whiten:
            noise = replace(noise, ar=np.empty(0), innovation=noise.level)
        if noise.innovation >= FAINT_EFFECT_MM:
            return noise
        if noise.innovation <= 0.0:
            return replace(noise, level=FAINT_EFFECT_MM, ar=np.empty(0), innovation=FAINT_EFFECT_MM)
        more = FAINT_EFFECT_MM / noise.innovation
        return replace(noise, level=more * noise.level, innovation=FAINT_EFFECT_MM, density=more**2 * noise.density)

    def assembled(self, file: PairFile, *, path: Path) -> Assembled:
        """The pair of ``file`` (read from ``path``), as fine as the noise asks. Raises what ``assemble`` does."""
        return assemble(file, path=path, seed=0, chord_error=self.chord_error)

    def scenes(self, file: PairFile, samples: Sequence[Samples], *, path: Path, smoothing: float = 0.0) -> list[Scene]:
        """All recordings of a pair file simulated, ``smoothing`` as in ``stage``."""
        eccentric = file.driving.eccentricity is not None or file.driven.eccentricity is not None
        if self.exact or not eccentric:
            assembled = self.assembled(file, path=path)
            if assembled.shafts.frequency is not None:
                # Recordings under the same load share the curve that swings.
                conditions = dict.fromkeys(replace(one.condition, speed=None, varies=0.0) for one in samples)
                each(lambda condition: assembled.under(condition).cycle_te, list(conditions))
            return each(lambda one: stage(assembled, one, smoothing=smoothing), samples)
        none, few = (self.assembled(_eccentric(file, part), path=path) for part in (0.0, 1.0 / ECCENTRICITY_DIVISOR))
        out = []
        for one in samples:
            plain = stage(none, one, smoothing=smoothing)
            some = stage(few, one, smoothing=smoothing)
            te, mesh_te = (
                here + ECCENTRICITY_DIVISOR * (there - here)
                for here, there in ((plain.te, some.te), (plain.mesh_te, some.mesh_te))
            )
            out.append(replace(plain, te=te, mesh_te=mesh_te))
        return out


def _eccentric(file: PairFile, part: float) -> PairFile:
    """The pair file with a part of every eccentricity."""
    sections: list[GearSection] = [file.driving, file.driven]
    for gear, section in enumerate(sections):
        if section.eccentricity is not None:
            amplitude = part * section.eccentricity.amplitude_um
            file = on_gear(file, gear, eccentricity=changed(section.eccentricity, amplitude_um=amplitude))
    return file
