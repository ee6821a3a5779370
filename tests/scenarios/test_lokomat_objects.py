"""Ordinary haptic objects at a foot in the orthosis: felt through either control, beside the hard one of its own."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root

SCENE = root() / "scenes" / "examples" / "lokomat_wall.json"
FACE, DEEP = 0.24, 0.06
"""Near side and depth of the box [m]."""

SOFT = {"mass": 10.0, "enable_translation": False, "enable_rotation": False, "stiffness": 1500.0, "damping": 10.0}


def _pressed(tmp_path: Path, name: str, *, soft: bool) -> tuple[np.ndarray, np.ndarray]:
    """Place of the left foot and force of the loop's objects on it, forward [m, N], while the person reaches behind."""
    document = json.loads(SCENE.read_text(encoding="utf-8"))
    parts = {entity["id"]: entity for entity in document["entities"]}
    parts["robot"]["components"]["controller"] = {"name": name, "parameters": {"object_kind": 0}}
    parts["wall"]["transform"]["translation"][0] = FACE + 0.5 * DEEP
    parts["beyond"]["transform"]["translation"][0] = FACE + 0.05
    if soft:
        parts["wall"]["components"]["haptic_object"] = SOFT
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with mimics.open(file, runs=tmp_path) as session:
        session.step(12.0)
        folder = session.run_dir
    haptic = mimics.load(folder).haptic
    assert np.asarray(haptic["state"])[-1] == SafetyState.ACTIVE and not np.asarray(haptic["cause"]).any()
    return np.asarray(haptic["hip_world"])[:, 0], np.asarray(haptic["f_user_world"])[:, 0]


@pytest.mark.parametrize("name", ["lokomat_impedance", "lokomat_combined"])
def test_a_soft_box_is_felt_at_the_foot_through_either_control(tmp_path: Path, name: str) -> None:
    free, nothing = _pressed(tmp_path, name, soft=False)
    x, force = _pressed(tmp_path, name, soft=True)
    assert not nothing.any() and free.max() > FACE + 0.02, "without it the foot reaches behind its face"
    assert force.min() < -5.0 and force.max() <= 1.0, "it pushes the foot back"
    deepest = x.max() - x[np.flatnonzero(force)[0]]
    assert x.max() < free.max() - 0.01
    assert -force.min() == pytest.approx(1500.0 * deepest, rel=0.35), "a spring, with its damper"
