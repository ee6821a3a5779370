"""How the robot comes to a trial's start is the scene's to choose: straight, or the seed's way through the joints."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.unit_array import Table

SCENE = Path(__file__).parents[2] / "scenes" / "examples" / "guided_path.json"


def _way_to_the_start(folder: Path, form: str) -> Table:
    """The ticks while the hand is driven; the robot's frame is turned only."""
    document = json.loads(SCENE.read_text(encoding="utf-8"))
    robot = next(entity for entity in document["entities"] if entity["id"] == "robot")
    robot.setdefault("components", {})["world_pd"] = {"kp": [4.0], "kd": [0.1], "form": form}
    file = folder / f"{form}.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with mimics.open(file, record="memory") as session:
        session.step(2.0)
    return session.haptic


def _bow(points: np.ndarray) -> float:
    """Largest distance from the chord of a way, as a share of it."""
    moved = np.linalg.norm(points - points[0], axis=1) > 1e-3
    start, end = points[0], points[moved][-1]
    along = (end - start) / np.linalg.norm(end - start)
    off = (points - start) - np.outer((points - start) @ along, along)
    return float(np.linalg.norm(off, axis=1).max() / np.linalg.norm(end - start))


@pytest.mark.parametrize(("form", "straight_in"), [("straight", "hip_world"), ("joints", "q")])
def test_the_way_is_straight_where_the_form_says(tmp_path: Path, form: str, straight_in: str):
    samples = _way_to_the_start(tmp_path, form)
    bows = {"hip_world": _bow(samples["hip_world"]), "q": _bow(samples["q"][:, :3] * [1.0, 0.46, 1.0])}
    other = "q" if straight_in == "hip_world" else "hip_world"
    assert bows[straight_in] < 0.5 * bows[other], bows
