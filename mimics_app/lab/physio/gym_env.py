"""Gymnasium environment: a task with a simulated person; a step is a trial, an episode a session.

Needs the extra `learning`. Simulation is not clinical evidence.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.inputs.physio.simulated.person import LatentPeople, draw_traits
from mimics_app.lab.physio.simulated_task import draw_success
from mimics_app.learning.goals import success_reward
from mimics_app.learning.policy import TARGET

__all__ = ["TrainingEnv"]

_TRIAL_S = 20.0
_STEP_S = 5.0
"""Length of a trial, and step of the latent state [s]."""
_POWER_W = 0.3
"""Mechanical power of the arm [W]."""
_DEFAULT = ActionSpace([Parameter("difficulty", 0.5, 0.0, 1.0, harder=1)])


def _gym_space(space: ActionSpace) -> spaces.Dict:
    """Return the parameters as a Dict: Discrete for stepped ones, else a Box."""
    parts: dict[str, spaces.Space[Any]] = {}
    for parameter in space:
        if parameter.step > 0.0:
            parts[parameter.name] = spaces.Discrete(round((parameter.high - parameter.low) / parameter.step) + 1)
        else:
            low, high = np.float32(parameter.low), np.float32(parameter.high)
            parts[parameter.name] = spaces.Box(low, high, (1,), np.float32)
    return spaces.Dict(parts)


class TrainingEnv(gymnasium.Env[NDArray[np.float32], dict[str, Any]]):
    """Sessions of a new person each.

    The observation is demand, success, and heart rate and SCR rate relative to rest, both divided by ten; the reward is
    1 at 70 % success and falls to -1.

    Args:
        space: Parameters of the task; those with `harder` determine the demand.
        trials: Number of trials of a session.
    """

    metadata = {"render_modes": []}  # noqa: RUF012  gymnasium's own form

    def __init__(self, space: ActionSpace = _DEFAULT, trials: int = 40) -> None:
        self._space, self._trials = space, trials
        self.action_space = _gym_space(space)
        low, high = np.array([0, 0, -10, -10], np.float32), np.array([1, 1, 10, 10], np.float32)
        self.observation_space = spaces.Box(low, high, dtype=np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a session of another person."""
        super().reset(seed=seed)
        self._people = LatentPeople(draw_traits(self.np_random, 1))
        self._success = draw_success(self.np_random, 1)
        self._trial = 0
        return self._see(0.5, TARGET), {}

    def step(self, action: dict[str, Any]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Simulate a trial."""
        demand = self._space.demand(self._values(action))
        demand = 0.5 if demand is None else demand
        demands = np.array([demand])
        gap = self._people.gap(demands)
        for _ in range(round(_TRIAL_S / _STEP_S)):
            self._people.step(_STEP_S, demands, np.full(1, _POWER_W), np.ones(1))
        share = float(self._success.share(gap, self.np_random)[0])
        self._trial += 1
        return self._see(demand, share), float(success_reward(share)), False, self._trial >= self._trials, {}

    def _values(self, action: dict[str, Any]) -> dict[str, float]:
        values = {}
        for parameter in self._space:
            chosen = action[parameter.name]
            stepped = parameter.step > 0.0
            value = parameter.low + int(chosen) * parameter.step if stepped else float(np.asarray(chosen).ravel()[0])
            values[parameter.name] = parameter.clip(value)
        return values

    def _see(self, demand: float, success: float) -> NDArray[np.float32]:
        drive, traits, rng = self._people.drive(np.zeros(1)), self._people.traits, self.np_random
        heart = (drive.heart_rate[0] - traits.heart_rest[0] + 2.0 * rng.standard_normal()) / 10.0
        skin = (drive.responses[0] - traits.responses[0] + 1.0 * rng.standard_normal()) / 10.0
        seen = np.array([demand, success, heart, skin], np.float32)
        return np.clip(seen, self.observation_space.low, self.observation_space.high)  # type: ignore[attr-defined]
