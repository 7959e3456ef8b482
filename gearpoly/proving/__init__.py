"""A virtual bench of its own: it makes recordings in which one physics is concealed, and keeps the truth apart.

Nothing here imports the simulator that has to explain the recordings, and the simulator imports nothing from here.
Inside: mm, rad, N, N.mm, s. Parameters of an effect and everything in files: um, deg, N.m, as the project's contract
has it."""

from __future__ import annotations
