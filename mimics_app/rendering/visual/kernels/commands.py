"""Instances and indirect draw commands of sorted items."""

from __future__ import annotations

from typing import NamedTuple

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import F4, F8, I4, I8, U1, U4

__all__ = ["MAX_TRIANGLES", "Drawn", "write_commands", "write_instances"]

MAX_TRIANGLES = 6_000
"""Number of triangles after which a command of many instances ends, and a flush follows."""


class Drawn(NamedTuple):
    """With what each item is drawn.

    Attributes:
        states: State of each item before mirroring, [n].
        mirrored: 1 where the winding is reversed, [n].
        meshes: Number of each item's mesh, [n].
        ranges: Indices, first index and base vertex of each mesh, [meshes, 3].
        parts: First index and number of indices of each item's triangles, -1 for all of them; [n, 2].
    """

    states: I4
    mirrored: U1
    meshes: I4
    ranges: I4
    parts: I4


@kernel
def write_instances(
    items: I4, count: int, first: int, origin: F8, rows: I4, world: F8, instance_params: F4, out: F4
) -> None:
    """Write the instances: matrices relative to an origin, subtracted in float64, and instance parameters.

    Args:
        items: Numbers of items in draw order, [>= count].
        count: Number of items.
        first: Row of the first instance in `out`.
        origin: Origin of the shaders' frame, world [m], [3].
        rows: Row of the node per item, [n].
        world: T_world_from_node per row, [rows, 4, 4].
        instance_params: Instance parameters of each item, [n, 4].
        out: Written: three rows of a matrix and the instance parameters, [>= first + count, 4, 4].
    """
    for i in range(count):
        item = items[i]
        row = rows[item]
        for k in range(3):
            for column in range(3):
                out[first + i, k, column] = world[row, k, column]
            out[first + i, k, 3] = world[row, k, 3] - origin[k]
            out[first + i, 3, k] = instance_params[item, k]
        out[first + i, 3, 3] = instance_params[item, 3]


@kernel
def write_commands(
    items: I4,
    count: int,
    first: int,
    first_command: int,
    drawn: Drawn,
    single: bool,
    commands: U4,
    runs: I8,
) -> tuple[int, int]:
    """Write the indirect commands of sorted items, and the runs of commands that share a state.

    Args:
        items: Numbers of items in draw order, [>= count].
        count: Number of items.
        first: Number of the first instance.
        first_command: Number of the first command.
        drawn: With what each item is drawn.
        single: True for one command and one run per item.
        commands: Written from `first_command` on: indices, instances, first index, base vertex, base instance.
        runs: Written: state (twice its number, plus 1 where mirrored), first command, commands, triangles.

    Returns:
        Number of commands and of runs.
    """
    states, mirrored, meshes, ranges, parts = drawn
    command, run = first_command - 1, -1
    state_before, mesh_before = -1, -1
    for i in range(count):
        item = items[i]
        mesh, state = meshes[item], 2 * states[item] + mirrored[item]
        partly = parts[item, 0] >= 0
        size, start = (parts[item, 1], parts[item, 0]) if partly else (ranges[mesh, 0], ranges[mesh, 1])
        if not size:
            mesh_before = -1  # the instances of a command are consecutive
            continue
        if single or state != state_before:
            run += 1
            runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3] = state, command + 1, 0, 0
            mesh_before = -1
        if partly or mesh != mesh_before or commands[command, 1] * (size // 3) >= MAX_TRIANGLES:
            command += 1
            commands[command, 0], commands[command, 1] = size, 0
            commands[command, 2], commands[command, 3] = start, ranges[mesh, 2]
            commands[command, 4] = first + i
            runs[run, 2] += 1
        commands[command, 1] += 1
        runs[run, 3] += size // 3
        state_before, mesh_before = state, -1 if partly else mesh
    return command + 1 - first_command, run + 1
