"""The life cycle of a device: its table, the page that shows it, the word of the loop, and the engine's own steps."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest

from mimics_app.compiled.kernel import typed_kernel
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.device_life import LIFE_IN, LIFE_STEPS, DeviceLife, LifeStep, life_after
from mimics_app.contracts.loop.haptic import SafetyState, TripCause
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_DQ,
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_VIBRATION,
    READ,
    WRITE,
    DevicePlugin,
)
from mimics_app.contracts.shared_memory.command_ring import request_stop
from mimics_app.rendering.haptic.devices.conformance import CHECKS
from mimics_app.rendering.haptic.kernels.rows import write_command
from mimics_app.rendering.haptic.kernels.state import new_states
from mimics_app.rendering.haptic.scene_block import scene_from_components
from tests.support.device_rig import hapticmaster_rig, pushed_serial_rig
from tests.support.haptic_bench import bench_of

PAGE = Path(__file__).parents[2] / "docs" / "devices" / "life_cycle.md"

ROS2 = {
    ("unconfigured", "configure"): "inactive",
    ("unconfigured", "shutdown"): "finalised",
    ("inactive", "activate"): "active",
    ("inactive", "cleanup"): "unconfigured",
    ("inactive", "shutdown"): "finalised",
    ("active", "deactivate"): "inactive",
    ("active", "shutdown"): "finalised",
}
"""Transitions between the primary states of a managed node, https://design.ros2.org/articles/node_lifecycle.html."""


def test_the_steps_are_those_of_ros2_but_for_the_shutdown_of_an_active_device():
    own = {(str(life), str(step)): str(after) for (life, step), after in LIFE_STEPS.items()}
    assert own == {pair: after for pair, after in ROS2.items() if pair != ("active", "shutdown")}


@pytest.mark.parametrize(("life", "step"), list(product(DeviceLife, LifeStep)))
def test_every_step_is_taken_or_refused_with_what_to_do(life: DeviceLife, step: LifeStep):
    if (str(life), str(step)) in ROS2 and (life, step) != (DeviceLife.ACTIVE, LifeStep.SHUTDOWN):
        assert life_after(life, step) == ROS2[life, step]
        return
    with pytest.raises(DeviceError, match=f'"{step}" is refused while the device is {life}') as refused:
        life_after(life, step)
    assert refused.value.fix


