"""The simulated patients in the wavy tunnel: who is more impaired is slower, farther off and touches more."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.tunnel_play import SCENE, travel

PRESETS = ("healthy", "moderate", "severe")


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tunnel without whoever stands beside it: looked at, never felt, and half of the work of a frame."""
    document = json.loads(SCENE.read_text(encoding="utf-8"))
    document["entities"] = [entity for entity in document["entities"] if entity["id"] != "encourager"]
    file = tmp_path_factory.mktemp("alone") / SCENE.name
    file.write_text(json.dumps(document), encoding="utf-8")
    return file


@pytest.fixture(scope="module", params=[8, pytest.param(20, marks=pytest.mark.slow)], ids="{} seeds".format)
def outcomes(request: pytest.FixtureRequest, alone: Path) -> dict[str, list[dict[str, Any]]]:
    """Rows of the trials with `samples`, the hash of every tick of a run."""
    return {preset: [once(preset, seed, alone) for seed in range(1, request.param + 1)] for preset in PRESETS}


def once(preset: str, seed: int, scene: Path = SCENE) -> dict[str, Any]:
    play = travel(preset, seed, scene=scene)
    ticks = b"".join(column.tobytes() for column in play.samples.values())
    return {**play.rows[0], "samples": hashlib.sha256(ticks).hexdigest()}


@pytest.mark.parametrize("measure", ["time_s", "path_error_rms_m", "contacts"])
def test_healthy_beats_moderate_beats_severe(outcomes, measure):
    means = [np.mean([row[measure] for row in outcomes[preset]]) for preset in PRESETS]
    assert means[0] < means[1] < means[2], f"{measure}: {means}"


def test_smoothness_falls_with_impairment(outcomes):
    """SPARC is negative and falls with every submovement; one minimum-jerk reach has about -1.4."""
    means = [np.mean([row["smoothness"] for row in outcomes[preset]]) for preset in PRESETS]
    assert means[0] > means[1] > means[2], str(means)
    assert means[0] > -2.5, "a healthy person moves in one flow"


@pytest.mark.parametrize("measure", ["time_s", "path_error_rms_m", "contacts"])
def test_the_order_holds_for_most_single_seeds_too(outcomes, measure):
    """A difference of means that one outlier makes would be worth nothing: three of four pairs must agree."""
    for better, worse in (("healthy", "moderate"), ("moderate", "severe")):
        agree = sum(a[measure] <= b[measure] for a, b in zip(outcomes[better], outcomes[worse], strict=True))
        runs = len(outcomes[better])
        assert agree >= 0.75 * runs, (
            f"{measure}: only {agree} of {runs} {better} runs are no worse than the {worse} one"
        )


@pytest.mark.parametrize("preset", PRESETS)
def test_every_run_touches_the_wall_and_reaches_the_end(outcomes, preset):
    for seed, row in enumerate(outcomes[preset], 1):
        assert row["outcome"] == "finished", f"{preset}, seed {seed}: {row['outcome']}"
        assert row["contacts"] >= 1, f"{preset}, seed {seed} never touched the wall"


@pytest.mark.parametrize("preset", PRESETS)
def test_without_intent_nobody_arrives(preset, alone):
    play = travel(preset, seed=1, intent=False, seconds=75.0, scene=alone)
    assert [row["outcome"] for row in play.rows] == ["timeout"]
    assert play.samples["progress"][-50_000:].max() < 0.2  # before it the robot was on its way to the start


def test_two_seeds_differ_and_one_repeats_itself_with_somebody_beside_it(outcomes):
    runs = [row["samples"] for row in outcomes["moderate"]]
    assert len(set(runs)) == len(runs)
    assert once("moderate", 3)["samples"] == runs[2]
