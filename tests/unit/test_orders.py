"""Orders of a task to its channels: keys with a type, read from a scene's text once, refused where unknown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mimics_app.app.scenes.loading import read_scene
from mimics_app.app.scenes.scenario_choice import BUILT_IN, features_of
from mimics_app.app.scenes.stage_checks import check_features
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.orders import Feature, HapticField, Shown, VisualOrder, haptic_field, shown
from mimics_app.contracts.system.resources import root

RADIUS, LOOK, SEEN = Feature("radius", 1.0), Feature("look", ""), Feature("seen", True)


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("virtual_mass", HapticField("virtual_mass")),
        ("tunnel.stiffness", HapticField("stiffness", "tunnel")),
        ("bodies.apple.mass", HapticField("mass", "bodies", "apple")),
    ],
)
def test_the_name_of_a_number_is_read_and_written(text: str, field: HapticField) -> None:
    assert haptic_field(text) == field == haptic_field(f"haptic.{text}") and str(field) == text


def test_a_value_has_the_type_of_its_feature() -> None:
    assert RADIUS.read(2) == 2.0 and isinstance(RADIUS.read(2), float)
    assert SEEN.read(0.0) is False and LOOK.read("glass") == "glass"
    for feature, value in ((RADIUS, "wide"), (LOOK, 1.0), (SEEN, "yes")):
        with pytest.raises(UsageError, match=f'"{feature.name}" = '):
            shown({feature: value})


def test_what_is_shown_follows_the_orders_and_keeps_the_rest() -> None:
    now = Shown((RADIUS, LOOK))
    assert now[RADIUS] == 1.0
    now.follow(VisualOrder({RADIUS: 2, SEEN: False}))
    now.follow(VisualOrder({LOOK: "glass"}))
    assert (now[RADIUS], now[LOOK]) == (2.0, "glass")
    assert VisualOrder({RADIUS: 2}).get(LOOK) is None


@pytest.mark.seconds
def test_every_scenario_declares_each_feature_once() -> None:
    declared = [features_of(read_scene(root() / "scenes" / f"{name}.json")) for name in BUILT_IN]
    for features in declared:
        assert len({each.name for each in features}) == len(features)
    assert any(declared)


@pytest.mark.parametrize(
    ("to", "table", "pointer", "said"),
    [
        ("visual.radius_scal", None, "/to", 'shows no "radius_scal"; did you mean "radius_scale"'),
        ("visual.radius_scale", ["wide", "narrow"], "/table", "it takes a number"),
        ("visual.tunnel_look", None, "/to", "it takes a word"),
        ("visual.radius_scale", None, "", ""),
    ],
)
def test_a_map_to_what_the_scenario_does_not_show_is_refused(
    to: str, table: list[str] | None, pointer: str, said: str, tmp_path: Path
) -> None:
    scene = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text())
    scene["task"]["parameters"]["radius"]["default"] = 1.0
    scene["task"]["parameters"]["radius"]["maps"] = [{"to": to} | ({"table": table} if table else {})]
    scene["scenario"] = "wavy_tunnel"
    issues = check_features(read_scene(_written(scene, tmp_path)))
    assert [issue.pointer for issue in issues] == ([f"/task/parameters/radius/maps/0{pointer}"] if said else [])
    assert not said or said in str(issues[0])


def _written(scene: dict[str, object], folder: Path) -> Path:
    file = folder / "scene.json"
    file.write_text(json.dumps(scene).replace('"parts/', f'"{root()}/scenes/parts/'))
    return file
