"""Peers of the haptic bodies, timed by the same rules: MuJoCo and Bullet where Python can import them.

The scene is that of `bodies_on_a_floor`: free bodies of 0.2 kg and 4 cm at rest on a plane, and a probe that slides
along the first as the HIP does. The penetration depends on an engine's contact law; here a sphere of 1 cm penetrates
0.4 mm. Other peers are measured by harnesses of their own, see `haptic_harness`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from importlib.metadata import version
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.lab.probe import shortest_us

__all__ = ["PEERS", "ROUNDS", "best_us", "measure_peer"]

Step = Callable[[], object]
Build = Callable[[str, int, F8, ExitStack], tuple[str, Step]]

ROUNDS = 20
"""Rounds of each measurement, of which the shortest counts."""

_SETTLING_TICKS = 200
"""Ticks before the first round, in which the bodies come to rest."""

_TRIED = 10
_MOST_TICKS = 1000
_LONGEST_NS = 20_000_000
"""Longest duration of a round [ns]: short, so that some are not interrupted."""

_HALF = 0.02
_MASS = 0.2
_PITCH = 0.06
_PROBE_RADIUS = 0.01
_PROBE_HEIGHT = 0.0495


def best_us(run: Callable[[int], object]) -> float:
    """Return the cost of a tick [us] in the shortest of `ROUNDS` rounds, at rest; `run` does a number of ticks."""
    run(_SETTLING_TICKS)
    clock = MonotonicClock()
    started = clock.now_ns()
    run(_TRIED)
    ticks = int(np.clip(_LONGEST_NS * _TRIED / max(1, clock.now_ns() - started), _TRIED, _MOST_TICKS))
    return shortest_us(lambda: run(ticks), ticks, ROUNDS)


def measure_peer(build: Build, kind: str, count: int, slide: F8) -> tuple[str, float] | None:
    """Return name and cost of a step [us] of a peer called from Python; None where it is not installed.

    Args:
        build: One of `PEERS`.
        kind: "sphere", "box" or "cylinder".
        count: Number of bodies.
        slide: Displacement of the probe along x at each tick [m], repeated, shape [n].
    """
    with ExitStack() as stack:
        try:
            name, step = build(kind, count, slide, stack)
        except ImportError:
            return None

        def run(ticks: int) -> None:
            for _ in range(ticks):
                step()

        return name, best_us(run)


def _places(count: int) -> list[tuple[float, float]]:
    side = max(1, int(np.ceil(np.sqrt(count))))
    return [((i % side) * _PITCH, (i // side) * _PITCH) for i in range(count)]


def _mujoco(kind: str, count: int, slide: F8, _: ExitStack) -> tuple[str, Step]:
    import mujoco

    size = {"sphere": f"{_HALF}", "box": f"{_HALF} {_HALF} {_HALF}", "cylinder": f"{_HALF} {_HALF}"}[kind]
    bodies = "".join(
        f'<body pos="{x} {y} {_HALF - 1e-4}"><freejoint/><geom type="{kind}" size="{size}" mass="{_MASS}"/></body>'
        for x, y in _places(count)
    )
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.001" integrator="implicitfast" gravity="0 0 -9.81"/><size memory="512M"/>'
        f'<worldbody><geom type="plane" size="50 50 1"/><body mocap="true" pos="0 0 {_PROBE_HEIGHT}">'
        f'<geom type="sphere" size="{_PROBE_RADIUS}"/></body>{bodies}</worldbody></mujoco>'
    )
    data, ticks = mujoco.MjData(model), [0]

    def step() -> None:
        data.mocap_pos[0] = (slide[ticks[0] % len(slide)], 0.0, _PROBE_HEIGHT)
        mujoco.mj_step(model, data)
        ticks[0] += 1

    return f"MuJoCo {mujoco.__version__}", step


def _bullet(kind: str, count: int, slide: F8, stack: ExitStack) -> tuple[str, Step]:
    import pybullet as bullet

    bullet.connect(bullet.DIRECT)
    stack.callback(bullet.disconnect)
    bullet.setGravity(0, 0, -9.81)
    bullet.setTimeStep(1e-3)
    bullet.createMultiBody(0, bullet.createCollisionShape(bullet.GEOM_PLANE))
    ball = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=_PROBE_RADIUS)
    probe = bullet.createMultiBody(0, ball, basePosition=[0, 0, _PROBE_HEIGHT])
    arguments: dict[str, Any] = {
        "sphere": {"shapeType": bullet.GEOM_SPHERE, "radius": _HALF},
        "box": {"shapeType": bullet.GEOM_BOX, "halfExtents": [_HALF] * 3},
        "cylinder": {"shapeType": bullet.GEOM_CYLINDER, "radius": _HALF, "height": 2 * _HALF},
    }[kind]
    shape = bullet.createCollisionShape(**arguments)
    for x, y in _places(count):
        bullet.createMultiBody(_MASS, shape, basePosition=[x, y, _HALF - 1e-4])
    ticks = [0]

    def step() -> None:
        place = (slide[ticks[0] % len(slide)], 0.0, _PROBE_HEIGHT)
        bullet.resetBasePositionAndOrientation(probe, place, (0, 0, 0, 1))
        bullet.stepSimulation()
        ticks[0] += 1

    return f"Bullet (pybullet {version('pybullet')})", step


PEERS: dict[str, Build] = {"MuJoCo": _mujoco, "Bullet": _bullet}
"""Builders of the peers' scenes: name with version, and a function that does one step; ImportError without a peer."""
