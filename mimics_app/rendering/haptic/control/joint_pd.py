"""Joint space PD controller (D2.1 4.2.5, equation 5), with the sign that converges."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec

__all__ = ["joint_pd"]


@kernel
def joint_pd(q: Vec, dq: Vec, target: Vec, kp: Vec, kd: Vec, command: Vec) -> None:
    """Joint velocity command = Kp (q_r - q) - Kd dq/dt, per joint; vectors are as long as `command` or longer.

    Equation 5 prints Kp (q - q_r): positive feedback, whose error grows as exp(Kp t / (1 + Kd)).
    The output is a velocity, so Kp is in 1/s and Kd dimensionless. With an ideal servo the time
    constant of a step is (1 + Kd) / Kp and the lag behind a ramp of speed v is v (1 + Kd) / Kp. With a servo delay of
    one tick T it is stable iff Kp > 0, Kd > -1 and Kp T + 2 Kd < 2.
    """
    for i in range(command.shape[0]):
        command[i] = kp[i] * (target[i] - q[i]) - kd[i] * dq[i]
