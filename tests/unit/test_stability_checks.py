"""What `check` refuses because no device of the scene can hold it, and thin plates that would let a hand through."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.loop.device_descriptor import Dynamics
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices import dynamics
from mimics_app.rendering.haptic.stability_checks import check_stability, softened_contacts
from mimics_app.world.components.robot import Robot
from mimics_app.world.files.scene.file import load_scene
from tests.support.scenes import write


def _scene(tmp_path: Path, shape: dict[str, Any], device: str = "simulated_impedance", **components: Any) -> Any:
    wall = {"enable_translation": False, "enable_rotation": False, **shape}
    robot = {"robot": {"device": device}, **components}
    document = {
        "format": "mimics-scene",
        "version": 1,
        "title": "wall",
        "entities": [{"id": "wall", "components": {"haptic_object": wall}}, {"id": "robot", "components": robot}],
    }
    return load_scene(write(tmp_path, document))


def _box(size: tuple[float, float, float] = (0.1, 0.3, 0.3), **surface: float) -> dict[str, Any]:
    return {"shapes": [{"shape": "cube", "size": list(size), **surface}]}


@pytest.mark.parametrize(
    ("device", "stiffness", "damping", "field"),
    [
        ("simulated_impedance", 500.0, 400.0, "damping"),
        ("simulated_impedance", 20000.0, 200.0, "damping"),
        ("simulated_impedance", 40000.0, 60.0, "stiffness"),
        ("simulated_hapticmaster", 500.0, 4000.0, "damping"),
        ("simulated_hapticmaster", 500000.0, 100.0, "stiffness"),
        ("simulated_leg", 500.0, 2000.0, "damping"),
        ("simulated_legs", 500000.0, 100.0, "stiffness"),
        ("hapticmaster", 500.0, 50000.0, "damping"),
        ("hapticmaster:10.0.0.5:7654", 900000.0, 30000.0, "damping"),
        ("serial:/dev/ttyUSB0@9600", 10000.0, 1.0, "stiffness"),
        ("serial:/dev/ttyUSB0@9600", 500.0, 2000.0, "damping"),
    ],
)
def test_contact_that_no_cap_can_render_is_refused(
    tmp_path: Path, device: str, stiffness: float, damping: float, field: str
):
    issues = check_stability(_scene(tmp_path, _box(stiffness=stiffness, damping=damping), device))
    assert [issue.pointer for issue in issues] == [f"/entities/0/components/haptic_object/{field}"]
    assert device in issues[0].what and issues[0].fix


@pytest.mark.parametrize("device", ["simulated_impedance", "simulated_hapticmaster", "hapticmaster", "serial"])
def test_contact_that_can_be_held_or_capped_is_right(tmp_path: Path, device: str):
    """Of a real device what it could not hold without any delay is refused; the rest is for the live limit."""
    assert check_stability(_scene(tmp_path, _box(stiffness=10000.0, damping=60.0), device)) == []


SLOW: Dynamics = {"delay": 0.05, "lag": 0.0, "filtering": 0.0, "quantum": 0.0, "mass": 0.0}


def test_a_plug_in_counts_with_what_its_descriptor_declares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    scene = _scene(tmp_path, _box(stiffness=10000.0, damping=1.0), "theirs")
    refused = ["/entities/0/components/haptic_object/stiffness"]
    for declared, pointers in ((None, []), (lambda robot, rate: SLOW, refused)):
        descriptor = dataclasses.replace(HAPTICMASTER, dynamics=declared)
        monkeypatch.setattr(dynamics, "descriptor_of", lambda name, found=descriptor: found)
        assert [issue.pointer for issue in check_stability(scene)] == pointers


@pytest.mark.parametrize(("follows", "said"), [("velocity", 1), ("force", 1), ("nothing", 0)])
def test_what_an_open_device_cannot_hold_is_named(tmp_path: Path, follows: Any, said: int):
    scene = _scene(tmp_path, _box(stiffness=10000.0, damping=1.0), "theirs")
    plugin = DevicePlugin("theirs", print, print, np.zeros(1), follows=follows, **SLOW)
    lines = softened_contacts(scene, Robot(device="theirs"), plugin)
    assert len(lines) == said and all("haptic_object" in line and "theirs holds up to" in line for line in lines)
    quick = dataclasses.replace(plugin, delay=0.0, mass=2.0)
    assert softened_contacts(scene, Robot(device="theirs"), quick) == []


def test_viscosity_that_shakes_alone_is_refused(tmp_path: Path):
    for name, value in (("impedance", {"damping": 400.0}), ("admittance", {"damping": 5000.0, "mass": 3.0})):
        issues = check_stability(_scene(tmp_path, _box(stiffness=1000.0), **{name: value}))
        assert [issue.pointer for issue in issues] == [f"/entities/1/components/{name}/damping"]


@pytest.mark.parametrize(
    ("shape", "refused"),
    [
        ({"shape": "sphere", "radius": 0.01}, True),
        ({"shape": "sphere", "radius": 0.05}, False),
        ({"shape": "capsule", "radius": 0.005, "length": 0.3}, True),
        ({"shape": "cylinder", "radius": 0.005, "length": 0.3}, True),
        ({"shape": "cube", "size": [0.002, 0.3, 0.3]}, False),
        ({"shape": "cube", "size": [0.002, 0.01, 0.01]}, True),
    ],
)
def test_shape_too_thin_for_the_force_limit_is_refused(tmp_path: Path, shape: dict[str, Any], refused: bool):
    """A box holds the face of entry behind itself, as far as its bounds reach."""
    scene = _scene(tmp_path, {"shapes": [shape], "stiffness": 800.0}, safety={"force_limit": 40.0})
    issues = check_stability(scene)
    assert bool(issues) == refused
    assert not refused or "force_limit" in issues[0].what
