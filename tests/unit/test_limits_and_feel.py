"""One truth for the parameters of the loop: component defaults, limits that nothing names, shown as they ran."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimics_app.app.session.header import describe_session
from mimics_app.app.session.preparation import prepare
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.device_fit import device_values
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import HAPTIC_PARAMETERS, LIMIT_NAMES, SCENE
from mimics_app.contracts.loop.haptic_objects import TUNNEL
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.scene_block import apply_safety, safety_of, scene_from_components
from mimics_app.tasks.check import check_task
from mimics_app.tasks.task import TaskSpec
from mimics_app.world.components.robot import Admittance, Ball, Robot, Safety, WorldPd

ADDRESSABLE = {name for name, _ in HAPTIC_PARAMETERS} | {
    f"tunnel.{name}" for name in TUNNEL.names if TUNNEL[name] == np.float64
}
NAMES = [*SCENE.names, *(f"tunnel.{name}" for name in TUNNEL.names)]


def faults_of(target: str) -> list[Any]:
    parameter = {"default": 1.0, "min": 0.5, "max": 1.0, "maps": [{"to": f"haptic.{target}"}]}
    return check_task(msgspec.convert({"parameters": {"p": parameter}}, TaskSpec), "/task", "scene.json")


@pytest.mark.parametrize("name", NAMES)
def test_a_task_may_name_what_is_felt_and_nothing_else_of_the_block(name: str):
    faults = faults_of(name)
    assert (faults == []) == (name in ADDRESSABLE)
    assert all(fault.pointer == "/task/parameters/p/maps/0/to" for fault in faults)


@pytest.mark.parametrize("name", sorted(LIMIT_NAMES))
def test_a_limit_is_refused_by_its_name_with_what_may_be_named(name: str):
    (fault,) = faults_of(name)
    assert f'"{name}" is a limit' in fault.what
    assert "virtual_mass" in fault.fix and "tunnel.stiffness" in fault.fix


@pytest.mark.parametrize("name", sorted(LIMIT_NAMES))
def test_nothing_that_runs_changes_a_limit(name: str):
    store = ParameterStore(scene_from_components())
    before = store.block.tobytes()
    for spelling in (name, f"haptic.{name}"):
        with pytest.raises(UsageError, match="is a limit of the haptic loop"):
            store.change({"virtual_mass": 9.0, spelling: 0.0})
    assert store.block.tobytes() == before, "not even what came with it"


def test_the_device_is_fitted_before_the_first_block_and_never_after():
    store = ParameterStore(scene_from_components())
    store.fit({"device_delay": 0.004, "passivity": 0})
    store.send_to(lambda block, rows: None)
    assert (store.block["device_delay"][0], store.block["passivity"][0]) == (0.004, 0)
    with pytest.raises(UsageError, match="once"):
        store.fit({"device_delay": 0.0})


@pytest.mark.parametrize(("safety", "others"), [(Safety(), False), (Safety(force_limit=10.0), True)])
def test_a_reloaded_scene_keeps_the_limits_of_the_start_and_says_whether_it_asks_for_others(safety, others):
    store = ParameterStore(scene_from_components())
    store.fit({"device_delay": 0.004, "late_latches": 0})
    store.send_to(lambda block, rows: None)
    store.change({"virtual_mass": 4.0})
    assert store.replace(scene_from_components(admittance=Admittance(damping=7.0), safety=safety)) is others
    record = store.block[0]
    assert (record["virtual_damping"], record["virtual_mass"]) == (7.0, 4.0)
    assert (record["force_limit"], record["device_delay"], record["late_latches"]) == (60.0, 0.004, 0)


def test_a_scene_without_a_component_runs_that_component_s_own_defaults():
    block = scene_from_components(Robot(), Admittance(), Ball(), Safety(), WorldPd())
    assert scene_from_components().tobytes() == block.tobytes()
    assert (Safety().force_limit, Safety().force_rate_limit, Safety().velocity_limit) == (60.0, 2000.0, 1.2)


@given(
    force=st.floats(1e-3, 500.0),
    late_ns=st.integers(1, 10**9),
    missed=st.integers(1, 1000),
    cap=st.sampled_from(["cap", "warn"]),
    passivity=st.booleans(),
)
def test_limits_read_back_from_the_block_are_those_that_were_asked_for(force, late_ns, missed, cap, passivity):
    asked = Safety(
        force_limit=force, ramp_time_s=0.1 * force, late_stop_s=late_ns / 1e9, missed_stop=missed, stiffness_cap=cap,
        passivity=passivity, arm_damping=force,
    )  # fmt: skip
    block = scene_from_components()
    apply_safety(block, asked)
    assert safety_of(block) == asked


@pytest.mark.parametrize("scene", ["examples/bisector_only", "wavy_tunnel"])
def test_the_header_states_the_limits_that_run(scene: str):
    """The first has no `safety`: it ran 60 N, 2,000 N/s and 1.5 m/s, and stated 80 N, 20,000 N/s and 1.2 m/s."""
    parts = prepare(RunSettings(root() / f"scenes/{scene}.json"), live=False)
    parts.parameter_store.fit(
        {**device_values(parts.plugin, parts.scene, parts.parameter_store.block), "passivity": 0, "force_limit": 41.0}
    )
    reported = describe_session(parts)["safety"]
    record = parts.parameter_store.block[0]
    for name in ("force_limit", "force_rate_limit", "velocity_limit", "power_limit", "energy_limit", "arm_damping"):
        assert reported[name] == record[name], name
    assert (reported["force_limit"], reported["passivity"], reported["late_latches"]) == (41.0, False, False)


@pytest.mark.parametrize(
    ("device", "latches"),
    [("simulated_hapticmaster", 0), ("simulated_impedance", 0), ("pointer", 0)],
)
def test_late_ticks_latch_no_stop_of_a_simulated_device(device: str, latches: int):
    plugin = build_device(Robot(device=device))
    scene: Any = SimpleNamespace(first=lambda kind: None)
    assert device_values(plugin, scene, scene_from_components())["late_latches"] == latches


def test_the_passivity_controller_is_off_where_the_device_renders_a_mass_of_its_own():
    """The credit of the loop's virtual mass ran out while the hand pressed on: the wall let it through."""
    plugin = replace(build_device(Robot(device="simulated_hapticmaster")), own_mass=True)
    scene: Any = SimpleNamespace(first=lambda kind: None)
    assert device_values(plugin, scene, scene_from_components())["passivity"] == 0
    assert "passivity" not in device_values(replace(plugin, own_mass=False), scene, scene_from_components())


def test_late_ticks_latch_a_stop_of_every_device_that_does_not_say_it_is_simulated(tmp_path: Path):
    plugin = build_device(Robot(device="simulated_hapticmaster"))
    real = replace(plugin, simulated=False)
    scene: Any = SimpleNamespace(first=lambda kind: None)
    assert (
        device_values(real, scene, scene_from_components())["late_latches"] == 1
        and scene_from_components()["late_latches"][0] == 1
    )
