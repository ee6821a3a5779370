"""Energy that a wall generates under strokes at constant speed while ticks are late or dropped, by the loop's tick.

Between ticks the force is held, so that a stroke through depths x_i takes the work sum f_i (x_{i+1} - x_i): a spring
generates K/2 sum (x_{i+1} - x_i)^2 and a damper dissipates b v |x_{i+1} - x_i|. At constant speed both are sums over
the periods h_i, and

    b needed = K/2 sum(h_i^2) / sum(h_i)

the mean period weighted by its length, not K T/2. The tick is that of the product, with its late-tick policy (hold
beyond 2 ms, ramp down beyond 10 ms) on or off; the passivity observer integrates the energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import from_dtype, types
from numpy.typing import NDArray

from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.loop.controller_slots import names_in
from mimics_app.contracts.loop.device_descriptor import KINEMATICS_SET, Kin
from mimics_app.contracts.loop.haptic import SAMPLE, SCENE
from mimics_app.contracts.loop.loop_ports import COMMAND_LENGTH, DATA_DQ, DATA_LENGTH, DATA_Q, FIELDS
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.lab.stability.linear import find_limit
from mimics_app.rendering.haptic.controllers.registry import controllers_of, set_controllers
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER, observe
from mimics_app.rendering.haptic.kernels.safety import HOLD, IN_TIME, LATE_DAMP
from mimics_app.rendering.haptic.kernels.state import STATE, new_states
from mimics_app.rendering.haptic.loop_tick import SIMULATION, TICK, late_class, tick
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, no_objects
from mimics_app.rendering.haptic.objects import OBJECT_WORK, ROWS, ObjectWork, new_object_work
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.tunnel_geometry import build_tunnel

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        Fields,
        Ints,
        ObjectWork,
        ObserverRecord,
        SampleRecord,
        SceneRecord,
        Simulate,
        StateRecord,
        Table,
        Tick,
    )

__all__ = [
    "PERIOD",
    "STIFFNESS",
    "Stroke",
    "Wakes",
    "classes_of",
    "energy_and_calm",
    "energy_of",
    "exact_energy",
    "exact_needed",
    "needed_damping",
    "wakes_with",
    "wakes_without",
    "weighted_period",
]


_VECTOR = types.float64[::1]

PERIOD = 1e-3  # tick [s]
STIFFNESS = 2000.0  # of the wall [N/m]

_TUNNEL = 0.04  # radius of the tunnel [m]
_BALL = 0.01  # of the ball in it [m]
_ROOM = _TUNNEL - _BALL
_QUIET = 1.0  # time before the first stroke [s]
_UNLIMITED = 1e9  # limit that is never reached
_LEAST, _MOST = 0.05, 1000.0
_FINE = 1e-6  # relative width at which the exact search ends

_PERIOD_NS = 1_000_000
"""`PERIOD` [ns]."""


@dataclass(frozen=True, slots=True)
class Stroke:
    """Motion in and out of the wall at constant speed, from `gap` before to `depth` behind its surface.

    Attributes:
        speed: Speed [m/s].
        depth: Largest depth [m].
        gap: Distance before the surface [m].
        count: Number of strokes in and out.
    """

    speed: float = 0.1
    depth: float = 0.02
    gap: float = 0.005
    count: int = 12

    @property
    def seconds(self) -> float:
        """Length of the run [s], with the initial time at rest in which the force is ramped up."""
        return _QUIET + 2.0 * self.count * (self.depth + self.gap) / self.speed + 0.1

    def at(self, t: Vec) -> tuple[Vec, Vec]:
        """Return depth behind the surface [m] and its rate [m/s] at times t [s]."""
        half = (self.depth + self.gap) / self.speed
        phase = (t - _QUIET) / half
        moving = (phase >= 0.0) & (phase < 2 * self.count)
        inward = np.floor(phase) % 2 == 0
        share = np.where(inward, phase % 1.0, 1.0 - phase % 1.0)
        moved = np.where(moving, share, 0.0) * (self.depth + self.gap)
        rate = np.where(moving, np.where(inward, self.speed, -self.speed), 0.0)
        return moved - self.gap, rate


@dataclass(frozen=True, slots=True)
class Wakes:
    """Times at which the ticks of a loop ran.

    Attributes:
        t: Time of each tick [s], shape [n], ascending.
        late_ns: Lateness of each tick [ns], shape [n].
    """

    t: Vec
    late_ns: NDArray[np.int64]


def wakes_with(lateness: Vec, seconds: float) -> Wakes:
    """Return the ticks of a loop with a lateness [s] after each release, repeated over a number of seconds.

    Ticks after a late one follow back to back, 10 us each. The first second, at rest, is in time: the loop's soft start
    waits for ticks in time.
    """
    ticks = round(seconds / PERIOD)
    due = PERIOD * np.arange(ticks)
    late = np.where(due < _QUIET, 0.0, np.resize(np.maximum(lateness, 0.0), ticks))
    after = 1e-5 * np.arange(ticks)
    t = np.asarray(np.maximum.accumulate(due + late - after) + after, np.float64)
    return Wakes(t, np.round((t - due) * 1e9).astype(np.int64))


def wakes_without(dropped: NDArray[np.bool_], seconds: float) -> Wakes:
    """Return the ticks of a loop that drops some by a pattern, repeated over a number of seconds."""
    ticks = round(seconds / PERIOD)
    due = PERIOD * np.arange(ticks)
    t = np.asarray(due, np.float64)[~np.resize(dropped, ticks) | (due < _QUIET)]
    return Wakes(t, np.zeros(len(t), np.int64))


def weighted_period(wakes: Wakes) -> float:
    """Return the mean period weighted by its length, sum(h^2) / sum(h), the T of the live stiffness limit [s]."""
    hold = np.diff(wakes.t[wakes.t >= _QUIET])
    return float(np.sum(hold**2) / np.sum(hold))


@kernel
def _classes(scenes: Table[SceneRecord], late_ns: Ints, held: Ints) -> None:
    """Compute the late-tick class of every tick, with misses in a row counted as in `run_live`."""
    in_row = 0
    before = 0
    for i in range(late_ns.shape[0]):
        held[i] = late_class(scenes[0], late_ns[i], in_row)
        if late_ns[i] <= _PERIOD_NS:
            in_row = 0
        elif before <= _PERIOD_NS:
            in_row += 1
        before = late_ns[i]


_KIN = tuple(HAPTICMASTER.kinematics)


@typed_kernel(
    types.void(
        from_dtype(SCENE)[::1],
        ROWS,
        OBJECT_WORK,
        types.FunctionType(TICK),
        SIMULATION,
        FIELDS,
        KINEMATICS_SET,
        _VECTOR,
        _VECTOR,
        types.int64[::1],
        types.float64,
        from_dtype(STATE)[::1],
        from_dtype(SAMPLE)[::1],
        from_dtype(OBSERVER)[::1],
        _VECTOR,
    )
)
def _stroke(
    scenes: Table[SceneRecord],
    rows: Rows,
    objects: ObjectWork,
    tick: Tick,
    simulate: Simulate,
    fields: Fields,
    kin: Kin,
    depth: Vec,
    rate: Vec,
    held: Ints,
    period: float,
    states: Table[StateRecord],
    samples: Table[SampleRecord],
    observers: Table[ObserverRecord],
    out: Vec,
) -> None:
    """Run the product's tick over a prescribed motion; `out`: energy taken from the user after each tick [J]."""
    rows, objects, states = borrowed(rows), borrowed(objects), borrowed(states)
    data, command = np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH)
    for i in range(depth.shape[0]):
        data[DATA_Q + 2] = _ROOM + depth[i]
        data[DATA_DQ + 2] = rate[i]
        tick(
            scenes[0],
            rows,
            objects,
            simulate,
            fields,
            kin,
            states,
            data,
            0,
            0,
            held[i],
            period,
            period,
            command,
            samples[0],
        )
        out[i] = observe(observers[0], states[0].hip_world, states[0].f_user_world)


