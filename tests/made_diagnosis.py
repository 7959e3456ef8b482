"""A diagnosis made by hand about a real comparison, for tests of what shows it."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.diagnose.heldout import Rms
from gearpoly.diagnose.imagine import NextRecording
from gearpoly.diagnose.separate import Separation
from gearpoly.diagnose.verdict import BuiltFlank, BuiltGear, Diagnosis, Finding, Rival
from gearpoly.files.models import PairFile
from gearpoly.mesh.pair import Flank
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import NM, UM, FloatArray, read_only
from tests.made_recordings import Rig, inspected, record

NAME = '</script><b>bench & "pair"</b> {{DATA}}'
FILE = "<img src=x>_&.csv"
REMARK = "a remark with <i>marks</i> & signs"
E_UM = 6.0


@cache
def made_comparison() -> tuple[PairFile, Comparison]:
    """Two recordings, of both flanks, of a pair whose driving gear runs ``E_UM`` off its axis, which its file does not
    say. Their names hold what HTML would take for its own."""
    with tempfile.TemporaryDirectory(prefix="gearpoly-") as folder:
        return _made_comparison(Path(folder))


def _made_comparison(folder: Path) -> tuple[PairFile, Comparison]:
    rng = np.random.default_rng(5)
    hidden = f"[driving.eccentricity]\namplitude_um = {E_UM}\nangle_deg = 40.0"
    file, path, truth = inspected(folder, rng, z_1=11, z_2=13, hidden=hidden, points=120)
    rig = Rig(zero_1=1.0, zero_2=2.0, noise=0.3)
    made = [record(truth, rig, rng, cycles=2.0, flank=f, stated=(1.0, 2.0))
            for f in ("drive", "coast")]  # fmt: skip
    named = [type(one)(**{**one.__dict__, "source": Path(f"{k}_{FILE}")}) for k, one in enumerate(made)]
    file = file.model_copy(update={"name": NAME})
    return file, compare(file, named, path=path)


def left_of(comparison: Comparison) -> tuple[FloatArray, ...]:
    """What a wave of the driving shaft and a mean leave of every recording, (n_k,) in mm."""
    out = []
    for one in comparison.aligned:
        columns = np.column_stack([np.ones(one.theta_1.size), np.cos(one.theta_1), np.sin(one.theta_1)])
        out.append(read_only(one.residual - columns @ np.linalg.lstsq(columns, one.residual, rcond=None)[0]))
    return tuple(out)


def findings() -> tuple[Finding, ...]:
    """Three: with a rival and what would decide; a tooth and its rival, without numbers; in the measuring chain."""
    known = catalogue()
    off = Claim(physics=known["eccentricity"], place=Place(gear=0), values=(4.6, 3.86))
    rival = Claim(physics=known["encoder_eccentricity"], place=Place(gear=0), values=(100.0, 80.0))
    tooth = Claim(physics=known["tooth_pitch"], place=Place(gear=1, tooth=7, flank="drive"), values=(3.5,))
    mate = Claim(physics=known["tooth_pitch"], place=Place(gear=0, tooth=4, flank="coast"), values=(-3.4,))
    chain = Claim(physics=known["encoder_eccentricity"], place=Place(gear=1), values=(10.0, 8.0))
    without, with_ = Rms(seen=4.31 * UM, unseen=4.56 * UM), Rms(seen=0.300 * UM, unseen=0.321 * UM)
    decides = Separation(
        recording=NextRecording(flank="coast", torque=1.0 * NM), separability=0.68, now=0.031, told=9.0
    )
    return (
        Finding(
            claim=off, parameters={"amplitude_um": (6.0048, 0.0312), "angle_deg": (40.02, 0.31)}, tooth=None,
            encoder_deg=None, gain=12345.6, probability=0.93, unknown_probability=0.004, without=without, with_=with_,
            rivals=(Rival(claim=rival, parameters={"amplitude_urad": (128.06, 0.0)}, probability=0.066),),
            separation=decides,
        ),
        Finding(
            claim=tooth, parameters={"deviation_um": (3.5, 0.21)}, tooth=None, encoder_deg=203.14, gain=271.8,
            probability=0.71, unknown_probability=0.03, without=Rms(seen=0.7 * UM, unseen=0.71 * UM), with_=with_,
            separation=None,
            rivals=(Rival(claim=mate, parameters={"deviation_um": (-3.4, 0.0)}, probability=0.26, encoder_deg=17.2),),
        ),
        Finding(
            claim=chain, parameters={"amplitude_urad": (12.8, 1.4)}, tooth=None, encoder_deg=None, gain=31.0,
            probability=0.98, unknown_probability=0.02, without=Rms(seen=0.4 * UM, unseen=0.41 * UM), with_=with_,
            rivals=(), separation=None,
        ),
    )  # fmt: skip


def built(z: int, grade: int | None) -> BuiltGear:
    """A gear of ``z`` teeth with other values for every tooth."""
    rng = np.random.default_rng(z)
    flanks: tuple[Flank, ...] = ("drive", "coast")
    return BuiltGear(
        flanks=tuple(
            BuiltFlank(
                flank=flank,
                pitch=read_only(rng.normal(0.0, 3.0, z)), pitch_std=read_only(rng.uniform(0.1, 0.3, z)),
                slope=read_only(rng.normal(0.0, 2.0, z)), slope_std=read_only(rng.uniform(0.2, 0.5, z)),
            )
            for flank in flanks
        ),
        thickness=(-58.6, 0.4), grade_needed=grade, grade_edition=2013, grade_kept=grade,
    )  # fmt: skip


def made_diagnosis(file: PairFile, comparison: Comparison, *, left: tuple[FloatArray, ...] | None = None) -> Diagnosis:
    """A diagnosis with something in every field."""
    found = findings()
    ghost = Entry(kind="shaft_order", p_value=1e-7, recordings=(0, 1), gear="driving", order=3.58, amplitude_um=0.81,
                  std_um=0.023, rivals=("a <ghost> order",))  # fmt: skip
    return Diagnosis(
        comparison=comparison,
        status="partly_explained",
        findings=found,
        unexplained=(ghost,),
        built=(built(comparison.gears[0].z, 6), built(comparison.gears[1].z, None)),
        compliance_scale=(1.08, 0.021),
        noise=0.31 * UM,
        noise_by_recording=tuple(0.31 * UM for _ in comparison.aligned),
        before=Rms(seen=4.7 * UM, unseen=4.7 * UM),
        as_built_only=Rms(seen=4.31 * UM, unseen=4.56 * UM),
        after=found[0].with_,
        held_out_by="whole hunting cycles",
        left=left_of(comparison) if left is None else left,
        fitted=file,
        not_excluded=("resonances: all recordings were made at <one> speed",),
        remarks=(REMARK,),
        seconds=(("compare", 6.1), ("search", 31.4)),
    )
