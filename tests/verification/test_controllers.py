"""Controllers are plug-ins of the loop: built-in ones pass the kit, and faults of a controller stop the loop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.controller_port import CONTROLLER, ControllerParameter, ControllerPlugin, places_of
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead, Slot, names_in
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.rendering.haptic.controllers import registry
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.scene_block import controller_values, scene_from_components
from tests.support.controller_kit import HAPTICMASTER, LEG, LIGHT, LOKOMAT, TORQUE_LEG, check_controller

MACHINES = {
    "admittance_cartesian": HAPTICMASTER,
    "admittance_joints": LEG,
    "admittance_polar": HAPTICMASTER,
    "admittance_seed": HAPTICMASTER,
    "guided_joints": LEG,
    "impedance": LIGHT,
    "joint_pd": TORQUE_LEG,
    "lokomat_combined": LOKOMAT,
    "lokomat_impedance": LOKOMAT,
    "world_pd_joints": HAPTICMASTER,
    "world_pd_straight": LIGHT,
}


@pytest.mark.parametrize("name", registry.BUILT_IN)
def test_built_in_controllers_pass_the_kit(name: str):
    check_controller(name, MACHINES[name])


PARAMETERS = (
    ControllerParameter("stiffness", 30.0, 0.0, 1e3, "N m/rad", size=2),
    ControllerParameter("spoilt_from", 1e6, 0.0, 1e6, "ticks"),
)
STIFFNESS, SPOILT_FROM = places_of(PARAMETERS)
SEEN, FIRST = 0, 1
"""Places in the memory."""


@typed_kernel(CONTROLLER)
def _lean(kin, now, parameters, memory, work, out):
    """Spring of the joints around where it took over; not a number from a tick on."""
    if now.started == 1:
        for j in range(2):
            memory[FIRST + j] = now.q[j]
    memory[SEEN] += 1.0
    for j in range(now.joints):
        out.torque[j] = parameters[STIFFNESS + j] * (memory[FIRST + j] + 0.2 - now.q[j])
    if memory[SEEN] > parameters[SPOILT_FROM]:
        out.torque[0] = math.nan


LEAN = ControllerPlugin("lean", _lean, Lead.PERSON, CommandKind.TORQUE, PARAMETERS)


@pytest.fixture
def lean(monkeypatch: pytest.MonkeyPatch) -> None:
    real = registry.find_controller
    for module in ("controllers.registry", "scene_block"):
        monkeypatch.setattr(
            f"mimics_app.rendering.haptic.{module}.find_controller", lambda name: LEAN if name == "lean" else real(name)
        )
    monkeypatch.setattr("tests.support.controller_kit.find_controller", lambda name: LEAN)


@pytest.mark.usefixtures("lean")
def test_a_controller_of_torques_passes_the_kit():
    check_controller("lean", TORQUE_LEG, stiffness=(30.0, 20.0))


def _leaning(**parameters):
    bench, _ = TORQUE_LEG.bench()
    bench.publish(
        **controller_values(bench.scene, Slot.PERSON, "lean", parameters), trial=1, ramp_force=500.0, ramp_time=0.05
    )
    return bench


@pytest.mark.usefixtures("lean")
def test_its_torque_reaches_the_joints_and_is_paid_from_the_tank():
    """At the start, before anything moved, the spring of 0.2 rad makes 6 and 4 N m, softly begun."""
    pushed, free = _leaning(stiffness=(30.0, 20.0)), _leaning(stiffness=0.0)
    samples, still = pushed.advance(400), free.advance(400)
    first = np.flatnonzero(samples["state"] == SafetyState.ACTIVE)[0]
    assert not samples["torque_command"][:first].any(), "soft start: nothing before the person feels anything"
    grown = samples["torque_command"][first + 60]
    assert np.allclose(grown[:2], (6.0, 4.0), rtol=0.5) and not grown[2:].any()
    assert np.abs(samples["q"][-1] - still["q"][-1]).max() > 0.02, "it moves the leg"
    assert samples["tank"].min() < still["tank"].min(), "what it gives is taken from the tank"


@pytest.mark.usefixtures("lean")
def test_a_command_that_is_not_finite_stops_in_its_own_tick():
    bench = _leaning(spoilt_from=300.0)
    samples = bench.advance(600)
    stopped = np.flatnonzero(samples["state"] == SafetyState.SAFE_STOP)
    assert samples["cause"][stopped[0]] == TripCause.NOT_FINITE
    assert np.isfinite(samples["torque_command"]).all() and not samples["torque_command"][stopped].any()


@pytest.mark.usefixtures("lean")
def test_memory_is_cleared_when_another_takes_over():
    """`spoilt_from` counts ticks in the memory: two turns of 200 ticks never reach 300."""
    bench = _leaning(spoilt_from=300.0)
    for _ in range(3):
        assert bench.advance(200)["state"][-1] < SafetyState.SAFE_STOP
        bench.publish(controller=Slot.HOLD, target=bench.engine.snapshot().q)
        bench.advance(20)
        bench.publish(controller=Slot.PERSON)


def test_parameters_are_checked_by_name_and_range():
    vector = parameter_vector(LEAN, {"stiffness": 7.0})
    assert vector[:3].tolist() == [7.0, 7.0, 1e6] and not vector[3:].any()
    with pytest.raises(UsageError, match='"lean" has no parameter "stifness"') as caught:
        parameter_vector(LEAN, {"stifness": 1.0})
    assert caught.value.fix == 'did you mean "stiffness"'
    with pytest.raises(UsageError, match=r'"stiffness" .* takes 2 numbers, not 3'):
        parameter_vector(LEAN, {"stiffness": (1.0, 2.0, 3.0)})
    with pytest.raises(UsageError, match=r'"stiffness" .* = -1.0 is refused'):
        parameter_vector(LEAN, {"stiffness": -1.0})
    with pytest.raises(UsageError, match=r'"stiffness" .* is refused'):
        parameter_vector(LEAN, {"stiffness": math.nan})


def test_names_do_not_get_lost_in_the_block():
    block = scene_from_components()[0]
    assert names_in(block["controller_names"]) == (
        "", "joint_pd", "world_pd_straight", "admittance_cartesian", "", "",
    )  # fmt: skip
    with pytest.raises(UsageError, match='no controller "joint_pid"'):
        registry.find_controller("joint_pid")
    with pytest.raises(ValueError, match="1 to 32 ASCII characters"):
        ControllerPlugin("x" * 33, _lean, Lead.PERSON, CommandKind.TORQUE)