def _rows(damping: float) -> Rows:
    rows = new_rows(ObjectCapacities())
    tunnel = rows.tunnels[0]
    build_tunnel([[-0.15, 0.0, 0.0], [0.15, 0.0, 0.0]], _TUNNEL).fill(tunnel)
    tunnel["radius_scale"], tunnel["stiffness"], tunnel["damping"] = 1.0, STIFFNESS, damping
    return rows


def _scene() -> NDArray[Any]:
    scene = scene_from_components()
    record = scene[0]
    record["objects"]["tunnels"] = 1
    record["ball_radius_min"] = record["ball_radius_max"] = _BALL
    record["force_limit"] = record["force_rate_limit"] = record["power_limit"] = _UNLIMITED
    record["energy_limit"] = record["position_jump"] = record["measured_force_limit"] = _UNLIMITED
    record["cap"] = record["passivity"] = 0
    record["ramp_force"], record["ramp_time"] = 0.1, PERIOD
    return scene


def classes_of(wakes: Wakes, policy: bool) -> NDArray[np.int64]:
    """Return the late-tick class of every tick; all in time with the policy off."""
    held = np.full(len(wakes.t), IN_TIME, np.int64)
    if policy:
        _classes(_scene(), wakes.late_ns, held)
    return held


def energy_of(wakes: Wakes, damping: float, policy: bool, stroke: Stroke = Stroke()) -> float:
    """Return the energy that the wall took from the user in total, by tick and observer [J]; < 0: generated."""
    return energy_and_calm(wakes, damping, policy, stroke)[0]


