"""Policy: a small step up after each good trial, a large one down after each bad one."""

from __future__ import annotations

import numpy as np

from mimics_app.learning.policy import Choice


class CalmSteps:
    """Two up, one down, in unequal steps.

    Attributes:
        follows: Goals that it can follow.
    """

    follows = ("success:0.7", "task")

    def begin(self, start, rng):
        """Begin with the demand of the scene."""
        self._demand = np.array(start, float)

    def act(self):
        """Return the demand of the next trial; it is chosen for certain."""
        return Choice(self._demand.copy(), np.ones(len(self._demand)))

    def learn(self, outcome):
        """Move by the performance of a trial; an unknown one moves nothing."""
        step = np.where(outcome.performance >= 0.7, 0.05, -0.1)
        known = np.isfinite(outcome.performance)
        self._demand = np.clip(self._demand + np.where(known, step, 0.0), 0.0, 1.0)
