"""Cost of the whole haptic tick with simulated robot and patient, by the projection of the tunnel.

The planner predicts the cost of a scene's tick from this group.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.loop.haptic import INBOX, SAMPLE
from mimics_app.contracts.loop.haptic_objects import Projection
from mimics_app.contracts.loop.object_rows import ObjectCapacities, Rows, new_rows
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.replay import replay_run
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.rendering.haptic.scene_tunnel import PROJECTIONS
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve, build_tunnel
from mimics_app.world.components.robot import Patient, Robot

__all__ = ["reference_us", "tick_us"]


_NO_TUNNEL = "no tunnel"
_REFERENCE_CALLS = 20_000

_TICKS = 2000
_RUNS = 6
_SEED = 1
_REACH = 0.15
"""Half the length of the tunnel [m]; its bisector is a sine of 20 mm in the frontal plane."""


@kernel
def _turn_often(R: F8, p: F8, calls: int) -> None:
    for _ in range(calls):
        x = R[0, 0] * p[0] + R[0, 1] * p[1] + R[0, 2] * p[2]
        y = R[1, 0] * p[0] + R[1, 1] * p[1] + R[1, 2] * p[2]
        z = R[2, 0] * p[0] + R[2, 1] * p[1] + R[2, 2] * p[2]
        length = np.sqrt(x * x + y * y + z * z)
        p[0] = x / length
        p[1] = y / length
        p[2] = z / length


def reference_us() -> float:
    """Return the cost of one rotation and normalisation of a vector [us], the shortest of a few runs."""
    R = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    return shortest_us(lambda: _turn_often(R, np.ones(3), _REFERENCE_CALLS), _REFERENCE_CALLS)


@cache
def _curve() -> TunnelCurve:
    x = np.linspace(-_REACH, _REACH, 13)
    return build_tunnel(np.column_stack([x, 0.02 * np.sin(2.0 * np.pi * x / _REACH), np.zeros(13)]), 0.022)


def _block(projection: Projection | None) -> tuple[NDArray[Any], Rows]:
    """Return the parameter block of a tick with this projection, shape [1], and its rows; None: without a tunnel."""
    block, rows = scene_from_components(Robot()), new_rows(ObjectCapacities())
    if projection is not None:
        block[0]["objects"]["tunnels"] = 1
        record = rows.tunnels[0]
        _curve().fill(record)
        record["radius_scale"] = 1.0
        record["stiffness"], record["damping"], record["projection"] = 1500.0, 10.0, projection
    return block, rows


class _Bench:
    """The loop with a simulated robot and a patient who travels the tunnel, without other processes."""

    def __init__(self, projection: Projection | None) -> None:
        curve = _curve()
        via = curve.point(np.linspace(0.0, len(curve.pieces), 61))
        self._memory = SessionMemory()
        self._engine = HapticEngine(self._memory, build_device(Robot(), Patient(), via, _SEED))
        self._engine.publish(*_block(projection))
        inbox = np.zeros(1, INBOX)
        inbox["active"] = 1
        self._engine.send(inbox)
        self._rows: NDArray[Any] = np.zeros(len(self._memory.samples), SAMPLE)

    def run_us(self, ticks: int) -> float:
        """Run ticks and return the cost of one [us], without reading the samples."""
        clock = MonotonicClock()
        started = clock.now_ns()
        self._engine.advance(ticks)
        cost = (clock.now_ns() - started) * 1e-3 / ticks
        self._read()
        return cost

    def go_round(self) -> None:
        """Run until the whole sample ring was written once: the system maps fresh memory page by page."""
        for _ in range(len(self._rows) // _TICKS + 1):
            self.advance(_TICKS)

    def advance(self, ticks: int) -> NDArray[Any]:
        """Run ticks and return their samples."""
        self._engine.advance(ticks)
        return self._read()

    def _read(self) -> NDArray[Any]:
        count = ring.drain(self._memory.sample_words, self._memory.samples, self._rows)
        self._engine.events()
        return self._rows[:count]


def tick_us(projection: Projection | None) -> float:
    """Return the cost of a tick [us], the shortest of a few runs of 2000; None: without a tunnel."""
    bench = _Bench(projection)
    bench.go_round()
    return min(bench.run_us(_TICKS) for _ in range(_RUNS))


@cache
def _inputs() -> NDArray[Any]:
    """Return the SAMPLE rows [ticks] of one travel: every projection gets the same motion of the hand."""
    return _Bench(Projection.NEWTON_WARM).advance(_TICKS).copy()


def _forces(projection: Projection | None) -> F8:
    """Return the virtual force on the user in that travel [N], shape [ticks, 3]."""
    block, rows = _block(projection)
    return replay_run(_inputs(), {1: block}, {1: rows}).samples["f_virt_world"].copy()


def _false_force(projection: Projection | None) -> float:
    """Return the largest difference of the force from that of tracked Newton [N]; of Newton from golden section."""
    other = Projection.GOLDEN_SECTION if projection is Projection.NEWTON_WARM else Projection.NEWTON_WARM
    return float(np.max(np.linalg.norm(_forces(projection) - _forces(other), axis=1)))


_VALID = "one tunnel, one ball, the simulated robot"
_PROJECTED = "kernels.tick with this projection of the tunnel"
compare(
    __name__,
    "one tick of the loop, simulated robot and patient in a wavy tunnel; error: false force on the same hand",
    "N",
    [
        *(Rival(word, _PROJECTED, _VALID, {"projection": word}, (each,)) for word, each in PROJECTIONS.items()),
        Rival(_NO_TUNNEL, "kernels.tick alone", _VALID, {}, (None,)),
    ],
    Probes(tick_us, _false_force, reference_us),
    default="newton warm",
)
