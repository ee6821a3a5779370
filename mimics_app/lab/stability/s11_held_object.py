"""S11: an object held by friction for a minute: its creep, and whether the force remains in the friction cone.

The load stays below mu F_N and trembles by a tenth. Regularised friction (4.3.2 with the right sign) is a damper of
mu F_N / v_th below its threshold, hence creeps v_th F / (mu F_N): F for the mean load. Karnopp and the anchor of
Hayward and Armstrong hold. LuGre holds a constant load, and creeps under a trembling one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.groups.friction import KARNOPP, NUMBERS, friction_by
from mimics_app.lab.haptic.friction_laws import Bristles
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION
from mimics_app.rendering.haptic.kernels.integrators import step_semi_implicit

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import FrictionRecord, Table

__all__ = ["EXPERIMENT", "cone_excess", "hold"]


_MODELS = ("regularised", "Karnopp", "Hayward-Armstrong", "LuGre explicit", "LuGre implicit")

_MASS = 3.0  # of the body [kg]
_MU = 0.4  # coefficient of friction [-]
_NORMAL = 30.0  # normal force [N]
_CONE = _MU * _NORMAL
_THRESHOLD = 0.01  # speed below which the regularised model is a damper [m/s]
_STIFFNESS = 2e4  # of the bristles [N/m]
_BRISTLE_DAMPING = 100.0  # [N s/m]
_DT = 1e-3  # tick [s]
_SETTLING_S = 1.0  # time in which the load rises [s]
_SECONDS = 61.0  # length of a run [s]
_TREMOR = 0.1  # amplitude of the tremor, as a share of the load
_TREMOR_HZ = 2.0  # its frequency [Hz]
_HELD_M = 1e-6  # creep of a body that is held, at most [m]
_CONE_ROUNDING = 1e-12  # excess over the cone that is rounding [-]

_PUSH_BACK = 1e3
"""Load on the held object per speed [N s/m], which determines the direction of friction."""


@kernel
def _friction(number: int, x: Vec, v: Vec, load: Vec, dt: float, state: FrictionRecord, out: Vec) -> None:
    """Force of a law with the coefficients of this experiment."""
    numbers = Bristles(_MU, _MU, _THRESHOLD, _STIFFNESS, _BRISTLE_DAMPING)
    friction_by(number, x, v, load, _NORMAL, numbers, dt, state, out)


@kernel
def _hold(number: int, share: float, seconds: float, dt: float, states: Table[FrictionRecord], out: Vec) -> None:
    """out: mean place in the last second less that in the first after settling [m], largest friction / cone - 1."""
    x, v, load, force = np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1)
    settling = round(_SETTLING_S / dt)
    ticks = settling + round(seconds / dt)
    window = round(1.0 / dt)
    crept_by = 0.0
    for i in range(ticks):
        t = i * dt
        rise = 0.5 * (1.0 - math.cos(math.pi * t / _SETTLING_S)) if i < settling else 1.0
        tremor = _TREMOR * math.sin(2.0 * math.pi * _TREMOR_HZ * t) if i >= settling else 0.0
        load[0] = share * _CONE * (rise + tremor)
        _friction(number, x, v, load, dt, states[0], force)
        out[1] = max(out[1], abs(force[0]) / _CONE - 1.0)
        if number == KARNOPP and states[0].sticking:
            v[0] = 0.0
        x[0], v[0] = step_semi_implicit(x[0], v[0], load[0] + force[0], _MASS, 0.0, 0.0, dt)
        if i >= ticks - window:
            crept_by += x[0] / window
        if settling <= i < settling + window:
            crept_by -= x[0] / window
    out[0] = crept_by


@kernel
def _excess(number: int, ticks: int, dt: float, path: Vec, states: Table[FrictionRecord]) -> float:
    """Largest friction as a share of the cone - 1 along a prescribed path [m]."""
    v, load, force = np.zeros(1), np.zeros(1), np.zeros(1)
    worst = -1.0
    for i in range(1, ticks):
        v[0] = (path[i] - path[i - 1]) / dt
        load[0] = _PUSH_BACK * v[0]
        _friction(number, path[i : i + 1], v, load, dt, states[0], force)
        worst = max(worst, abs(force[0]) / _CONE - 1.0)
    return worst


def hold(model: str, share: float, seconds: float = _SECONDS) -> tuple[float, float]:
    """Hold 3 kg against a mean load of `share` mu F_N, after a second at rest.

    Returns:
        (distance crept from the mean of the first second to that of the last [m], how far the friction left its cone at
        most, as a share of mu F_N).
    """
    out = np.array([0.0, -1.0])
    _hold(NUMBERS[model], share, seconds, _DT, np.zeros(1, FRICTION), out)
    return float(out[0]), max(0.0, float(out[1]))


def cone_excess(model: str) -> float:
    """How far friction leaves its cone along a path of many reversals of up to 0.5 m/s, as a share of mu F_N."""
    t = _DT * np.arange(20_000)
    path = 0.05 * np.sin(2.0 * np.pi * 1.0 * t) + 0.01 * np.sin(2.0 * np.pi * 3.7 * t)
    return max(0.0, float(_excess(NUMBERS[model], len(path), _DT, path, np.zeros(1, FRICTION))))


def _exact_creep(share: float, seconds: float) -> float:
    """Distance [m] that the regularised law creeps under a mean load of `share` mu F_N: v_th share (seconds - 1)."""
    return _THRESHOLD * share * (seconds - 1.0)


def _holds(crept: dict[str, list[tuple[float, float]]], cones: dict[str, float]) -> bool:
    """Whether the laws that hold do hold, and those with a cone stay in it."""
    stays = all(abs(crept_by) < _HELD_M for model in ("Karnopp", "Hayward-Armstrong") for crept_by, _ in crept[model])
    inside = all(
        max(cones[model], *(excess for _, excess in crept[model])) <= _CONE_ROUNDING
        for model in ("regularised", "Karnopp", "Hayward-Armstrong")
    )
    return stays and inside


def _simulate_grid(points: int) -> Outcome:
    shares = [float(share) for share in np.linspace(0.1, 0.85, max(points, 2))]
    crept = {model: [hold(model, share) for share in shares] for model in _MODELS}
    cones = {model: cone_excess(model) for model in _MODELS}
    rows = [
        {
            "load_share": share,
            "method": model,
            "crept_mm": 1e3 * crept[model][i][0],
            "exact_mm": 1e3 * _exact_creep(share, _SECONDS) if model == "regularised" else None,
            "cone_excess_held": crept[model][i][1],
            "cone_excess_sliding": cones[model],
        }
        for i, share in enumerate(shares)
        for model in _MODELS
    ]

    def curve(model: str) -> Points:
        # Zero is drawn as 1 nm on the logarithmic axis.
        return [(share, max(1e-6, 1e3 * abs(off))) for share, (off, _) in zip(shares, crept[model], strict=True)]

    simulated = curve("regularised")
    exact = [(share, 1e3 * _exact_creep(share, _SECONDS)) for share in shares]
    half = min(range(len(shares)), key=lambda i: abs(shares[i] - 0.5))
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={model: curve(model) for model in _MODELS[1:]},
        holds=_holds(crept, cones),
        note=(
            f"In a minute at {100 * shares[half]:.0f} % of the cone: regularised "
            f"{1e3 * crept['regularised'][half][0]:.0f} mm, LuGre {1e3 * crept['LuGre implicit'][half][0]:.2g} mm, "
            f"Hayward-Armstrong {1e3 * abs(crept['Hayward-Armstrong'][half][0]):.1g} mm, Karnopp 0 mm. Sliding, "
            f"explicit LuGre leaves the cone by {100 * cones['LuGre explicit']:.3g} %, implicit by "
            f"{100 * cones['LuGre implicit']:.3g} %."
        ),
    )


EXPERIMENT = Experiment(
    title="An object held by friction: who lets it creep",
    claim=(
        "Regularised friction creeps v_th F/(mu F_N) (to 0.5 %); Karnopp and Hayward-Armstrong hold within 1 um and "
        "never leave the cone."
    ),
    x_label="mean load / (mu F_N)",
    y_label="crept in a minute [mm]",
    kind="invariant",
    simulate=_simulate_grid,
    tolerance=5e-3,
    log_y=True,
)
