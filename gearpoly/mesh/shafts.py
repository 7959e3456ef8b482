"""What lies between the mesh and the encoders: shafts that twist under torque, and a mesh that swings at speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Shafts:
    """``windup`` in rad of driven rotation per N.mm of driven torque; natural ``frequency`` in Hz of the torsional
    resonance (None: none) and its ``damping`` ratio."""

    windup: float = 0.0
    frequency: float | None = None
    damping: float = 0.05

    @property
    def rigid(self) -> bool:
        """Whether they change nothing."""
        return self.windup == 0.0 and self.frequency is None

    def twist(self, *, torque: float, coast: bool) -> float:
        """Transmission error in rad under ``torque`` in N.mm: the driven side lags on the drive flank."""
        return (1.0 if coast else -1.0) * self.windup * torque

    def swings(self, te: FloatArray, *, period: float) -> FloatArray:
        """What the resonance adds to ``te`` (n,), even places over a ``period`` in s: every harmonic of frequency f
        is magnified by 1/(1 - (f/f_n)^2 + 2 i D f/f_n).

        The static transmission error excites a mass between mesh stiffness and nothing (Tuplin 1953); 0 where there is
        no resonance.
        """
        if self.frequency is None:
            return np.zeros(te.size)
        spectrum = np.fft.rfft(te)
        gain = self.gain(np.arange(spectrum.size) / period)
        gain[0] = 1.0
        return np.fft.irfft(spectrum * (gain - 1.0), te.size)

    def gain(self, frequency: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
        """Response over excitation at frequencies (n,) in Hz."""
        if self.frequency is None:
            return np.ones(frequency.shape, dtype=np.complex128)
        r = frequency / self.frequency
        return np.asarray(1.0 / (1.0 - r**2 + 2j * self.damping * r), dtype=np.complex128)
