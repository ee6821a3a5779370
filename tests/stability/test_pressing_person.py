"""A person presses on any surface: the force is quiet, or what was wrong is capped, calmed or stopped, and told."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.contracts.loop.haptic import EventKind, SafetyState, TripCause
from tests.support.haptic_bench import Bench
from tests.support.press_play import QUIET, RATE, press, shaking

DEVICES = ("simulated_impedance", "simulated_hapticmaster")
FORCE_LIMIT = {"simulated_impedance": 25.0, "simulated_hapticmaster": 60.0}
"""Within what the motors of the simulated robots give [N]."""

CALMED_S = 1.0
"""Time after an oscillation began to be calmed in which it has ended [s]."""

KNOCK_S = 0.1
"""Time above QUIET that one knock, or a force that leaves its limit, may last in all [s]."""

FEW, MANY = 16, 1000


def _pressed(device: str, stiffness: float, damping: float, **values: float) -> tuple[np.ndarray, Bench]:
    return press(device, stiffness, damping, force_limit=FORCE_LIMIT[device], **values)


def _told(bench: Bench) -> dict[EventKind, list[int]]:
    """Ticks of the events that tell of a contact that was not rendered as it was authored."""
    events = bench.engine.events()
    kinds = (EventKind.CAP, EventKind.OSCILLATION, EventKind.TRIP)
    return {kind: [int(event["tick"]) for event in events if event["kind"] == kind] for kind in kinds}


def _random_surface(seed: int) -> tuple[str, float, float]:
    """Device, stiffness [N/m] and damping [N s/m] of what scenes may ask: from foam to steel, dry to tar."""
    rng = np.random.default_rng([32, seed])
    return DEVICES[seed % 2], float(10 ** rng.uniform(2.0, 4.7)), float(10 ** rng.uniform(0.3, 2.6))


def _assert_quiet_or_told(device: str, stiffness: float, damping: float) -> None:
    rows, bench = _pressed(device, stiffness, damping)
    told, loud = _told(bench), np.flatnonzero(shaking(rows) > QUIET)
    if rows["state"][-1] == SafetyState.SAFE_STOP:
        assert told[EventKind.TRIP]
    if len(loud) <= KNOCK_S * RATE:
        return
    assert any(told.values()), f"{shaking(rows).max():.2f} N and not a word"
    if told[EventKind.OSCILLATION]:
        later = told[EventKind.OSCILLATION][0] + round(CALMED_S * RATE)
        assert rows["calm"][later:].min(initial=1.0) < 1.0 or rows["state"][-1] == SafetyState.SAFE_STOP


@pytest.mark.parametrize("seed", range(FEW))
def test_any_surface_is_quiet_or_told(seed: int):
    _assert_quiet_or_told(*_random_surface(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(FEW, MANY))
def test_a_thousand_surfaces_are_quiet_or_told(seed: int):
    _assert_quiet_or_told(*_random_surface(seed))


@pytest.mark.parametrize(("stiffness", "damping"), [(500.0, 400.0), (20000.0, 200.0), (20000.0, 60.0)])
def test_a_wall_too_damped_for_a_light_robot_is_capped_and_calm(stiffness: float, damping: float):
    """The limit (b + B) / (T/2 + delay) allows all of them; the first shook by 26 N, the second by 40 N, untold."""
    wild, free = _pressed("simulated_impedance", stiffness, damping, cap=0, passivity=0)
    tame, bench = _pressed("simulated_impedance", stiffness, damping)
    assert wild["margin"].min() < 0.0 and _told(free)[EventKind.OSCILLATION]
    assert tame["stiffness_share"].min() < 0.75 and tame["margin"].min() > 0.19
    assert _told(bench)[EventKind.CAP]
    assert np.median(shaking(tame)[RATE:]) < QUIET


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize(("stiffness", "damping"), [(500.0, 0.0), (500.0, 10.0), (2000.0, 10.0), (1500.0, 30.0)])
def test_an_ordinary_surface_is_left_as_it_is(device: str, stiffness: float, damping: float):
    """Nobody is softened for pressing: pressed and let go, knocked on, ripples and friction."""
    for surface in (
        {},
        {"surface__texture_height": 1e-3, "surface__texture_length": 5e-3, "surface__friction_static": 0.6},
    ):
        rows, bench = _pressed(device, stiffness, damping, **surface)
        assert rows["calm"][1:].min() == 1.0 and not _told(bench)[EventKind.OSCILLATION]
        assert rows["state"][-1] == SafetyState.ACTIVE


def test_what_no_model_knows_is_softened_and_then_stopped():
    """Without the cap a wall far beyond the region shakes the light robot; it fades, and stops where it stays."""
    rows, bench = press("simulated_impedance", 50000.0, 300.0, cap=0, passivity=0, force_limit=25.0)
    told = _told(bench)
    assert told[EventKind.OSCILLATION]
    first = told[EventKind.OSCILLATION][0]
    assert rows["calm"][first - 1] == 1.0 and np.all(np.diff(rows["calm"][first : first + 100]) <= 0.0)
    if rows["state"][-1] == SafetyState.SAFE_STOP:
        assert rows["cause"][-1] == TripCause.OSCILLATION
        assert (rows["f_user_world"][rows["state"] == SafetyState.SAFE_STOP] == 0.0).all()
    report = bench.engine.stability().as_dict()
    assert report["oscillations"] >= 1 and report["calm_min"] < 1.0


def test_passivity_controller_adds_no_force():
    """It used to multiply the force, by up to 20: never beyond the virtual one."""
    for device in DEVICES:
        for damping in (0.0, 5.0):
            on, _ = _pressed(device, 600.0, damping)
            felt, virtual = (np.linalg.norm(on[name], axis=1) for name in ("f_user_world", "f_virt_world"))
            viscosity = 1.1 * np.linalg.norm(on["v_world"], axis=1)
            assert np.all(felt <= virtual + viscosity + 1e-9)
