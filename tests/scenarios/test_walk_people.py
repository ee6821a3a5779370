"""Simulated patients walk all three scenes: who walks better scores more, and the figures say why."""

from __future__ import annotations

import json
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.system.resources import root
from mimics_app.tasks.kinds.canyon_walk.kind import KIND as CANYON
from mimics_app.tasks.kinds.canyon_walk.kind import CanyonWalkPlay, CanyonWalkSpec, SectionSpec
from mimics_app.tasks.kinds.city_walk.kind import KIND as CITY
from mimics_app.tasks.kinds.city_walk.kind import CityWalkPlay, CityWalkSpec
from mimics_app.tasks.kinds.kind import KindPlay, TaskKind
from mimics_app.tasks.kinds.soccer.kind import ADVICE, SoccerPlay, SoccerSpec
from mimics_app.tasks.kinds.soccer.kind import KIND as SOCCER
from mimics_app.tasks.walking.walker import PERSON

PEOPLE = ("healthy", "hemiparetic", "severe")
WALKS: Mapping[str, TaskKind] = {"city_walk": CITY, "canyon_walk": CANYON, "soccer": SOCCER}
RAISED, ASIDE, FULL_TURN = 0.1, 0.1, 1.8  # [m], [m], [rad/s] of the hand as the scenes have them


def _play(walk: str, gait: str, seed: int) -> KindPlay:
    if walk == "city_walk":
        return CityWalkPlay(CityWalkSpec("person", gait=gait), 1000.0)  # type: ignore[arg-type]
    if walk == "canyon_walk":
        way = {"": SectionSpec(22.0, 215.0)}
        return CanyonWalkPlay(CanyonWalkSpec("person", "beam", gait=gait, sections=way, width=0.4), seed)  # type: ignore[arg-type]
    return SoccerPlay(SoccerSpec("person", "ball", opponent="opponent", gait=gait), seed, advises=True)  # type: ignore[arg-type]


def _walk(walk: str, gait: str, seed: int, seconds: float) -> dict[str, float]:
    """Let the hand steer as a simulated person does; the measures of the walk."""
    play = _play(walk, gait, seed)
    play.begin_trial("", seed)
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0, q=())
    play.start_attempt(seen)  # type: ignore[arg-type]
    for _ in range(round(60 * seconds)):
        shown: Mapping[Any, Any] = play.visual
        if walk == "soccer":
            advice = shown[ADVICE]
            up, aside = RAISED * advice.speed, -ASIDE * advice.turn / FULL_TURN
            seen.grasp = 10.0 * advice.kicks
        else:
            up, aside = 0.85 * RAISED, -0.25 * shown[PERSON].x
        seen.hip_world = (min(max(aside, -ASIDE), ASIDE), up, 0.0)
        play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
        play.take_sounds()
    return {name: number for name, number in play.measures.items() if number is not None}


def _score(walk: str, row: Mapping[str, float]) -> float:
    """Weighted mean of the shares between worst and best of the parts that the shipped scene states."""
    parts = json.loads((root() / "scenes" / f"{walk}.json").read_text())["task"]["score"]
    columns = {measure.part: measure.column for measure in WALKS[walk].measures}
    shares = [
        (part["weight"], np.clip((row[columns[name]] - part["worst"]) / (part["best"] - part["worst"]), 0.0, 1.0))
        for name, part in parts.items()
        if part["weight"] and columns.get(name) in row  # no obstacles are in the way here
    ]
    return float(np.average([share for _, share in shares], weights=[weight for weight, _ in shares]))


def _means(walk: str, seeds: int, seconds: float) -> tuple[list[float], list[dict[str, float]]]:
    scores, figures = [], []
    for gait in PEOPLE:
        rows = [_walk(walk, gait, seed, seconds) for seed in range(seeds)]
        scores.append(float(np.mean([_score(walk, row) for row in rows])))
        figures.append({name: float(np.mean([row[name] for row in rows])) for name in rows[0]})
    return scores, figures


def _check(walk: str, seeds: int, seconds: float) -> None:
    scores, figures = _means(walk, seeds, seconds)
    assert scores[0] > scores[1] + 0.03 > scores[2] + 0.06, (scores, figures)
    for name in ("symmetry", "foot_clearance_m", "step_length_m"):
        healthy, hemiparetic, severe = (row[name] for row in figures)
        assert healthy > hemiparetic > severe, (name, figures)


@pytest.mark.parametrize("walk", WALKS)
def test_who_walks_better_scores_more_and_the_feet_say_why(walk: str) -> None:
    _check(walk, 1 if walk == "city_walk" else 2, 12.0)


@pytest.mark.slow
@pytest.mark.parametrize("walk", WALKS)
def test_the_same_over_twenty_seeds(walk: str) -> None:
    _check(walk, 20, 60.0)