def energy_and_calm(wakes: Wakes, damping: float, policy: bool, stroke: Stroke = Stroke()) -> tuple[float, float]:
    """Return that energy, and the least share of the force that the detector of oscillation left.

    Where it is below 1 the held forces swung, and the sum of `exact_energy` does not hold.
    """
    depth, rate = stroke.at(wakes.t)
    out = np.zeros(len(wakes.t))
    held = classes_of(wakes, policy)
    samples, observers = np.zeros(1, SAMPLE), np.zeros(1, OBSERVER)
    objects = new_object_work(ObjectCapacities())
    scene = _scene()
    plugins = (tick, no_objects, NO_FIELDS, _KIN)
    motion = (depth, rate, held, PERIOD)
    states = new_states()
    set_controllers(states, controllers_of(names_in(scene[0]["controller_names"])))
    _stroke(scene, _rows(damping), objects, *plugins, *motion, states, samples, observers, out)
    return float(out[-1]), float(states[0]["swing"]["least_calm"])


def exact_energy(wakes: Wakes, damping: float, policy: bool, stroke: Stroke = Stroke()) -> float:
    """Return the same energy as the sum of held forces times displacements.

    Raises:
        ValueError: The policy would ramp the force down, which the sum does not include.
    """
    depth, rate = stroke.at(wakes.t)
    force = np.where(depth > 0.0, np.maximum(0.0, STIFFNESS * depth + damping * rate), 0.0)
    held = classes_of(wakes, policy)
    if np.any(held >= LATE_DAMP):
        raise ValueError("the policy ramps the force down: no closed form")
    last_fresh = np.maximum.accumulate(np.where(held == HOLD, 0, np.arange(len(held))))
    return float(np.sum(force[last_fresh][:-1] * np.diff(depth)))


def needed_damping(wakes: Wakes, policy: bool, stroke: Stroke = Stroke()) -> float:
    """Return the damping at which the wall generates no energy in total, by simulation [N s/m]."""
    return find_limit(lambda b: energy_of(wakes, b, policy, stroke) > 0.0, _MOST, _LEAST)


def exact_needed(wakes: Wakes, policy: bool, stroke: Stroke = Stroke()) -> float:
    """Return the same damping by `exact_energy`."""
    return find_limit(lambda b: exact_energy(wakes, b, policy, stroke) > 0.0, _MOST, _LEAST, _FINE)
