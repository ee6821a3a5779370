"""The obstacle sequence in the controller of the loop, on the simulated orthosis: nine steps, one free leg, no jump."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mimics_app.contracts.loop.controller_port import CONTROL_INPUT, CONTROL_OUTPUT, CONTROLLER_MEMORY
from mimics_app.contracts.loop.gait_state import GAIT_STATES
from mimics_app.contracts.loop.loop_ports import (
    COMMAND_ENABLED,
    COMMAND_LENGTH,
    COMMAND_TORQUE,
    DATA_DQ,
    DATA_LENGTH,
    DATA_Q,
    DATA_TORQUE,
    INBOX_LENGTH,
)
from mimics_app.rendering.haptic.controllers.orthosis_legs import WALK_PLACES, control_legs
from mimics_app.rendering.haptic.controllers.orthosis_walk import WALK
from mimics_app.rendering.haptic.controllers.parameter_vector import parameter_vector
from mimics_app.rendering.haptic.controllers.registry import find_controller
from mimics_app.rendering.haptic.descriptors.lokomat import LOKOMAT
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_lokomat import (
    build_simulated_lokomat,
    read_lokomat,
    write_lokomat,
)
from mimics_app.world.components.robot import Robot

SECONDS = 50
SAMPLED = 20
"""Ticks from one row to the next."""


def _walk(wall: float, **parameters: Any) -> list[dict[str, Any]]:
    """Rows of gait state and torques of a session on the device, led along a slow walk."""
    robot = Robot(device="lokomat:sim")
    memory = build_simulated_lokomat(DeviceRequest(robot, address="sim", descriptor=LOKOMAT)).memory
    now, out, own = np.zeros(1, CONTROL_INPUT), np.zeros(1, CONTROL_OUTPUT), np.zeros(CONTROLLER_MEMORY)
    given = {"object_kind": 1, "object": [wall, 0.0], "sequence": 1, "obstacle_after": 3.0} | parameters
    numbers = parameter_vector(find_controller("lokomat_impedance"), given)
    data, command, inbox = np.zeros(DATA_LENGTH), np.zeros(COMMAND_LENGTH), np.zeros(INBOX_LENGTH)
    walk, rows = own[WALK_PLACES].view(WALK), []
    geometry = LOKOMAT.geometry_of(robot)
    now["geometry"][0, : len(geometry)] = geometry
    now["dt"], now["guidance"] = 1e-3, 1.0
    for tick in range(1000 * SECONDS):
        read_lokomat(memory, inbox, data, tick)
        w = 2.0 * math.pi * 0.4
        for leg in range(2):
            swing, turned = math.sin(w * 1e-3 * tick + math.pi * leg), w * math.cos(w * 1e-3 * tick + math.pi * leg)
            now["q_reference"][0, 2 * leg : 2 * leg + 2] = 0.1 + 0.2 * swing, 0.3 + 0.2 * swing
            now["dq_reference"][0, 2 * leg : 2 * leg + 2] = 0.2 * turned, 0.2 * turned
            now["ddq_reference"][0, 2 * leg : 2 * leg + 2] = -0.2 * w * w * swing
        now["q"][0, :4], now["dq"][0, :4] = data[DATA_Q : DATA_Q + 4], data[DATA_DQ : DATA_DQ + 4]
        now["torque_meas"][0, :4] = data[DATA_TORQUE : DATA_TORQUE + 4]
        now["started"] = int(tick == 0)
        control_legs(False, now[0], numbers, own, out[0])
        command[COMMAND_TORQUE : COMMAND_TORQUE + 4], command[COMMAND_ENABLED] = out["torque"][0, :4], 1.0
        write_lokomat(memory, command, tick)
        row: NDArray[Any] = walk["sequence"][0]
        if tick % SAMPLED == 0 or row["state"] != rows[-1]["state"]:
            rows.append(
                {name: np.array(row[name]) for name in ("state", "guidance", "hard", "held", "belt", "free_leg")}
                | {"torque": out["torque"][0, :4].copy(), "q": now["q"][0, :4].copy()}
            )
    return rows


@pytest.fixture(scope="module", params=[0.0, 0.1], ids=["impedance", "window"])
def rows(request: pytest.FixtureRequest) -> list[dict[str, Any]]:
    return _walk(0.35, guidance_window=request.param)


def test_the_walk_passes_the_nine_steps_in_their_order_and_continues(rows: list[dict[str, Any]]) -> None:
    """A passive foot does not overstep the wall: the exploration ends by its time limit of 30 s."""
    visited = [GAIT_STATES[int(rows[0]["state"])]]
    for row in rows:
        if (name := GAIT_STATES[int(row["state"])]) != visited[-1]:
            visited.append(name)
    begun = visited.index("walking")
    assert visited[begun : begun + 10] == [*GAIT_STATES[:9], "walking"]


def test_hard_objects_and_free_legs_only_as_the_rules_say(rows: list[dict[str, Any]]) -> None:
    for row in rows:
        if row["hard"]:
            assert row["belt"] == 0.0 and row["held"][1 - row["free_leg"]] == 1
        assert not (row["guidance"] == 0.0).all() or GAIT_STATES[int(row["state"])] in ("standing", "guidance_restored")
    explored = [row for row in rows if GAIT_STATES[int(row["state"])] == "exploring"]
    assert explored and all(row["guidance"].tolist() == [0.0, 1.0] for row in explored)
    assert max(abs(row["q"][3]) for row in explored) < 0.4, "the other leg stays extended"


def test_torques_do_not_jump_between_states(rows: list[dict[str, Any]]) -> None:
    """Walking legs are limited to 4,000 N/s at the foot: in 20 ticks of a standing leg that is 80 N."""
    torques = np.array([row["torque"] for row in rows])
    assert np.isfinite(torques).all() and np.abs(np.diff(torques, axis=0)).max() < 80.0
