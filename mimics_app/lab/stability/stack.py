"""Stability of a stack of bodies on a floor under a preload, by the pair law of the loop.

One dimension, closed contacts, semi-implicit Euler. With proportional damping the modes decouple: the stack is stable
iff lambda (h^2 k + 2 h b) / 4 < m for the largest eigenvalue lambda of its stiffness matrix, for k = 1 N/m and divided
by the masses in units of m. A body between n fixed ones has lambda = n.
"""

from __future__ import annotations

import numpy as np
from numba import types

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.stability.laws import NORMAL_LAW, NormalLaw
from mimics_app.lab.stability.linear import find_limit
from mimics_app.rendering.haptic.kernels.contact_law import pair_damping, pair_stiffness
from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit

__all__ = ["DT", "PAIR_B", "PAIR_K", "UNIT_MASS", "keeps_still", "smallest_mass", "stack_eigenvalue"]


DT = 1e-3
_K, _B = 4000.0, 8.0
PAIR_K: float = pair_stiffness(_K, _K)
"""Stiffness of every contact [N/m]: two equal bodies, or a body on a floor of its own kind."""

PAIR_B: float = pair_damping(_K, _B, _K, _B)
"""Damping of every contact [N s/m]."""

UNIT_MASS = (DT**2 * PAIR_K + 2.0 * DT * PAIR_B) / 4.0
"""Smallest stable mass for lambda = 1, one contact with a fixed body [kg]."""

_PRELOAD = 1e-3
_NUDGE = 1e-10
_LOST = 1e4
_TICKS = 4000


@typed_kernel(
    types.float64(
        NORMAL_LAW, types.float64[::1], types.float64[::1], types.float64, types.float64, types.int64, types.float64
    )
)
def _shake(law: NormalLaw, masses: Vec, nudge: Vec, k: float, b: float, ticks: int, dt: float) -> float:
    """Displace each body and release it; return the largest deviation of any [m]."""
    n = masses.shape[0]
    x = nudge.copy()
    v = np.zeros(n)
    push = np.zeros(n + 1)
    push[n] = k * _PRELOAD
    worst = 0.0
    for _ in range(ticks):
        below, v_below = 0.0, 0.0
        for i in range(n):
            push[i] = law(_PRELOAD + below - x[i], v_below - v[i], k, b)
            below, v_below = x[i], v[i]
        for i in range(n):
            x[i], v[i] = step_semi_implicit(x[i], v[i], push[i] - push[i + 1], masses[i], 0.0, 0.0, dt)
            worst = max(worst, abs(x[i]))
        if not worst < _PRELOAD:
            return worst
    return worst


def keeps_still(law: NormalLaw, masses: Vec, dt: float = DT) -> bool:
    """Whether a displacement of 0.1 nm never grows ten thousandfold in 4000 ticks.

    Args:
        law: Pair law, e.g. `contact_law.pair_force`.
        masses: Masses from the floor upwards [kg], shape [n].
        dt: Tick [s].
    """
    nudge = _NUDGE * (1.0 - 2.0 * (np.arange(len(masses)) % 2)) * np.linspace(1.0, 0.7, len(masses))
    return bool(
        _shake(law, np.ascontiguousarray(masses, np.float64), nudge, PAIR_K, PAIR_B, _TICKS, dt) < _LOST * _NUDGE
    )


def smallest_mass(law: NormalLaw, relative: Vec) -> float:
    """Return the smallest stable m of a stack of masses m * relative [kg]; inf where none is stable."""
    light, heavy = 0.1 * UNIT_MASS / float(np.min(relative)), 100.0 * UNIT_MASS / float(np.min(relative))
    if not keeps_still(law, heavy * relative):
        return float("inf")
    return find_limit(lambda unit: keeps_still(law, unit * relative), heavy, light)


def stack_eigenvalue(relative: Vec) -> float:
    """Return the largest eigenvalue lambda of the stack's stiffness per mass, for k = 1 N/m and m = 1 kg."""
    n = len(relative)
    stiffness = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiffness[-1, -1] = 1.0
    root = np.sqrt(relative)
    return float(np.linalg.eigvalsh(stiffness / np.outer(root, root))[-1])
