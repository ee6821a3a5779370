"""Difficulty and number of trials, as the launcher and `mimics run` request them."""

from __future__ import annotations

import msgspec
import pytest

from mimics_app.tasks.tailoring import at_difficulty, with_trials
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trials import plan_trials, trial_blocks

TASK = msgspec.convert(
    {
        "parameters": {
            "radius": {"min": 0.6, "max": 1.2, "default": 1.0, "harder": -1, "maps": []},
            "obstacles": {"min": 0, "max": 4, "default": 1, "step": 1, "harder": 1, "maps": []},
            "sound": {"min": 0, "max": 1, "default": 1, "maps": []},
        },
        "trials": [
            {"name": "practice", "practice": True, "trials": [{"label": "wide", "values": {"radius": 1.2}}]},
            {"name": "travel", "order": "shuffled",
             "trials": [{"label": "a", "values": {"radius": 0.8}}, {"label": "b"}]},
        ],
    },
    TaskSpec,
)  # fmt: skip


@pytest.mark.parametrize(
    ("difficulty", "radius", "obstacles", "trial"),
    [("easier", 1.1, 0.0, 1.0), ("usual", 1.0, 1.0, 0.8), ("harder", 0.8, 2.0, 0.7)],
)
def test_what_is_harder_moves_half_way_on_its_grid(
    difficulty: str, radius: float, obstacles: float, trial: float
) -> None:
    task = at_difficulty(TASK, difficulty)  # type: ignore[arg-type]
    defaults = {name: parameter.default for name, parameter in task.parameters.items()}
    assert defaults["radius"] == pytest.approx(radius) and defaults["sound"] == 1
    assert defaults["obstacles"] in (obstacles, obstacles + 1.0)  # 0.5 and 2.5 round to either
    assert trial_blocks(task)[1].trials[0].values["radius"] == pytest.approx(trial)


def test_the_grid_begins_at_the_least_value() -> None:
    speed = {"min": 0.5, "max": 4.5, "default": 2.5, "step": 1.0, "harder": 1, "maps": []}
    task = msgspec.convert({"parameters": {"speed": speed}, "trials": [{"trials": [{"label": "a"}]}]}, TaskSpec)
    levels = ("easier", "usual", "harder")
    found = [at_difficulty(task, difficulty).parameters["speed"].default for difficulty in levels]
    assert found == [1.5, 2.5, 3.5]


@pytest.mark.parametrize("count", [1, 2, 5])
def test_so_many_trials_count_in_the_order_of_the_session(count: int) -> None:
    plan = plan_trials(trial_blocks(with_trials(TASK, count, seed=3)), seed=3)
    assert [trial.practice for trial in plan] == [True] + [False] * count
    assert [trial.block for trial in plan] == ["practice"] + ["travel"] * count
    if count == 2:
        assert [trial.label for trial in plan] == [trial.label for trial in plan_trials(trial_blocks(TASK), seed=3)]
    assert len({trial.label for trial in plan[1:3]}) == min(count, 2), "one round has every condition"


def test_none_asked_for_leaves_the_task_as_it_is() -> None:
    assert with_trials(TASK, 0, seed=1) is TASK
