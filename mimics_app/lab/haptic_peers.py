"""Peers of the haptic objects: MuJoCo and Bullet measured where they are installed, else what was measured once.

The quoted figures are microseconds per tick on a 2-core virtual machine (AMD EPYC) that this product was measured on
too: CHAI3D 3.3.0 with -O3 -march=native and no device, tool sliding in contact; MuJoCo 4.0.0 (implicitfast) and
pybullet 3.2.7, one step of 1 ms called from Python. Neither peer is needed by the product.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mimics_app.contracts.clock import MonotonicClock

__all__ = ["PEERS", "chai3d_us"]

_CHAI3D: dict[tuple[str, int], float] = {
    ("sphere", 1): 0.12,
    ("sphere", 10): 0.27,
    ("sphere", 100): 1.81,
    ("sphere", 1000): 18.1,
    ("box", 1): 0.12,
    ("box", 10): 0.24,
    ("box", 100): 1.61,
    ("box", 1000): 16.1,
    ("cylinder", 1): 0.14,
    ("cylinder", 10): 0.42,
    ("cylinder", 100): 3.37,
    ("cylinder", 1000): 34.0,
    ("mesh", 10_000): 11.7,
}
_MUJOCO: dict[str, tuple[float | None, ...]] = {
    "sphere": (4.1, 12.5, 87.0, 1555.0),
    "box": (5.2, 29.0, 270.0, 2709.0),
    "cylinder": (4.9, 25.2, 222.0, None),
}
_BULLET: dict[str, tuple[float | None, ...]] = {
    "sphere": (8.5, 33.8, 304.0, 4666.0),
    "box": (17.9, 116.0, 1014.0, 6905.0),
    "cylinder": (12.1, 68.0, 640.0, None),
}
_COUNTS = (1, 10, 100, 1000)
_HALF = 0.02
_MASS = 0.2
_PITCH = 0.06
_REPEATS = 3


def chai3d_us(work: str, n: int) -> float | None:
    """CHAI3D's cost of the workload [us], quoted; None where it was not measured."""
    return _CHAI3D.get((work, n))


def _places(count: int) -> list[tuple[float, float]]:
    side = max(1, int(np.ceil(np.sqrt(count))))
    return [((i % side) * _PITCH, (i // side) * _PITCH) for i in range(count)]


def _time_us(step: Callable[[], object], count: int) -> float:
    steps = 2000 if count <= 10 else 300 if count <= 100 else 30
    clock, shortest = MonotonicClock(), 1 << 62
    for _ in range(min(steps, 200)):
        step()
    for _ in range(_REPEATS):
        started = clock.now_ns()
        for _ in range(steps):
            step()
        shortest = min(shortest, clock.now_ns() - started)
    return shortest * 1e-3 / steps


def _mujoco_us(kind: str, count: int) -> float:
    import mujoco

    size = {"sphere": f"{_HALF}", "box": f"{_HALF} {_HALF} {_HALF}", "cylinder": f"{_HALF} {_HALF}"}[kind]
    bodies = "".join(
        f'<body pos="{x} {y} {_HALF - 1e-4}"><freejoint/><geom type="{kind}" size="{size}" mass="{_MASS}"/></body>'
        for x, y in _places(count)
    )
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.001" integrator="implicitfast" gravity="0 0 -9.81"/><size memory="512M"/>'
        '<worldbody><geom type="plane" size="50 50 1"/><body mocap="true" pos="0 0 0.0495">'
        f'<geom type="sphere" size="0.01"/></body>{bodies}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)

    def step() -> None:
        data.mocap_pos[0] = (0.004 * np.sin(2.0 * np.pi * data.time), 0.0, 0.0495)
        mujoco.mj_step(model, data)

    return _time_us(step, count)


def _bullet_us(kind: str, count: int) -> float:
    import pybullet as bullet

    bullet.connect(bullet.DIRECT)
    try:
        bullet.setGravity(0, 0, -9.81)
        bullet.setTimeStep(1e-3)
        bullet.createMultiBody(0, bullet.createCollisionShape(bullet.GEOM_PLANE))
        ball = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=0.01)
        probe = bullet.createMultiBody(0, ball, basePosition=[0, 0, 0.0495])
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
            ticks[0] += 1
            place = (0.004 * np.sin(2e-3 * np.pi * ticks[0]), 0.0, 0.0495)
            bullet.resetBasePositionAndOrientation(probe, place, (0, 0, 0, 1))
            bullet.stepSimulation()

        return _time_us(step, count)
    finally:
        bullet.disconnect()


def _measured_or_quoted(
    measure: Callable[[str, int], float], quoted: dict[str, tuple[float | None, ...]], work: str, count: int
) -> tuple[str, float | None]:
    kind = work.removeprefix("bodies ")
    if kind not in quoted or count not in _COUNTS:
        return "", None
    try:
        return "measured", measure(kind, count)
    except ImportError:
        return "quoted", quoted[kind][_COUNTS.index(count)]


def _mujoco(work: str, count: int) -> tuple[str, float | None]:
    return _measured_or_quoted(_mujoco_us, _MUJOCO, work, count)


def _bullet(work: str, count: int) -> tuple[str, float | None]:
    return _measured_or_quoted(_bullet_us, _BULLET, work, count)


PEERS: dict[str, Callable[[str, int], tuple[str, float | None]]] = {"MuJoCo": _mujoco, "Bullet": _bullet}
"""Peer -> (how its figure was got, cost [us]) of a workload of bodies; None where there is none."""
