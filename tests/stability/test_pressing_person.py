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

LIMITED_S = 0.3
"""Time for which a force that leaves its limit falls, as a hand comes out of a surface that was pressed deeper [s]."""

FEW, MANY = 16, 1000


def _pressed(device: str, stiffness: float, damping: float, **values: float) -> tuple[np.ndarray, Bench]:
    return press(device, stiffness, damping, force_limit=FORCE_LIMIT[device], **values)


def _told(bench: Bench) -> dict[EventKind, list[int]]:
    """Ticks of the events that tell of a contact that was not rendered as it was authored."""
    events = bench.engine.events()
    kinds = (EventKind.CAP, EventKind.OSCILLATION, EventKind.FORCE_LIMIT, EventKind.TRIP)
    return {kind: [int(event["tick"]) for event in events if event["kind"] == kind] for kind in kinds}


def _random_surface(seed: int) -> tuple[str, float, float]:
    """Device, stiffness [N/m] and damping [N s/m] of what scenes may ask: from foam to steel, dry to tar."""
    rng = np.random.default_rng([32, seed])
    return DEVICES[seed % 2], float(10 ** rng.uniform(2.0, 4.7)), float(10 ** rng.uniform(0.3, 2.6))


def _after(ticks: list[int], length: int, seconds: float) -> np.ndarray:
    """Whether each of `length` ticks is within some time after one of `ticks`."""
    mask = np.zeros(length, bool)
    for tick in ticks:
        mask[tick : tick + round(seconds * RATE)] = True
    return mask


def _assert_quiet_or_told(device: str, stiffness: float, damping: float) -> None:
    """What a cap left is quiet, too; a force at its limit may shake for LIMITED_S, an oscillation for CALMED_S."""
    rows, bench = _pressed(device, stiffness, damping)
    told, loud = _told(bench), shaking(rows) > QUIET
    if rows["state"][-1] == SafetyState.SAFE_STOP:
        assert told[EventKind.TRIP]
    at_limit = np.flatnonzero(np.linalg.norm(rows["f_user_world"], axis=1) > 0.999 * FORCE_LIMIT[device])
    assert bool(told[EventKind.FORCE_LIMIT]) == bool(len(at_limit)), "what is cut is told, and nothing else"
    excused = _after(at_limit.tolist(), len(rows), LIMITED_S)
    excused |= _after([max(0, tick - RATE // 4) for tick in told[EventKind.OSCILLATION]], len(rows), 0.25 + CALMED_S)
    left = np.flatnonzero(loud & ~excused)
    assert len(left) <= KNOCK_S * RATE, f"{shaking(rows)[left].max():.2f} N for {len(left)} ms and not a word"


@pytest.mark.parametrize("seed", range(FEW))
@pytest.mark.requirement("R11")
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


@pytest.mark.requirement("R11")
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


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("stiffness", [200.0, 600.0, 2000.0])
@pytest.mark.parametrize("damping", [0.0, 1.0, 5.0])
def test_the_passivity_controller_takes_energy_without_chatter_and_adds_no_force(
    device: str, stiffness: float, damping: float
):
    """It used to multiply the force by up to 20, and later to cut it in steps near the surface (0.8 N)."""
    felt, contacts, shaken = {}, {}, {}
    for passivity in (0, 1):
        rows, _ = _pressed(device, stiffness, damping, passivity=passivity)
        felt[passivity] = rows
        contacts[passivity] = np.count_nonzero(np.diff((rows["f_user_world"] != 0.0).any(axis=1).astype(int)) == 1)
        shaken[passivity] = shaking(rows).max()
    assert contacts[1] <= contacts[0] and shaken[1] < shaken[0] + 0.05, (contacts, shaken)
    assert min(felt[1]["credit"].min(), felt[1]["energy"].min()) > -1e-6, "the other plate gives up to 17 mJ"
    size, virtual = (np.linalg.norm(felt[1][name], axis=1) for name in ("f_user_world", "f_virt_world"))
    assert np.all(size <= virtual + 1.1 * np.linalg.norm(felt[1]["v_world"], axis=1) + 1e-9)
