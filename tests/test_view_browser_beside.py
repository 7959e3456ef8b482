"""The contact debugger beside a recording, in a real browser: the mismatch at the cursor, and what compare locates."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from gearpoly.assemble import assemble
from gearpoly.cli import app
from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import lay_beside
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import Located
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import contacts
from gearpoly.recording.read import read_recording
from gearpoly.units import DEG, UM
from gearpoly.view.document import document
from gearpoly.view.html import page_text
from gearpoly.view.scene import scene_beside
from tests.chromium import Chromium

OUT = Path(__file__).parents[1] / "out" / "view"


def quiet(done: int) -> None:
    """No progress."""


@dataclass(frozen=True, kw_only=True)
class Made:
    """A pair whose inspection misses that one driven tooth stands proud, and a recording of the true one."""

    declared: Path
    recording: Path
    truth: GearPair


PROUD, BY_UM = 4, 5.0


def make(folder: Path) -> Made:
    rng = np.random.default_rng(3)
    pitch = [[round(float(d), 2) for d in rng.normal(0.0, 1.5, z)] for z in (11, 13)]

    def written(name: str, further: float) -> Path:
        driven = list(pitch[1])
        driven[PROUD] += further
        path = folder / name
        path.write_text(
            'name = "beside"\n'
            + "\n".join(
                f"[{gear}]\nteeth = {len(d)}\nmodule_mm = 2.0\npoints_per_flank = 120\n[{gear}.inspection]\n"
                f"uncertainty_um = 0.3\npitch_um = {d}\ntooth_thickness_um = -50.0\n"
                for gear, d in (("driving", pitch[0]), ("driven", driven))
            ),
            encoding="utf-8",
        )
        return path

    path = written("truth.toml", BY_UM)
    pair = assemble(read_pair(path), path=path, seed=0).pair
    n = 3 * pair.meshes_per_cycle * 16
    theta_2 = (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n * 3.0 * pair.cycle
    te = contacts(pair, theta_2, fast=True).te + rng.normal(0.0, 0.2 * UM, n) / pair.r_b2
    table = np.column_stack(((theta_2 - te) / pair.ratio, theta_2)) / DEG
    rows = "\n".join(f"{a:.9f},{b:.9f}" for a, b in table.tolist())
    recording = folder / "rig.csv"
    head = "# torque_nm = 0.0\n# driving_zero_deg = 0.0\n# driven_zero_deg = 0.0\n"
    recording.write_text(f"{head}driving_angle_deg,driven_angle_deg\n{rows}\n", encoding="utf-8")
    return Made(declared=written("pair.toml", 0.0), recording=recording, truth=pair)


ENTRIES = (
    Entry(kind="tooth", p_value=1e-9, recordings=(0,), gear="driven", tooth=PROUD, phase=(-0.4, 0.4), encoder_deg=111.0,
          amplitude_um=BY_UM, std_um=0.1, rms_um=3.0),
    Entry(kind="tooth", p_value=1e-6, recordings=(0,), gear="driving", tooth=None, encoder_deg=9 * 360.0 / 11,
          amplitude_um=0.5, std_um=0.1, rms_um=0.3),
    Entry(kind="shaft_order", p_value=1e-6, recordings=(0,), gear="driving", order=1.0, amplitude_um=0.4, std_um=0.1),
)  # fmt: skip
"""Stands for what ``compare`` locates, of which the page shows every kind: a numbered tooth, one without a number, and
what has no place."""


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Comparison, Made]:
    made = make(tmp_path_factory.mktemp("beside"))
    laid = lay_beside(read_pair(made.declared), [read_recording(made.recording)], path=made.declared)
    none = np.empty(0)
    located = Located(
        entries=ENTRIES, where=ENTRIES, divisions=(), noises=(), noise_level=0.2 * UM, maps=(), as_built=none,
        as_built_std=none, left=(), residual_rms=laid.aligned[0].rms, repeatable_rms=None, slow_terms=(4,),
    )  # fmt: skip
    comparison = Comparison(**{field.name: getattr(laid, field.name) for field in fields(laid)}, located=located)
    page = made.declared.with_suffix(".html")
    scene = scene_beside(comparison, path=made.declared, progress=quiet)
    page.write_text(page_text(document(scene)), encoding="utf-8")
    return page, comparison, made


@pytest.mark.long
def test_the_mismatch_stands_beside_the_geometry(fresh: Chromium, beside: tuple[Path, Comparison, Made]) -> None:
    """Recorded minus simulated at the cursor is the mean of ``lay_beside``'s residual there, over the stretch that the
    page names; from place to place it is what the kernel makes of the true and of the declared pair."""
    page, comparison, made = beside
    one = comparison.aligned[0]
    pair = comparison.assembled.pair
    fresh.open(page)
    half = 0.5 * fresh.run("gearpoly.recording.window") * pair.driven.gear.tau
    half_step = 0.5e-3  # um
    places = np.mod(one.theta_2, pair.cycle)
    proud = PROUD * pair.driven.gear.tau / DEG
    angles = [3.0, proud, proud + 180.0, 1900.0]
    found = []
    for deg in angles:
        miss = fresh.run(f"gearpoly.turn({deg}).miss")
        here = np.abs(np.mod(places - deg * DEG + 0.5 * pair.cycle, pair.cycle) - 0.5 * pair.cycle) <= half
        assert miss == pytest.approx(float(np.mean(one.residual[here])) / UM, abs=half_step)
        words = fresh.run("document.getElementById('miss').textContent")
        assert words == f"{miss:.3f} \u00b5m".replace("-", "\u2212")
        found.append(miss)
    theta_2 = np.array(angles) * DEG
    wish = (contacts(made.truth, theta_2).te - contacts(pair, theta_2).te) * pair.r_b2 / UM
    assert wish[1] - wish[0] == pytest.approx(BY_UM, abs=0.2)  # the tooth alone is in touch there
    # Noise of 0.2 um in the mean of three samples or more, twice; the recording's mean is no part of it.
    assert np.array(found[1:]) - found[0] == pytest.approx(wish[1:] - wish[0], abs=0.6)
    fresh.screenshot(OUT / "recording.png")


@pytest.mark.long
def test_a_located_tooth_is_one_click_away(fresh: Chromium, beside: tuple[Path, Comparison, Made]) -> None:
    page, _, _ = beside
    fresh.open(page)
    assert fresh.run("document.querySelectorAll('#where li').length") == 3
    assert fresh.run("document.querySelectorAll('#where button').length") == 2
    for at, gear, tooth in ((1, "driven", PROUD), (2, "driving", 9)):
        fresh.run("gearpoly.turn(0); 0")
        fresh.press(f"#where li:nth-child({at}) button")
        which = 0 if gear == "driving" else 1
        assert fresh.run("gearpoly.view.selected") == {"gear": which, "tooth": tooth}
        assert tooth in fresh.run(f"gearpoly.state.contacts.map(one => one.{gear})")
        if at == 1:
            # It goes to the mesh in which the tooth shows most.
            assert abs(fresh.run("gearpoly.state.miss")) > 0.6 * BY_UM
            fresh.screenshot(OUT / "located.png")


@pytest.mark.slow
def test_the_command_shows_what_compare_locates(fresh: Chromium, tmp_path: Path) -> None:
    """The whole way: a recording on disk, the command, the page, and the proud tooth among the places it names."""
    made = make(tmp_path)
    page = tmp_path / "page.html"
    result = CliRunner().invoke(
        app, ["view", str(made.declared), "--recording", str(made.recording), "--html", str(page)]
    )
    assert result.exit_code == 0, result.output
    fresh.open(page)
    places = fresh.run("gearpoly.recording.where")
    assert any(place["gear"] == "driven" and place["tooth"] == PROUD for place in places)
