"""A haptic engine over objects instead of a tunnel: the rows of a `Play` in the loop that a session runs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.haptic_objects import ShapeKind
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.loop.object_rows import ObjectCapacities
from mimics_app.rendering.haptic.devices.dynamics import servo_dynamics
from mimics_app.rendering.haptic.devices.request import DeviceRequest
from mimics_app.rendering.haptic.devices.simulated_hapticmaster import write_robot, write_robot_memory
from mimics_app.rendering.haptic.kernels.robot import ROBOT_LENGTH
from mimics_app.world.components.robot import Robot
from tests.support.body_play import Play
from tests.support.haptic_bench import Bench, bench_of, ignore, read_pushed, read_script
from tests.support.touch_play import SOLIDS, add_point, new_touch_play, surface_of

FACING_UP = (-(0.5**0.5), 0.0, 0.0, 0.5**0.5)
"""Turns local +z, where the surfaces of `SOLIDS` are, to the world's +y."""


def shape_below(kind: ShapeKind, height: float = 0.0, **fields: Any) -> Play:
    """One fixed shape of `SOLIDS`, wall or block whose surface is at world y = `height` [m], and one point."""
    play = new_touch_play()
    place = (0.0, height - surface_of(kind), 0.0)
    play.add_shape(kind, SOLIDS.get(kind, ()), position=place, orientation=FACING_UP, **fields)
    add_point(play)
    return play


def bench_with(play: Play, plugin: DevicePlugin, **options: Any) -> Bench:
    """An engine over a device and these objects; no tunnel."""
    room = {"capacities": {"objects": ObjectCapacities()}}
    bench = bench_of(plugin, straight=None, objects=play.work, **room, **options)
    bench.scene[0]["objects"] = play.counts[0]
    bench.publish(rows=play.rows)
    return bench


def scripted_with(play: Play, rows: NDArray[np.float64]) -> Bench:
    """The same over a scripted hand."""
    plugin = DevicePlugin("script", read_script, ignore, np.ascontiguousarray(rows).ravel())
    return bench_with(play, plugin, passivity=0)


def pushed_with(play: Play, robot: Robot) -> Bench:
    """The same over a simulated robot pulled by a constant force and by nothing else."""
    memory = np.zeros(ROBOT_LENGTH + 3)
    request = DeviceRequest(robot=robot)
    write_robot_memory(memory[:ROBOT_LENGTH], request)
    return bench_with(
        play, DevicePlugin("pushed", read_pushed, write_robot, memory, **servo_dynamics(request.robot, request.rate))
    )
