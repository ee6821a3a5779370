"""Features of people of another make than the product's: own kinetics, and kinds that differ in heart, skin and breath.

No constant is shared with `inputs/physio/simulated` or `estimation`: the heart follows work in two components of its
own time constants and saturates, arousal shows in the number of skin responses, in their level, or hardly.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from mimics_app.contracts.messages.stage_messages import FeatureFrame, UserState
from mimics_app.estimation.fusion import FusionEstimation

KINDS = ("plain", "level of the skin", "quiet skin", "blocked heart", "turned heart")
GOOD = {"ecg": 1.0, "gsr": 1.0, "resp": 1.0}


class OwnPerson:
    """One person.

    Args:
        seed: Draws the person, and what is random in their features.
    """

    def __init__(self, seed: int) -> None:
        rng = self._rng = np.random.default_rng([seed, 77])
        self.kind = KINDS[seed % len(KINDS)]
        self._rest, self._variability, self._breath = rng.uniform(58, 84), rng.uniform(20, 60), rng.uniform(11, 19)
        turned = {"blocked heart": rng.uniform(0.1, 0.3), "turned heart": -0.8}.get(self.kind, 1.0)
        self._heart = rng.uniform(6, 18) * turned
        self._work, self._most_work = rng.uniform(7, 19), rng.uniform(0.8, 1.6)
        self._fast_s, self._slow_s, self._fast = rng.uniform(8, 25), rng.uniform(60, 120), rng.uniform(0.3, 0.8)
        self._lag_s = rng.uniform(3, 15)
        self._responses, self._level = rng.uniform(0.8, 3.5), rng.uniform(2.5, 14)
        more, rise = rng.uniform(5, 15), rng.uniform(0.05, 0.25)
        self._more = {"level of the skin": 0.2 * more, "quiet skin": 0.3 * more}.get(self.kind, more)
        self._rise = {"level of the skin": 1.5 * rise, "quiet skin": 0.3 * rise}.get(self.kind, rise)
        self._calm, self._calm_work = rng.uniform(0.2, 0.5), rng.uniform(0.2, 0.4)
        self._sighs = {"quiet skin": -0.1}.get(self.kind, rng.uniform(0.0, 0.3))

    def features(
        self, seconds: int, arousal: Callable[[int], float], power: Callable[[int], float]
    ) -> list[tuple[FeatureFrame, float]]:
        """Frames of features, one a second, each with the true arousal, for an arousal aimed at and a power [W]."""
        rng, counts, found = self._rng, deque[float](maxlen=60), []
        true = felt = fast = slow = heart = steps = drift = 0.0
        for second in range(seconds):
            true += (arousal(second) - true) / 8.0
            felt += (true - felt) / self._lag_s
            fast += (power(second) - fast) / self._fast_s
            slow += (power(second) - slow) / self._slow_s
            work = self._most_work * np.tanh((self._fast * fast + (1.0 - self._fast) * slow) / self._most_work)
            heart += -heart / 12.0 + 0.8 * rng.standard_normal()
            steps += -steps / 30.0 + 0.03 * rng.standard_normal()
            drift += 0.006 * np.sqrt(self._level) * rng.standard_normal()
            counts.append(float(rng.poisson(max(self._responses + self._more * true, 0.2) / 60.0)))
            quiet = 1.0 - self._calm * max(felt, -0.3) - self._calm_work * min(work, 1.0)
            values = {
                "heart_rate": self._rest + self._heart * felt + self._work * work + heart,
                "scl": self._level * (1.0 + self._rise * true) + drift,
                "breath_rate": self._breath * (1.0 + self._sighs * felt + 0.3 * work),
                "hand_power": power(second),
            }
            if second > 25:
                values["scr_rate"] = 60.0 * sum(counts) / len(counts)
                values["rmssd"] = self._variability * max(quiet, 0.15) * (1.0 + steps)
            found.append((FeatureFrame(second * 10**9, values, GOOD), true))
        return found


def states_of(frames: list[tuple[FeatureFrame, float]]) -> list[tuple[UserState, float]]:
    """The estimated state of each second, with the true arousal."""
    estimation = FusionEstimation(60.0)
    return [(estimation.update(frame), true) for frame, true in frames]