def test_the_diagram_names_the_states_and_steps_of_the_code_and_no_others():
    """What leads where is read in the table below it."""
    drawing = re.search(r"^```text\n(.+?)^```", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    words = re.findall(r"[a-z]{2,}", drawing[1] if drawing else "")
    assert sorted(words) == sorted([*map(str, DeviceLife), *map(str, LifeStep)])


def test_the_page_has_every_step_in_every_state_and_names_checks_of_the_kit():
    text = PAGE.read_text("utf-8").split("## Every step in every state")[1]
    rows = re.findall(r"^\| (\w+) \| (\w+) \| (\w+) \| (.+) \|$", text, re.MULTILINE)[1:]
    shown = {(life, step): after for life, step, after, _ in rows}
    taken = {(str(life), str(step)): str(after) for (life, step), after in LIFE_STEPS.items()}
    assert shown == {(str(a), str(b)): taken.get((str(a), str(b)), "refused") for a, b in product(DeviceLife, LifeStep)}
    named = {by.strip('"') for *_, by in rows if by.startswith('"')}
    assert named <= set(CHECKS) and len(named) >= 8


@pytest.mark.parametrize("safety", SafetyState)
def test_the_loops_word_is_1_in_exactly_the_states_in_which_a_device_is_active(safety: SafetyState):
    states, command = new_states(), np.zeros(COMMAND_LENGTH)
    states[0]["safety"] = safety
    write_command.py_func(scene_from_components().view(np.recarray)[0], states.view(np.recarray), 1e-3, command)
    assert (command[COMMAND_ENABLED] == 1.0) == (LIFE_IN[safety] is DeviceLife.ACTIVE)


ENABLED, MOTION, FAULTY, EVER = 0, 1, 2, 3


@typed_kernel(READ)
def read_as_told(memory, inbox, data, tick):
    return int(memory[FAULTY])


@typed_kernel(WRITE)
def keep_word(memory, command, tick):
    memory[ENABLED] = command[COMMAND_ENABLED]
    memory[EVER] = max(memory[EVER], memory[ENABLED])
    memory[MOTION] = np.abs(command[COMMAND_DQ:COMMAND_VIBRATION]).sum()
    return 0


def _told(**changes: bool) -> DevicePlugin:
    return replace(DevicePlugin("told", read_as_told, keep_word, np.zeros(4)), **changes)


@pytest.mark.parametrize("simulated", [True, False])
def test_the_safety_machine_drives_the_life_and_the_engine_ends_it(simulated: bool):
    closed: list[float] = []
    plugin = _told(simulated=simulated)
    plugin = replace(plugin, close=lambda: closed.append(plugin.memory[ENABLED]))
    bench = bench_of(plugin)
    lives: list[DeviceLife] = []

    def advance(ticks: int) -> DeviceLife:
        for _ in range(ticks):
            bench.advance(1)
            lives.append(bench.engine.life)
            assert (plugin.memory[ENABLED] == 1.0) == (lives[-1] is DeviceLife.ACTIVE)
        return lives[-1]

    assert bench.engine.life is DeviceLife.INACTIVE
    assert advance(50) is DeviceLife.ACTIVE
    plugin.memory[FAULTY] = 2.0
    assert advance(1) is DeviceLife.INACTIVE
    plugin.memory[FAULTY] = 0.0
    assert advance(50) is DeviceLife.INACTIVE
    bench.publish(resets=1)
    assert advance(5) is DeviceLife.ACTIVE
    request_stop(bench.memory)
    assert advance(2) is DeviceLife.INACTIVE
    bench.publish(resets=2)
    assert advance(5) is DeviceLife.ACTIVE
    assert all((a, b) in _STEPS for a, b in pairwise(lives) if a != b)
    bench.engine.stop()
    bench.engine.stop()
    assert closed == [0.0], "cleaned up once, after it was told to let go"
    assert bench.engine.life is DeviceLife.FINALISED
    for again in (bench.engine.start, lambda: bench.engine.advance(1)):
        with pytest.raises(DeviceError, match=r"finalised.*build another engine"):
            again()


_STEPS = {(life, after) for (life, _), after in LIFE_STEPS.items()}


def test_a_device_that_does_not_answer_is_never_activated():
    plugin = _told()
    plugin.memory[FAULTY] = 1.0
    bench = bench_of(plugin)
    bench.advance(300)
    assert bench.engine.life is DeviceLife.INACTIVE and plugin.memory[EVER] == 0.0
    assert bench.engine.snapshot().cause == TripCause.NONE


HOMING = 120
"""Steps that the emulated robot needs to home."""


def test_a_serial_robot_homes_while_it_is_inactive(tmp_path: Path):
    with pushed_serial_rig(tmp_path) as rig:
        robot = rig.emulator.plugin

        def read(memory, inbox, data, tick):
            robot.read(memory, inbox, data, tick)
            return 1 if tick < HOMING else 0

        rig.emulator.plugin = replace(robot, read=read)
        bench = bench_of(rig.build(), samples=256)
        samples = rig.advance(bench, HOMING)
        assert np.all(samples["state"] <= SafetyState.INIT) and rig.emulator.commands > 10
        assert bench.engine.life is DeviceLife.INACTIVE and rig.emulator.is_limp
        rig.advance(bench, 30)
        assert bench.engine.life is DeviceLife.ACTIVE and not rig.emulator.is_limp
        bench.engine.stop()


def test_a_hapticmaster_calibrates_before_any_loop_activates_it():
    with hapticmaster_rig(calibrated=False) as rig:
        seen: list[str] = []
        model = rig.emulator.model
        answer = model.answer

        def noted(text: str) -> str:
            seen.append(text)
            return answer(text)

        model.answer = noted
        bench = bench_of(rig.build(), samples=256)
        asked = ";".join(seen)
        assert "set state init" in asked and "set state force" not in asked
        assert bench.engine.life is DeviceLife.INACTIVE and model.state == "stop"
        rig.advance(bench, 100)
        assert bench.engine.life is DeviceLife.ACTIVE and model.state == "force"
        with rig.attended():
            bench.engine.stop()
        assert model.state == "stop"
