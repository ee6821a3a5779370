"""Hard objects of the gait orthosis that a scene names by an entity: cut, checked, and felt at the foot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.cli import main
from mimics_app.app.scenes.loading import check_scene, read_scene
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.devices.hard_object import hard_object_values
from mimics_app.world.components.robot import Controller, Robot

SCENE = root() / "scenes" / "examples" / "lokomat_wall.json"
FACE, HEIGHT, LEAN = 0.24, 0.3, 0.2
"""Where the leaning face is at a height above the ground [m, m], and how far it leans back [rad]."""

LEANING = {"shape": "box", "size": [0.3, 0.6, 0.5]}
HIPS = 1.0475


def _scene(folder: Path, controller: dict[str, Any], stone: dict[str, Any]) -> Path:
    document = json.loads(SCENE.read_text(encoding="utf-8"))
    for entity in document["entities"]:
        if entity["id"] == "robot":
            entity["components"]["controller"] = {"name": "lokomat_combined", **controller}
    document["entities"].append({"id": "stone", **stone})
    file = folder / "scene.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    return file


def _leaning() -> dict[str, Any]:
    """A box whose face leans back, and is at FACE at HEIGHT."""
    half = 0.5 * LEANING["size"][0]
    place = [FACE + half * np.cos(LEAN), HEIGHT - half * np.sin(LEAN), 0.0]
    turn = [0.0, 0.0, -float(np.sin(0.5 * LEAN)), float(np.cos(0.5 * LEAN))]
    mesh = {"primitive": LEANING, "visible": False}
    return {"transform": {"translation": place, "rotation": turn}, "components": {"mesh": mesh}}


def test_a_leaning_face_is_rigid_at_the_foot(tmp_path: Path) -> None:
    with mimics.open(_scene(tmp_path, {"hard_object": "stone"}, _leaning()), runs=tmp_path) as session:
        session.step(8.0)
        folder = session.run_dir
    haptic = mimics.load(folder).haptic
    assert np.asarray(haptic["state"])[-1] == SafetyState.ACTIVE and not np.asarray(haptic["cause"]).any()
    foot, wish = np.asarray(haptic["hip_world"]), np.asarray(haptic["left_x_des"])
    pressed = np.asarray(haptic["left_f_x"]) < -10.0
    assert pressed.mean() > 0.05
    face = FACE + (foot[:, 1] - HEIGHT) * np.tan(LEAN)
    assert np.abs(wish - face)[pressed].max() < 2e-3, "x_des stays on the border, 35 mm before FACE where the foot is"
    assert (face < FACE - 0.03)[pressed].all()


ROUND = {"object_kind": 4.0}
STANDING, LYING = [0.0, 0.0, 0.0, 1.0], [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]


@pytest.mark.parametrize(
    ("primitive", "turn", "expected"),
    [
        ({"shape": "sphere", "radius": 0.1}, STANDING, {**ROUND, "object_size": 2.0 * np.sqrt(0.01 - 0.0225 * 0.25)}),
        ({"shape": "cylinder", "radius": 0.1, "height": 0.5}, LYING, {**ROUND, "object_size": 0.2}),
        ({"shape": "cylinder", "radius": 0.2, "height": 0.1}, STANDING, {"object_kind": 6.0}),
        ({"shape": "box", "size": [0.2, 0.1, 0.4]}, STANDING, {"object_kind": 6.0}),
    ],
    ids=["sphere", "lying", "standing", "box"],
)
def test_bodies_are_cut_by_the_plane_of_the_leg(
    tmp_path: Path, primitive: dict[str, Any], turn: list[float], expected: dict[str, float]
) -> None:
    half = 0.5 * LOKOMAT.geometry_of(Robot(device="lokomat:sim"))[4]
    stone = {
        "transform": {"translation": [0.5, 0.4, -half + 0.075], "rotation": turn},
        "components": {"mesh": {"primitive": primitive}},
    }
    scene = check_scene(read_scene(_scene(tmp_path, {"hard_object": "stone"}, stone)))
    values = hard_object_values(scene.first(Controller), scene, LOKOMAT)
    assert {name: values[name] for name in expected} == pytest.approx(expected)
    if expected["object_kind"] == 4.0:
        assert values["object"] == pytest.approx((0.5, 0.4 - HIPS))
        return
    x, z = np.array(values["outline_x"]), np.array(values["outline_z"])
    wide = 2.0 * np.sqrt(0.04 - 0.075**2) if primitive["shape"] == "cylinder" else 0.2
    assert len(x) == 4 and np.ptp(x) == pytest.approx(wide, rel=2e-2) and np.ptp(z) == pytest.approx(0.1)
    assert x.mean() == pytest.approx(0.5) and z.mean() == pytest.approx(0.4 - HIPS)


BODY = {"mesh": {"primitive": {"shape": "box", "size": [0.2, 0.2, 0.6]}}}


@pytest.mark.parametrize(
    ("controller", "stone", "pointer", "said"),
    [
        ({"hard_object": "rock"}, {"components": BODY}, "/hard_object", 'no entity "rock"'),
        ({"hard_object": "stone"}, {}, "/hard_object", "has no mesh"),
        ({"hard_object": "stone"}, {"transform": {"translation": [0.4, 0.3, 2.0]}, "components": BODY}, "", "misses"),
        ({"hard_object": "stone"}, {"transform": {"translation": [9.0, 0.3, 0.0]}, "components": BODY}, "", "outline"),
        (
            {"hard_object": "stone"},
            {"components": {"mesh": {"primitive": {"shape": "capsule", "radius": 0.3, "length": 0.2}}}},
            "/hard_object",
            "at most 16",
        ),
        (
            {"hard_object": "stone", "parameters": {"object_kind": 1}},
            {"components": BODY},
            "/hard_object",
            "keep one",
        ),
        ({"hard_object": "stone", "name": "impedance"}, {"components": BODY}, "/hard_object", "no hard object"),
        ({"parameters": {"object_kind": 6}}, {}, "/parameters", "fewer than three"),
        (
            {"parameters": {"object_kind": 6, "outline_x": [0.3, 0.5, 0.3, 0.5], "outline_z": [0, 0.2, 0.2, 0]}},
            {},
            "/parameters",
            "crosses itself",
        ),
    ],
)
def test_what_is_no_hard_object_is_refused(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    controller: dict[str, Any],
    stone: dict[str, Any],
    pointer: str,
    said: str,
) -> None:
    assert main(["check", str(_scene(tmp_path, controller, stone))]) != 0
    printed = capsys.readouterr()
    text = printed.out + printed.err
    assert f"/components/controller{pointer}" in text and said in text


def test_a_command_leaves_no_outline_that_is_turned_inside_out(tmp_path: Path) -> None:
    """A rounding of half a metre is within its limits, and more than a box of 0.3 m has."""
    with mimics.open(_scene(tmp_path, {"hard_object": "stone"}, _leaning()), record=False) as session:
        small, large = (session.set(**{"controller.rounding": radius})[0] for radius in (0.02, 0.5))
        session.step(0.1)
    assert small.done and not large.done
    assert "too sharp for a rounding of 0.5 m" in large.why
