"""Policies of every kind, and of another package, by one conformance kit."""

from __future__ import annotations

from pathlib import Path

import pytest

from mimics_app.learning.registry import POLICIES, build_policy
from tests.support.plugin_site import write_package
from tests.support.policy_kit import check_policy

HALF = '''
"""Policies that go half of the way to the demand of full success, and the same with a fault each."""
import numpy as np
from mimics_app.learning.policy import Choice


class Half:
    follows = ("success:0.7",)

    def begin(self, start, rng):
        self.demand, self.sure = np.array(start), np.ones(len(start))
        self.rng = rng

    def act(self):
        return Choice(self.demand.copy(), self.sure)

    def learn(self, outcome):
        self.demand = np.clip(self.demand + 0.5 * np.nan_to_num(outcome.performance - 0.7), 0.0, 1.0)


class Lost(Half):
    def learn(self, outcome):
        self.demand = np.clip(self.demand + 0.5 * (outcome.performance - 0.7), 0.0, 1.0)


class Eager(Half):
    def act(self):
        return Choice(self.demand + 0.4, self.sure)


class Alike(Half):
    def act(self):
        return Choice(self.demand[:1], self.sure[:1])


class Impossible(Half):
    def act(self):
        return Choice(self.demand.copy(), 0.0 * self.sure)


class Shared(Half):
    def act(self):
        return Choice(self.demand, self.sure)

    def learn(self, outcome):
        self.demand *= 0.9


class Greedy(Half):
    def learn(self, outcome):
        outcome.performance[:] = np.nan_to_num(outcome.performance)
        super().learn(outcome)


class Silent(Half):
    follows = ()


class Dreamer(Half):
    follows = ("success:0.7", "joy")


class Unseeded(Half):
    def begin(self, start, rng):
        super().begin(start, np.random.default_rng())

    def act(self):
        return Choice(self.rng.random(len(self.demand)), self.sure)
'''
FAULTS = {
    "Lost": "whatever is unknown",
    "Eager": "a demand is 0 to 1",
    "Alike": "a row for each person",
    "Impossible": "off-policy evaluation",
    "Shared": "stays what it was",
    "Greedy": "nothing of the caller's: performance",
    "Silent": "which goals it can follow",
    "Dreamer": "which goals it can follow",
    "Unseeded": "the generator it is given",
}
GROUP = "[mimics_app.policies]\n" + "".join(f"{name.lower()} = lab_of_halves:{name}\n" for name in ("Half", *FAULTS))


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_halves", HALF, GROUP)))


@pytest.mark.parametrize("name", [*sorted(POLICIES), "half"])
def test_policy_keeps_the_contract(name: str, installed: None) -> None:
    check_policy(lambda: build_policy(name))


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_policy_is_found(name: str, installed: None) -> None:
    with pytest.raises(AssertionError, match=FAULTS[name]):
        check_policy(lambda: build_policy(name.lower()))
