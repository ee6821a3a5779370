"""S13B: a stack of equal bodies: the smallest stable mass grows with the height, to twice the rule for two contacts.

Each inner body has n = 2 contacts, with partners in opposite phase: the stiffness matrix of a stack of N has the
largest eigenvalue 4 sin^2((2N - 1) pi / (4N + 2)) in closed form, which tends to 4.
"""

from __future__ import annotations

import math

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.stability.stack import UNIT_MASS, smallest_mass
from mimics_app.rendering.haptic.kernels.contact_law import pair_force

__all__ = ["EXPERIMENT", "tallest_mode"]


def tallest_mode(bodies: int) -> float:
    """Return the largest eigenvalue of a stack of equal bodies, for k = 1 N/m and m = 1 kg."""
    return 4.0 * math.sin((2 * bodies - 1) * math.pi / (4 * bodies + 2)) ** 2


def _simulate_grid(points: int) -> Outcome:
    heights = sorted({round(n) for n in np.geomspace(1.0, 16.0, max(points, 2))})
    simulated: Points = [(float(n), 1e3 * smallest_mass(pair_force, np.ones(n))) for n in heights]
    exact: Points = [(float(n), 1e3 * UNIT_MASS * tallest_mode(n)) for n in heights]
    tallest = exact[-1][1] / (2e3 * UNIT_MASS)
    return Outcome(
        rows=[{"bodies": s[0], "simulated_g": s[1], "exact_g": e[1]} for s, e in zip(simulated, exact, strict=True)],
        simulated=simulated,
        exact=exact,
        rules={
            "2 contacts": [(float(n), 2e3 * UNIT_MASS) for n in heights],
            "2 contacts, reduced mass": [(float(n), 4e3 * UNIT_MASS) for n in heights],
        },
        note=(
            f"{heights[-1]} bodies need {tallest:.2f} times the mass of the rule for two contacts; with the reduced "
            f"mass of a pair in the rule it is safe for any height."
        ),
    )


EXPERIMENT = Experiment(
    title="Stacked bodies: the smallest mass that keeps still",
    claim="The pair law (17) keeps N equal bodies still down to 4 sin^2((2N-1) pi/(4N+2)) (h^2 k + 2 h b)/4 each.",
    x_label="bodies in the stack",
    y_label="smallest mass of each [g]",
    kind="boundary",
    simulate=_simulate_grid,
)
