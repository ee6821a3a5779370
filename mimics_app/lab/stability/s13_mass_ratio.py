"""S13: a heavy body on a light one: the smallest stable mass of the lighter one.

The rule m > n (h^2 k + 2 h b) / 4 counts the contacts n of a body and takes its partners as fixed. It is exact at both
ends of the map, where one of the two is very heavy; two equal bodies need 31 % more, because they oscillate in opposite
phase.
"""

from __future__ import annotations

import numpy as np

from mimics_app.lab.experiment import Experiment, Outcome, Points
from mimics_app.lab.stability.stack import UNIT_MASS, smallest_mass, stack_eigenvalue
from mimics_app.rendering.haptic.kernels.contact_law import pair_force

__all__ = ["EXPERIMENT"]


def _lighter(ratio: float, unit: float) -> float:
    """Return the mass of the lighter body [g]; the lower one has `unit` kg, the upper one `ratio` times that."""
    return 1e3 * unit * min(1.0, ratio)


def _simulate_grid(points: int) -> Outcome:
    ratios = [float(ratio) for ratio in sorted({*np.geomspace(0.01, 1000.0, points).tolist(), 1.0})]
    simulated: Points = []
    exact: Points = []
    for ratio in ratios:
        relative = np.array([1.0, ratio])
        simulated.append((ratio, _lighter(ratio, smallest_mass(pair_force, relative))))
        exact.append((ratio, _lighter(ratio, stack_eigenvalue(relative) * UNIT_MASS)))
    rules = {
        "1 contact": [(ratio, 1e3 * UNIT_MASS) for ratio in ratios],
        "2 contacts": [(ratio, 2e3 * UNIT_MASS) for ratio in ratios],
    }
    rows = [
        {"upper_to_lower": s[0], "simulated_g": s[1], "exact_g": e[1], "rule_2_error": 2e3 * UNIT_MASS / e[1] - 1.0}
        for s, e in zip(simulated, exact, strict=True)
    ]
    equal = dict(exact)[1.0]
    return Outcome(
        rows=rows,
        simulated=simulated,
        exact=exact,
        rules=rules,
        note=(
            f"Contacts of 2 kN/m and 4 N s/m at 1 ms. Two equal bodies need {equal:.2f} g each, "
            f"{equal / (2e3 * UNIT_MASS):.2f} times the rule for two contacts."
        ),
    )


EXPERIMENT = Experiment(
    title="Heavy on light: the smallest mass that keeps still",
    claim="The pair law (17) keeps a stack of two still down to the mass that the eigenvalues of the stack give.",
    x_label="mass of the upper body / mass of the lower",
    y_label="smallest mass of the lighter one [g]",
    kind="boundary",
    simulate=_simulate_grid,
    log_x=True,
)
