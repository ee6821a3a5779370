"""The Kalman policy against the same filter in its other form, by precisions, over the same trials."""

from __future__ import annotations

import numpy as np
import pytest

from mimics_app.learning.policies import rules
from mimics_app.learning.policies.rules import KalmanSkill
from mimics_app.learning.policy import Outcome

SLOPE, ODDS = 10.0, np.log(0.7 / 0.3)


class ByPrecision:
    """The demand of 70 % success and its precision; each view adds its own precision, once."""

    def __init__(self, demand: float) -> None:
        self.demand, self.precision = demand, 1.0 / rules._FIRST_SPREAD**2
        self.product = self.loads = self.aways = 0.0

    def see(self, view: float, deviation: float) -> None:
        added = 1.0 / deviation**2
        self.demand = (self.precision * self.demand + added * view) / (self.precision + added)
        self.precision += added

    def trial(self, demand: float, success: float, load: float, variance: float) -> None:
        self.precision = 1.0 / (1.0 / self.precision + rules._WALK**2)
        away = (np.log(success / (1.0 - success)) - ODDS) / SLOPE
        self.see(demand + away, rules._EXTREME_VIEW if abs(success - 0.5) > 0.4 else rules._VIEW)
        if np.isnan(load):
            return
        self.product = rules._KEPT * self.product - load * away
        self.loads, self.aways = rules._KEPT * self.loads + load**2, rules._KEPT * self.aways + away**2
        record = min(max(self.product / np.sqrt(self.loads * self.aways + 1e-9), 0.0), 1.0)
        if record > rules._LEAST_RECORD:
            deviation = np.sqrt(rules._LOAD_VIEW**2 + 0.09 * variance) / record
            self.see(demand - rules._LOAD_GAIN * min(max(load, -0.9), 0.9), deviation)


@pytest.mark.parametrize("loaded", [True, False], ids=["with loads", "without"])
def test_each_view_of_a_trial_counts_once(loaded: bool) -> None:
    rng, other, policy = np.random.default_rng(5), ByPrecision(0.5), KalmanSkill(slope=SLOPE)
    policy.begin(np.array([0.5]), np.random.default_rng(1))
    used = 0
    for _ in range(30):
        demand = float(policy.act().demand[0])
        success = float(rng.integers(1, 10)) / 10.0
        load = (0.7 - success) + 0.1 * float(rng.standard_normal()) if loaded else np.nan
        policy.learn(Outcome(*(np.array([x]) for x in (demand, success, load, 0.1, success))))
        before = other.precision
        other.trial(demand, success, load, 0.1)
        used += other.precision > before
        assert other.demand == pytest.approx(float(policy.act().demand[0]), abs=1e-12)
        assert 1.0 / other.precision == pytest.approx(float(policy._variance[0]), rel=1e-9)
        assert 0.0 < other.demand < 1.0, "no limit hides a difference"
    assert used > 1
    assert (other.loads > 0.1) is loaded
