"""S7: gains of the joint PD controller, equation (5), for which a robot that follows one tick later is stable.

z^2 - (1 - Kp T - Kd) z - Kd = 0 has its roots inside the circle iff Kp > 0, Kd > -1 and Kp T + 2 Kd < 2. The printed
sign (Kp < 0 here) is stable nowhere. A servo with one more tick of delay reduces most of the region.
"""

from __future__ import annotations

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Mat, Vec
from mimics_app.lab.experiment import Experiment, Outcome, Points, Row
from mimics_app.lab.haptic.printed_equations import joint_pd_printed
from mimics_app.lab.stability.growth import dies_away, note_peak
from mimics_app.lab.stability.linear import find_limit, is_contracting
from mimics_app.rendering.haptic.control.joint_pd import joint_pd

__all__ = ["EXPERIMENT", "closed_limit", "exact_limit", "is_stable", "simulated_limit"]


_RATE = 1000.0
_SHORTEST = 2_000
_LONGEST = 200_000
_PRECISION = 4e-3
_LARGE = 1e6
"""Error from which the robot does not return, for an initial one of 1 m [m]."""

_LEAST = 1e-2
_MOST = 8e3


@kernel
def _follow(kp: float, kd: float, dt: float, delay: int, printed: bool, ticks: int, peaks: Vec) -> None:
    """Simulate joints with the command of 1 + delay ticks ago; peaks of the error by quarter, shape [4]."""
    q = np.ones(3)
    dq = np.zeros(3)
    target = np.zeros(3)
    gains = np.full(3, kp)
    rates = np.full(3, kd)
    line = np.zeros((delay + 1, 3))
    for i in range(ticks):
        command = line[i % (delay + 1)]
        if printed:
            joint_pd_printed(q, dq, target, gains, rates, command)
        else:
            joint_pd(q, dq, target, gains, rates, command)
        oldest = line[(i + 1) % (delay + 1)]
        for j in range(3):
            dq[j] = oldest[j]
            q[j] += dt * dq[j]
        if note_peak(max(abs(q[0]), dt * abs(dq[0])), i, ticks, _LARGE, peaks):
            return


def is_stable(kp: float, kd: float, delay: int = 0, printed: bool = False) -> bool:
    """Whether the loop is stable, by simulation; kp [1/s], kd [-], delay of the servo beyond one tick [ticks]."""

    def run(ticks: int) -> Vec:
        peaks = np.zeros(4)
        _follow(kp, kd, 1.0 / _RATE, delay, printed, ticks, peaks)
        return peaks

    return dies_away(run, _SHORTEST, _LONGEST)


def simulated_limit(kd: float, delay: int = 0) -> float:
    """Return the largest stable Kp by simulation [1/s]."""
    return find_limit(lambda kp: is_stable(kp, kd, delay), _LEAST, _MOST, _PRECISION)


def _matrix(kp: float, kd: float, delay: int) -> Mat:
    """Return one tick as a matrix on joint error and delayed commands, newest first, shape [2 + n, 2 + n]."""
    n = delay
    dt = 1.0 / _RATE
    step = np.zeros((2 + n, 2 + n))
    command = np.zeros(2 + n)
    command[0], command[1 + n] = -kp, -kd
    followed = command if n == 0 else np.eye(2 + n)[n]
    step[0] = np.eye(2 + n)[0] + dt * followed
    step[1] = command
    for i in range(2, 2 + n):
        step[i, i - 1] = 1.0
    return step


def exact_limit(kd: float, delay: int = 0) -> float:
    """Return the largest stable Kp by eigenvalues [1/s]."""
    return find_limit(lambda kp: is_contracting(_matrix(kp, kd, delay)), _LEAST, _MOST)


def closed_limit(kd: float) -> float:
    """Return the largest stable Kp of a one-tick servo, 2 (1 - Kd) / T [1/s]."""
    return 2.0 * (1.0 - kd) * _RATE


def _row(kd: float, delay: int) -> Row:
    simulated, exact = simulated_limit(kd, delay), exact_limit(kd, delay)
    return {
        "kd": kd,
        "delay_ticks": delay,
        "simulated_kp_1_s": simulated,
        "exact_kp_1_s": exact,
        "closed_kp_1_s": closed_limit(kd),
        "printed_sign_stable": is_stable(0.1 * exact, kd, delay, printed=True),
        "difference": abs(simulated / exact - 1.0),
    }


def _simulate_grid(points: int) -> Outcome:
    rows = [_row(float(kd), 0) for kd in np.linspace(-0.95, 0.95, points)]
    rows += [_row(float(kd), 1) for kd in np.linspace(-0.4, 0.6, max(3, points // 2))]
    simulated: Points = [(row["kd"], row["simulated_kp_1_s"] / _RATE) for row in rows]
    exact: Points = [(row["kd"], row["exact_kp_1_s"] / _RATE) for row in rows]
    runs_away = not any(row["printed_sign_stable"] for row in rows)
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules={"Kp T + 2 Kd = 2": [(-1.0, 4.0), (1.0, 0.0)]},
        holds=runs_away,
        note="Upper line: a robot that moves with the command of the tick before, as in the closed form. Lower line: "
        "one tick more. The sign printed in equation (5) is stable nowhere.",
    )


EXPERIMENT = Experiment(
    title="Joint PD, equation (5): stable gains",
    claim="With a servo of one tick the gains are stable iff Kp > 0, Kd > -1 and Kp T + 2 Kd < 2.",
    x_label="Kd [-]",
    y_label="largest stable Kp T [-]",
    kind="boundary",
    simulate=_simulate_grid,
)
