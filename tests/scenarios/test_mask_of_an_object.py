"""Every parameter of the mask of D2.1 4.2.8.2, from a scene file to the loop: two values, and what each does."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import SAMPLE
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.shared_memory import ring
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.scene_block import scene_from_components
from tests.support.haptic_bench import glide, ignore, read_script, script
from tests.support.object_scenes import loaded, thing

T = 1e-3
FREE_TICKS = 200
"""How long a body is left alone: 0.2 s."""
TOUCH, IN, HELD = 700, 20, 40
"""Tick at which the hand goes in, for how long it does, and how long it stays."""

CUBE = {"shapes": [{"shape": "cube", "size": [0.04, 0.04, 0.04]}], "mass": 0.5, "sleeps": False}
STIFF = {"stiffness": 1000.0, "damping": 0.0}
SAFETY = {"force_limit": 50.0}
"""A cube of 4 cm at 1000 N/m lets a hand through at 55 N: `check` refuses it for a hand that may press harder."""


@dataclass(frozen=True)
class Played:
    """Samples [n], and pose of the body at the end: place [m], quaternion xyzw."""

    samples: np.ndarray
    pose: np.ndarray

    @property
    def angle(self) -> float:
        """By which it is turned [rad]."""
        return 2.0 * math.atan2(float(np.linalg.norm(self.pose[3:6])), abs(float(self.pose[6])))

    @property
    def force(self) -> float:
        """On the hand, upwards, while it is held inside [N]."""
        return float(self.samples["f_shapes"][TOUCH + IN + HELD - 1, 1])


def play(folder: Path, hand: np.ndarray, ticks: int, transform: dict[str, Any], **mask: Any) -> Played:
    """One object of a scene file, and a hand that goes its own way."""
    entity = {**thing("thing", haptic_object={**CUBE, **mask}), "transform": transform}
    side = HapticSceneData(loaded(folder, thing("robot", robot={}, safety=SAFETY), entity))
    plugin = DevicePlugin("script", read_script, ignore, np.ascontiguousarray(hand).ravel())
    memory = side.memory(plugin)
    engine = side.engine(memory, plugin)
    block = scene_from_components()
    block["controller"], block["passivity"], block["cap"] = Slot.PERSON, 0, 0
    side.parameter_store(block).send_to(engine.publish)
    engine.advance(ticks)
    samples = np.zeros(len(memory.samples), SAMPLE)
    count = ring.drain(memory.sample_words, memory.samples, samples)
    return Played(samples[:count], engine.snapshot().poses[0].copy())


def away() -> np.ndarray:
    """A hand far from everything."""
    rows = script(1)
    rows[:, 0] = 0.15
    return rows


def pressing(depth: float = 2e-3, aside: float = 0.0) -> np.ndarray:
    """A hand that goes straight down into the top of the cube of 4 cm, and stays."""
    rows = script(TOUCH + IN + HELD)
    rows[:, 0] = aside
    rows[:, 2] = 0.021
    glide(rows, TOUCH, 2, 0.02 - depth, IN)
    rows[:-1, 5] = np.diff(rows[:, 2]) / T
    return rows


@dataclass(frozen=True)
class Trial:
    """Two values of a parameter, what is measured, and what should come out for each."""

    values: tuple[Any, Any]
    measure: Callable[[Played], Any]
    expected: tuple[Any, Any]
    key: str = ""
    mask: dict[str, Any] = field(default_factory=dict)
    touched: bool = False
    aside: float = 0.0
    moving: int = 0
    """Ticks after the hand began to go in at which its force is measured; 0: once it holds."""

    def run(self, folder: Path, which: int) -> Any:
        value = self.values[which]
        transform = {self.key: value} if self.key in ("translation", "rotation") else {}
        mask = {**self.mask, **({} if transform else {self.key: value})}
        hand = pressing(aside=self.aside) if self.touched else away()
        ticks = (TOUCH + (self.moving or IN + HELD)) if self.touched else FREE_TICKS
        return self.measure(play(folder, hand, ticks, transform, **mask))


def place(axis: int) -> Callable[[Played], float]:
    return lambda played: float(played.pose[axis])


def angle(played: Played) -> float:
    return played.angle


def force(played: Played) -> float:
    return played.force


def last_force(played: Played) -> float:
    return float(played.samples["f_shapes"][-1, 1])


def faded(speed: float, rate: float) -> float:
    """Way under drag alone: v m/b (1 - e^(-b t/m)) with rate = b/m."""
    return speed * (1.0 - math.exp(-rate * FREE_TICKS * T)) / rate


t = FREE_TICKS * T
FIXED = {**STIFF, "enable_translation": False, "enable_rotation": False}
TURNED = {"inertia": [1e-3, 1e-3, 1e-3]}
QUARTER = [0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)]

TRIALS = {
    "Enable translation": Trial((True, False), place(0), (t * t, 0.0), "enable_translation", {"force_aux": [1, 0, 0]}),
    "Enable rotation": Trial(
        (True, False), angle, (0.5 * 5.0 * t * t, 0.0), "enable_rotation", {**TURNED, "torque_aux": [0, 0.005, 0]}
    ),
    "Enable translational haptic force on object": Trial(
        (True, False), lambda played: played.pose[1] < -1e-4, (True, False), "enable_force_on_object", STIFF, True
    ),
    "Enable rotational haptic force on object": Trial(
        (True, False), lambda played: played.angle > 1e-3, (True, False), "enable_torque_on_object", STIFF, True, 0.01
    ),
    "Mass of haptic object": Trial((0.5, 1.5), place(0), (t * t, t * t / 3.0), "mass", {"force_aux": [1, 0, 0]}),
    "Gravity acceleration": Trial(
        ([0, -9.81, 0], [0, 0, 1.62]), lambda played: played.pose[[1, 2]],
        ([-0.5 * 9.81 * t * t, 0.0], [0.0, 0.5 * 1.62 * t * t]), "gravity",
    ),
    "Object dimensions": Trial(
        ([{"shape": "cube", "size": [0.04, 0.04, 0.04]}], [{"shape": "cube", "size": [0.04, 0.041, 0.04]}]), force,
        (2.0, 2.5), "shapes", FIXED, True,
    ),
    "Object stiffness": Trial((1000.0, 1700.0), force, (2.0, 3.4), "stiffness", {**FIXED, "damping": 0.0}, True),
    "Object damping": Trial(
        (0.0, 8.0), last_force, (1.1, 1.1 + 8.0 * 0.15), "damping",
        {"stiffness": 1000.0, "enable_translation": False, "enable_rotation": False}, True, moving=14,
    ),
    "Object initial position": Trial(
        ([0.1, 0.2, -0.05], [-0.1, 0.0, 0.05]), lambda played: played.pose[:3], ([0.1, 0.2, -0.05], [-0.1, 0.0, 0.05]),
        "translation",
    ),
    "Object initial velocity": Trial(
        ([0.2, 0, 0], [-0.1, 0, 0]), place(0), (0.2 * t, -0.1 * t), "initial_velocity"
    ),
    "Object initial orientation": Trial(
        ([0.0, 0.0, 0.0, 1.0], QUARTER), lambda played: played.pose[3:], ([0.0, 0.0, 0.0, 1.0], QUARTER), "rotation"
    ),
    "Initial omega of object": Trial(
        ([0, 2, 0], [0, 0, 3]), angle, (2.0 * t, 3.0 * t), "initial_angular_velocity", TURNED
    ),
    "Environment translation damping": Trial(
        (0.0, 2.0), place(0), (0.2 * t, faded(0.2, 4.0)), "environment_translation_damping",
        {"initial_velocity": [0.2, 0, 0]},
    ),
    "Environment rotation damping": Trial(
        (0.0, 4e-3), angle, (2.0 * t, faded(2.0, 4.0)), "environment_rotation_damping",
        {**TURNED, "initial_angular_velocity": [0, 2, 0]},
    ),
}  # fmt: skip
"""By the parameter's name on the mask."""


def test_no_parameter_of_the_mask_is_left_out():
    page = (root() / "docs" / "blocks.md").read_text(encoding="utf-8")
    rows = page.split("## Mask of a haptic object", 1)[1].split("\n## ", 1)[0].splitlines()
    named = [row.strip("|").split("|")[0].strip() for row in rows if row.startswith("| ")][1:]
    assert named == list(TRIALS)


@pytest.mark.parametrize("name", TRIALS)
@pytest.mark.parametrize("which", [0, 1])
def test_parameter_does_what_its_name_says(tmp_path: Path, name: str, which: int):
    """To 1 %: a step of semi-implicit Euler errs by h/t = 0.5 % in a way from rest, drag by b h/2m = 0.2 %."""
    trial = TRIALS[name]
    found, expected = trial.run(tmp_path, which), trial.expected[which]
    if isinstance(expected, bool):
        assert bool(found) is expected
    else:
        assert found == pytest.approx(expected, rel=0.01, abs=1e-9)
