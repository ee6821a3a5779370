"""Conformance kit of controllers: what the 1 kHz loop takes for granted of one, built in or of a package."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.controller_port import ControllerPlugin
from mimics_app.contracts.loop.controller_slots import CommandKind, Lead, Slot
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_block import controller_values, impedance_values, kinematic_values
from mimics_app.world.components.robot import Impedance, Patient, Robot
from tests.support.haptic_bench import Bench, bench_of

SETTLE = 400
"""Ticks after which nothing moves in a stop state."""

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Machine:
    """A simulated device on which a controller is tried.

    Attributes:
        device: Its name.
        settings: Its settings.
    """

    device: str = "simulated_hapticmaster"
    settings: tuple[tuple[str, Any], ...] = ()

    def bench(self, seed: int = 3) -> tuple[Bench, DevicePlugin]:
        """The device under the loop, a person on it, without walls."""
        robot = Robot(device=self.device, settings=dict(self.settings))
        path = np.array([[-0.1, 0.0, 0.0], [0.1, 0.05, 0.0]])
        plugin = build_device(robot, Patient(preset="moderate"), path, seed)
        bench = bench_of(plugin, straight=None)
        assert plugin.descriptor is not None
        values = kinematic_values(robot, plugin.descriptor)
        if CommandKind.FORCE in plugin.takes:
            values |= impedance_values(bench.scene, Impedance())
        bench.publish(**values)
        return bench, plugin


HAPTICMASTER, LEG = Machine(), Machine("simulated_leg")
LOKOMAT = Machine("lokomat:sim")
LIGHT, TORQUE_LEG = Machine("simulated_impedance"), Machine("simulated_leg", (("mode", "torque"),))


def check_controller(name: str, machine: Machine = HAPTICMASTER, **parameters: Any) -> None:
    """Raise AssertionError at what a controller must not do.

    Args:
        name: Name of the controller, built in or of an installed package.
        machine: Device on which it is tried.
        parameters: Its parameters; those missing have their default.
    """
    plugin = find_controller(name)
    assert plugin.name == name and plugin.leads in (Lead.TARGET, Lead.PERSON)
    for each in plugin.parameters:
        assert each.least <= each.default <= each.most, f"{each.name}: its default is outside its range"
    assert np.isfinite(parameter_vector(plugin, {})).all()
    tried = _Trial(plugin, machine, parameters)
    tried.check_takes_over()
    tried.check_replays()
    tried.check_nan()
    tried.check_stop()


class _Trial:
    """One controller on one device, in turn with the one that holds the robot."""

    def __init__(self, plugin: ControllerPlugin, machine: Machine, parameters: dict[str, Any]) -> None:
        self._plugin, self._machine, self._parameters = plugin, machine, parameters
        self._slot = Slot.PERSON if plugin.leads is Lead.PERSON else Slot.START

    def _bench(self) -> Bench:
        bench, device = self._machine.bench()
        if self._plugin.leads is Lead.PERSON:
            assert self._plugin.commands in device.takes, f"{device.name} does not take what it commands"
        assert device.descriptor is not None and not self._plugin.refusal(device.descriptor)
        bench.publish(**controller_values(bench.scene, self._slot, self._plugin.name, self._parameters))
        return bench

    def _select(self, bench: Bench, slot: Slot) -> None:
        """Select the controller, or the one that holds; either has its target where the robot is."""
        at = bench.engine.snapshot()
        if slot == Slot.HOLD or (self._plugin.leads is Lead.TARGET and self._plugin.target == 0):
            target = at.q
        else:
            target = bench.scene[0]["R_world_from_robot"].T @ (at.hip_world - bench.scene[0]["origin_world"])
        bench.publish(controller=slot, target=target, trial=1, ramp_force=500.0, ramp_time=0.05)
        bench.send(active=int(slot == Slot.PERSON), trial=1)

    def _run(self, bench: Bench) -> NDArray[Any]:
        """Hold, the controller, hold, and the controller again: it takes over twice, and is left twice."""
        parts = [bench.advance(20)]
        for _ in range(2):
            self._select(bench, Slot.HOLD)
            parts.append(bench.advance(150))
            self._select(bench, self._slot)
            parts.append(bench.advance(600))
        self._select(bench, Slot.HOLD)
        return np.concatenate([*parts, bench.advance(150)])

    def check_takes_over(self) -> None:
        """Command and force stay within all limits, at each change of the controller too: no step is felt."""
        bench = self._bench()
        samples, scene = self._run(bench), bench.scene[0]
        assert (samples["state"] < SafetyState.DEGRADED).all(), f"stopped: cause {samples['cause'].max()}"
        led = samples["state"] == SafetyState.ACTIVE
        assert self._plugin.leads is Lead.TARGET or led.sum() > 200, "the person leads"
        joints = int(scene["joints"])
        command, dt = samples["command"][:, :joints], 1e-3
        for each in ("command", "f_command", "torque_command", "v_virtual"):
            assert np.isfinite(samples[each]).all(), each
        most = scene["joint_velocity"][:joints].astype(float)
        assert (np.abs(command) <= most * (1.0 + _ROUNDING)).all(), "velocity of a joint"
        step = np.abs(np.diff(command, axis=0))
        braking = np.abs(command[1:]) < np.abs(command[:-1])  # the brake at a joint limit may stop faster
        rise = scene["joint_acceleration"][:joints].astype(float) * dt * (1.0 + 1e-6) + _ROUNDING
        assert ((step <= rise) | braking).all(), "acceleration of a joint"
        force = np.linalg.norm(samples["f_command"], axis=1)
        assert (force <= scene["force_limit"] * (1.0 + _ROUNDING)).all(), "force"
        assert (_growth(samples["f_command"]) <= scene["force_rate_limit"] * dt * (1.0 + 1e-6) + _ROUNDING).all()

    def check_replays(self) -> None:
        """Its recorded inputs give the same outputs again, bit for bit: it has no state but its memory."""
        bench = self._bench()
        samples = self._run(bench)
        again = bench.replay(samples)
        for each in ("command", "f_command", "torque_command", "v_virtual", "state"):
            assert samples[each].tobytes() == again[each].tobytes(), f"{each} differs in a replay"

    def check_nan(self) -> None:
        """A number of the device that is not finite stops in the same tick, without force, and motion decays."""
        bench = self._bench()
        self._select(bench, self._slot)
        before = bench.advance(500)
        assert (before["state"] < SafetyState.SAFE_STOP).all()
        record = before[-50:].copy()
        record["q"][20:, 0] = math.nan
        whole = np.concatenate([before[:-50], record])
        after = bench.replay(whole)[-30:]
        assert (after["state"] == SafetyState.SAFE_STOP).all() and after["cause"][0] == TripCause.NOT_FINITE
        _check_at_rest(after, settled=False)

    def check_stop(self) -> None:
        """A stop takes the force away within two ticks, in each latched state, and motion decays to zero."""
        for state in (SafetyState.E_STOP, SafetyState.SAFE_STOP):
            bench = self._bench()
            self._select(bench, self._slot)
            bench.advance(500)
            if state is SafetyState.E_STOP:
                request_stop(bench.memory)
            else:
                bench.publish(joint_max=bench.scene[0]["joint_min"] - 1.0)  # outside its workspace
            samples = bench.advance(SETTLE)
            assert (samples["state"][1:] == state).all()
            _check_at_rest(samples[1:])
            self._select(bench, Slot.HOLD)
            _check_at_rest(bench.advance(20))


def _growth(forces: NDArray[Any]) -> NDArray[Any]:
    """Change of a force from tick to tick that is no fall: its distance from the segment from zero to the last [N]."""
    last, now = forces[:-1], forces[1:]
    square = np.maximum(np.sum(last * last, axis=1), 1e-300)
    kept = np.clip(np.sum(last * now, axis=1) / square, 0.0, 1.0)
    return np.linalg.norm(now - kept[:, None] * last, axis=1)


def _check_at_rest(samples: NDArray[Any], *, settled: bool = True) -> None:
    """No force, no torque; the command never grows, and is zero in the end."""
    assert not samples["f_command"].any() and not samples["torque_command"].any(), "force in a stop state"
    size = np.abs(samples["command"]).max(axis=1)
    assert (np.diff(size) <= _ROUNDING).all(), "motion grows in a stop state"
    assert not settled or size[-1] == 0.0, "motion goes on in a stop state"
