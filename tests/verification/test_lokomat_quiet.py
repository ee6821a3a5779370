"""Every control of the orthosis with people of three structures on a wall: nothing shakes, whoever presses.

A presser without tissue of its own, the presets with their reflexes, and a person of antagonist muscles with
first-order activation that the product does not know. The band of 20 to 300 Hz is that of a vibration, and the
beginning of a contact its impact: 100 ms at the rigid wall of combined control; at the spring of impedance control a
bounce of 9 Hz, and a swing of the leg on its drives of 24 Hz, that are gone after 1.2 s.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfilt

from mimics_app.lab.haptic.leg_runs import wall_rig
from mimics_app.lab.haptic.lokomat_rig import COMBINED, CONTROLS, IMPEDANCE, Person, Play, Rig
from mimics_app.rendering.haptic.devices.gait_people import PERSONS
from mimics_app.rendering.haptic.kernels.leg_kinematics import SHANK, THIGH
from tests.support.muscle_person import ACTIVATIONS, PRESSING, RELAXED, muscle_torques

MOST = 0.5
"""Greatest force between 20 and 300 Hz [N]."""

IMPACT = {IMPEDANCE: 1.2, COMBINED: 0.12}
"""Time from a touch on that is its impact [s]; the filter keeps 100 ms for 20 more."""

KINDS = pytest.mark.parametrize("kind", [IMPEDANCE, COMBINED], ids=CONTROLS)
SECONDS = pytest.mark.parametrize("seconds", [4.0, pytest.param(60.0, marks=pytest.mark.slow)])


def _heard(signal: np.ndarray, rate: int = 1000) -> np.ndarray:
    """The part of a signal between 20 and 300 Hz."""
    return np.abs(sosfilt(butter(4, (20.0, 300.0), "bandpass", fs=rate, output="sos"), signal))


def _band(kind: int, rows: dict[str, np.ndarray], rate: int = 1000) -> float:
    """Greatest force on the wall between 20 and 300 Hz [N] while the foot touches it, its impacts apart."""
    touching, impact = rows["touching"] != 0.0, round(IMPACT[kind] * rate)
    pressed = np.convolve(touching, np.ones(impact))[: len(touching)] > impact - 0.5
    return float(_heard(rows["f_x"])[pressed].max(initial=0.0))


def _felt(rig: Rig, rows: dict[str, np.ndarray], begins: int) -> float:
    """Greatest force at the foot between 20 and 300 Hz [N] that makes the torques of the rods, from a tick on."""
    thigh, shank = rig.settings["frame"]["geometry"][0, [THIGH, SHANK]]
    return max(_heard(rows["hip"])[begins:].max() / (thigh + shank), _heard(rows["knee"])[begins:].max() / shank)


@KINDS
@SECONDS
@pytest.mark.parametrize("force", [60.0, 20.0])
@pytest.mark.parametrize("person", PERSONS)
def test_no_preset_makes_the_wall_shake(person: str, force: float, kind: int, seconds: float) -> None:
    """A light press bounces for two seconds first: legs that bear themselves are thrown back by a spring."""
    rig, _ = wall_rig({"person": person})
    rows = rig.run(kind, Person(force=(force, 0.0), preset=True), seconds)
    assert rows["touching"][2500:].all() and _band(kind, rows) <= MOST


@KINDS
@SECONDS
@pytest.mark.parametrize("force", [60.0, 20.0])
def test_nor_does_a_presser_without_tissue(force: float, kind: int, seconds: float) -> None:
    rig, _ = wall_rig()
    rows = rig.run(kind, Person(force=(force, 0.0)), seconds)
    assert rows["touching"][2500:].all() and _band(kind, rows) <= MOST


@pytest.mark.parametrize(("encoder", "quiet"), [(1e-6, True), (2e-5, False)])
def test_a_creeping_leg_feels_the_steps_of_the_encoder(encoder: float, quiet: bool) -> None:
    """Behind a wall a leg creeps to rest for some seconds: with finer steps its rods are quiet at once, too."""
    rig, _ = wall_rig({"person": "healthy", "encoder": encoder})
    rows = rig.run(COMBINED, Person(force=(60.0, 0.0), preset=True), 4.0)
    assert bool(_felt(rig, rows, 400) <= MOST) is quiet


@KINDS
@pytest.mark.parametrize("seconds", [5.0, pytest.param(60.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize("person", PERSONS)
def test_a_passive_preset_feels_no_drive(person: str, kind: int, seconds: float) -> None:
    """A leg that hangs, on whose rods nothing bears: its tissue draws it for 4 s, then it is at rest."""
    rig, _ = wall_rig({"person": person})
    rows = rig.run(kind, Person(preset=True), seconds)
    assert _felt(rig, rows, 4000) <= MOST


@pytest.mark.parametrize(("person", "missing"), [("healthy", "friction"), ("spastic", "encoder")])
def test_without_dry_friction_or_the_steps_of_the_encoder_it_rattles(person: str, missing: str) -> None:
    """The planted faults: a virtual leg that never comes to rest, and a damping that takes steps for speed."""
    rig, _ = wall_rig({"person": person})
    (rig.settings["shafts"] if missing == "friction" else rig.settings)[missing] = 0.0
    assert _felt(rig, rig.run(COMBINED, Person(preset=True), 6.0), 4000) > 2.0 * MOST


@KINDS
@SECONDS
def test_a_passive_leg_is_left_alone(kind: int, seconds: float) -> None:
    """A leg that bears itself and does nothing else is not shaken; the combined control lets it drift slowly."""
    rig, _ = wall_rig()
    rows = rig.run(kind, Person(), seconds)
    still = rows["t"] > 1.0
    assert np.abs(rows["knee_rate"][still]).max() < 0.05 and _band(kind, rows) <= MOST


def _pressed(play: Play, nerve: np.ndarray, seconds: float) -> dict[str, np.ndarray]:
    """Columns of a run in which muscles move the leg, tick by tick."""
    activation, parts, q, dq = np.zeros(ACTIVATIONS), [], np.array([0.25, 0.45]), np.zeros(2)
    for _ in range(round(seconds * play.rig.rate)):
        muscle_torques(activation, nerve, q, dq, 1.0 / play.rig.rate, play.added)
        parts.append(play.go(1.0 / play.rig.rate))
        q[:] = parts[-1]["hip_angle"][0], parts[-1]["knee_angle"][0]
        dq[:] = parts[-1]["hip_rate"][0], parts[-1]["knee_rate"][0]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@KINDS
@SECONDS
@pytest.mark.parametrize("nerve", [RELAXED, PRESSING], ids=["relaxed", "pressing"])
def test_muscles_with_activation_do_not_make_it_shake(kind: int, seconds: float, nerve: np.ndarray) -> None:
    rig, _ = wall_rig()
    rows = _pressed(rig.begin(kind, Person(bears=float(nerve is RELAXED))), nerve, seconds)
    assert np.isfinite(rows["f_x"]).all() and _band(kind, rows) <= MOST


def test_a_wall_beyond_its_boundary_is_lost_or_heard() -> None:
    """The planted fault: without dry friction 15 kN/m are beyond the boundary of S18."""
    rig, _ = wall_rig({"static_friction": 0.0, "coulomb_friction": 0.0})
    rig.settings["foot"]["stiffness"] = 15_000.0
    rows = rig.run(IMPEDANCE, Person(force=(60.0, 0.0)), 4.0)
    assert not rows["touching"][-1000:].all() or _band(IMPEDANCE, rows) > MOST
