"""Methods to draw a cord, with the cost of a frame and the error of its length: 1.2 m between ends 1 m apart.

Ropes of linked points are simulated for 4 s at 60 Hz from a straight line.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.lab.probe import shortest_us
from mimics_app.lab.rivals import Probes, Rival, compare
from mimics_app.maths.cord import Catenary, Ripple, Ripples, hang
from mimics_app.rendering.visual.passes.cord import CORD_BLOCK, RINGS, SIDES, fill_cord_block
from mimics_app.world.content.cords import Cord

__all__: list[str] = []


_ENDS = np.array([[0.0, 1.2, 0.0], [0.0, 1.1, -1.0]])
_LENGTH, _RADIUS = 1.2, 0.025
_POINTS, _STEP_S, _SECONDS, _GRAVITY = 32, 1.0 / 60.0, 4.0, 9.81
_RIPPLES = [Ripple(0.4, 0.5, 0.2, 0.005), Ripple(0.8, 1.0, 0.1, 0.005)]


def _link_rope(iterations: int, seconds: float = _SECONDS) -> F8:
    """Simulate a rope by position-based dynamics (Mueller 2007); return its points [m], shape [32, 3]."""
    points = np.linspace(_ENDS[0], _ENDS[1], _POINTS)
    before, rest = points.copy(), _LENGTH / (_POINTS - 1)
    for _ in range(round(seconds / _STEP_S)):
        moved = points + 0.99 * (points - before)
        moved[:, 1] -= _GRAVITY * _STEP_S**2
        before, points = points, moved
        for _ in range(iterations):
            _relax(points, rest)
    return points


def _relax(points: F8, rest: float) -> None:
    for odd in (0, 1):
        a, b = points[odd:-1:2], points[odd + 1 :: 2]
        span = b - a
        length = np.linalg.norm(span, axis=1, keepdims=True)
        shift = 0.5 * (1.0 - rest / np.maximum(length, 1e-9)) * span
        a += shift
        b -= shift
        points[0], points[-1] = _ENDS


def _polyline(points: F8) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


@cache
def _curve() -> Catenary:
    return hang(_ENDS[0], _ENDS[1], _LENGTH)


def _rope_error(iterations: int) -> float:
    return abs(_polyline(_link_rope(iterations)) - _LENGTH)


def _rope_cost(iterations: int) -> float:
    points = _link_rope(1, 0.5)

    def relax() -> None:
        for _ in range(iterations):
            _relax(points, _LENGTH / (_POINTS - 1))

    return shortest_us(relax)


def _drawn_error() -> float:
    """Return the difference of the cord and the polyline of its rings [m]."""
    return _LENGTH - _polyline(_curve().point(np.linspace(0.0, _LENGTH, RINGS)))


def _shader_cost() -> float:
    cord = Cord(_ENDS.copy(), _LENGTH, _RADIUS, taps=[(r.s, r.theta, 0.0, r.height) for r in _RIPPLES])
    data, eye, sun = np.zeros((), CORD_BLOCK), np.zeros(3), np.array([0.0, 1.0, 0.0])

    def fill() -> bytes:
        fill_cord_block(data, cord, eye, sun, 0.2)
        return data.tobytes()

    return shortest_us(fill)


def _mesh_cost() -> float:
    s, theta = np.meshgrid(np.linspace(0, _LENGTH, RINGS), np.linspace(0, 2 * np.pi, SIDES + 1), indexing="ij")
    waves = Ripples()

    def build() -> bytes:
        curve = hang(_ENDS[0], _ENDS[1], _LENGTH)
        places, normals = waves.surface(curve, _RADIUS, _RIPPLES, s.ravel(), theta.ravel())
        return np.concatenate([places, normals], axis=1).astype(np.float32).tobytes()

    return shortest_us(build)


compare(
    __name__,
    "a cord of 1.2 m, ends 1 m apart, two ripples: work of the processor a frame; error: of its length",
    "m",
    [
        Rival(
            "catenary in the shader",
            "closed form by arc length; Newton for one number a frame, 256 bytes uploaded",
            "a cord at rest or swinging as a whole; the error is that of 128 drawn rings",
            {},
            cost=_shader_cost,
            error=_drawn_error,
        ),
        Rival(
            "catenary, mesh by the processor",
            "the same surface rebuilt and uploaded every frame, 77 kB",
            "the same",
            cost=_mesh_cost,
            error=_drawn_error,
        ),
        *(
            Rival(
                f"linked points, {count} iterations" if count > 1 else "linked points, 1 iteration",
                "position-based dynamics, 32 points at 60 Hz (Mueller et al. 2007), without a tube about it",
                "any motion; stretches by the iterations it is given",
                probed=(count,),
            )
            for count in (1, 5, 20, 100)
        ),
    ],
    Probes(_rope_cost, _rope_error),
    default="catenary in the shader",
)
