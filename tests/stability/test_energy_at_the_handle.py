"""What the person is given at the handle, integrated from the samples: never more than the tank has paid.

Over every scene that is shipped, over parameters drawn from their whole ranges, and over every name that may be written
while a session runs, at both of its ends.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.field_ranges import RANGES, SCENE_RANGES
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.messages.orders import HapticOrder, haptic_field
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_block import impedance_values
from mimics_app.world.components.robot import Impedance, Patient, Robot
from mimics_app.world.files.scene.file import load_scene
from tests.support.felt_energy import fastest_change, given, paid
from tests.support.haptic_bench import Bench, bench_of, wavy
from tests.support.scene_play import ScenePlay

ROUNDING = 5e-3
"""[J]: velocity and position of a sample are half a tick apart."""

FELT = ("stiffness", "damping", "drag", "drag_growth", "centring", "advance")


def _played_scenes() -> list[Path]:
    """Every shipped scene with a robot."""
    files = sorted([*(root() / "scenes").glob("*.json"), *(root() / "scenes" / "examples").glob("*.json")])
    return [file for file in files if load_scene(file).has(Robot)]


def _check(samples: Any, limits: Any, viscosity: Any) -> None:
    """No energy that is not paid, and no force beyond its limits, of size and of change."""
    assert np.isfinite(samples["f_user_world"]).all()
    assert (given(samples) - paid(samples, limits, viscosity)).max() <= ROUNDING
    assert np.linalg.norm(samples["f_user_world"], axis=1).max() <= limits["force_limit"] * (1.0 + 1e-12)
    assert fastest_change(samples) <= limits["force_rate_limit"] * 1e-3 * (1.0 + 1e-9)


@pytest.mark.parametrize("file", _played_scenes(), ids=lambda file: file.stem)
def test_a_shipped_scene_gives_no_more_than_its_tank_pays(file: Path):
    slow = file.stem in (
        "avatar_cord",
        "city_walk",
        "canyon_walk",
        "soccer",
        "guided_walk",
    )  # people to animate; no surface to touch at first
    far = file.stem == "printed_equations"  # from its start: the drive takes five seconds
    play = ScenePlay(file, seed=3).run(2.0 if slow else 8.0 if far else 5.0)
    limits = play.parameter_store.block[0]
    _check(play.samples, limits, float(limits["virtual_damping"]))
    assert (play.samples["state"] == SafetyState.ACTIVE).any()


def _bench(device: str) -> Bench:
    """A person at the beginning of a wavy tunnel, on a robot that takes velocities or forces."""
    curve = wavy()
    way = curve.point(np.linspace(0.0, len(curve.pieces), 200))
    bench = bench_of(build_device(Robot(device=device), Patient(preset="severe"), way, 7), straight=None)
    curve.fill(bench.tunnel)
    R, origin = bench.scene[0]["R_world_from_robot"], bench.scene[0]["origin_world"]
    bench.scene[0]["ball_radius_min"], bench.scene[0]["ball_radius_max"] = 0.008, 0.016
    force = impedance_values(bench.scene, Impedance(damping=2.0)) if device == "simulated_impedance" else {}
    target = R.T @ (curve.point(0.0)[0] - origin)
    bench.publish(**(force | {"controller": Slot.START, "target": target, "force_rate_limit": 2000.0}))
    bench.advance(3000)
    return bench


@pytest.mark.parametrize("device", ["simulated_hapticmaster", "simulated_impedance"])
def test_a_hundred_random_settings_give_no_more_than_the_tank_pays(device: str):
    """Every number of the tunnel log-uniform over its range, 50 settings for each kind of robot; stops are reset.

    Drag of 1e5 N s/m on a light robot with a delay gives energy in every other tick: the tank pays, or it is not felt.
    """
    bench, noise = _bench(device), np.random.default_rng(20)
    feel = Slot.PERSON
    bench.send(active=1, trial=1)
    runs, viscosity = [], []
    for _ in range(50):
        values = {f"tunnel__{name}": _drawn(noise, RANGES["tunnels"][name].most) for name in FELT}
        values |= {"virtual_damping": _drawn(noise, 100.0), "virtual_mass": 0.5 + _drawn(noise, 10.0)}
        resets = int(bench.scene[0]["resets"]) + 1
        bench.publish(controller=feel, trial=1, resets=resets, ramp_time=0.05, ramp_force=500.0, **values)
        runs.append(bench.advance(400))
        viscosity.append(np.full(400, values["virtual_damping"]))
    samples = np.concatenate(runs)
    _check(samples, bench.scene[0], np.concatenate(viscosity))
    assert (np.linalg.norm(samples["f_user_world"], axis=1) > 0.1).sum() > 1000, "the force is on"
    assert samples["tank"].min() < bench.scene[0]["tank_size"] - 0.1, "and some settings cost energy"


def _drawn(noise: np.random.Generator, most: float) -> float:
    return float(most * 10.0 ** (-6.0 * noise.random())) if noise.random() < 0.7 else 0.0


def _writable(store: ParameterStore, names: Any) -> list[tuple[str, float, float]]:
    """Every number that may be written in a scene, with its least and its largest value."""
    found = [("", "", name, each) for name, each in SCENE_RANGES.items() if each.written and name != "target"]
    for table, fields in RANGES.items():
        for entity in names.get(table, {}):
            found += [(table, f"{entity}.", name, each) for name, each in fields.items() if each.written]
    return [
        (f"{table}.{entity}{name}" if table else name, each.least, each.most) for table, entity, name, each in found
    ]


@pytest.mark.parametrize("scene", ["pick_and_place", "examples/path_tunnel", "examples/shaking_and_sticking"])
def test_every_name_at_both_of_its_ends_gives_no_more_than_the_tank_pays(scene: str):
    play = ScenePlay(root() / "scenes" / f"{scene}.json", seed=4).run(4.0)
    store, refused, written = play.parameter_store, 0, 0
    limits = store.block[0].copy()
    for name, least, most in _writable(store, store._names):
        records, field = store._find(name)
        before = records[0][field].copy()
        for end in (least, most):
            written += 1
            refused += len(store.order(HapticOrder({haptic_field(name): np.full(np.shape(before), end)})))
            play.run(1 / 60)
            assert not store.order(HapticOrder({haptic_field(name): before})), name
        store.reset()
    samples = play.samples
    feel = ("stiffness_share", "tank")
    assert all(np.isfinite(samples[name]).all() for name in feel)
    assert np.isfinite(samples["f_user_world"]).all()
    assert np.linalg.norm(samples["f_user_world"], axis=1).max() <= limits["force_limit"] * (1.0 + 1e-12)
    assert fastest_change(samples) <= limits["force_rate_limit"] * 1e-3 * (1.0 + 1e-9)
    damping = float(SCENE_RANGES["virtual_damping"].most)
    assert (given(samples) - paid(samples, limits, damping)).max() <= ROUNDING
    assert refused < 0.5 * written and written > 20
