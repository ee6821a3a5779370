"""Instances and indirect draw commands of all passes of one frame: written by kernels, uploaded in few calls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.rendering.visual.drawing.draw_feed import DrawFeed
from mimics_app.rendering.visual.drawing.mesh_arena import COMMAND_WORDS, MeshArena
from mimics_app.rendering.visual.kernels.commands import Drawn, write_commands, write_instances
from mimics_app.rendering.visual.materials.material_instance import MaterialInstance
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.world.graph.entity_ids import grown

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.drawing.draw_items import DrawItems, DrawState
    from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

__all__ = ["DrawRun", "FrameBuffers"]

_INSTANCES = 1
"""Index of the instance count among the words of a command."""
_COMMAND_BYTES = 4 * COMMAND_WORDS


@dataclass(slots=True)
class DrawRun:
    """Consecutive indirect commands that share a state: one draw call. Made and changed by `FrameBuffers` alone.

    Not frozen: a frame makes thousands, and constructing a frozen one takes three times as long.

    Attributes:
        material_instance: Material and shaders, one of those that share the state.
        first: Number of the first command.
        count: Number of commands.
        triangles: Triangles of all commands.
        mirrored: True where a negative scale reversed the winding, so that clockwise faces are front faces.
        wide: True where indices have 32 bits.
        eyes: Number of eyes each instance is drawn for, in successive instances.
    """

    material_instance: MaterialInstance
    first: int
    count: int
    triangles: int
    mirrored: bool
    wide: bool
    eyes: int = 1


class FrameBuffers:
    """Instance and command buffers, reused from frame to frame, for the meshes of an arena.

    Attributes:
        instance_count: Instances written since `begin`.
        command_count: Commands written since `begin`.
        few_pixels: True for a picture of few pixels.
    """

    def __init__(self, ctx: moderngl.Context, arena: MeshArena) -> None:
        self._ctx = ctx
        self._arena = arena
        self._instances = np.zeros((256, 4, 4), np.float32)
        self._commands = np.zeros((256, COMMAND_WORDS), np.uint32)
        self._runs = np.zeros((256, 4), np.int64)
        self._buffer: moderngl.Buffer | None = None
        self._feed = rasteriser_of(ctx).member(DrawFeed)(ctx)
        self.instance_count = self.command_count = 0
        self.few_pixels = False
        self._sent = (0, 0)

    def begin(self, *, few_pixels: bool) -> None:
        """Discard the last frame, and begin one of few pixels or of many."""
        self.few_pixels = few_pixels
        self.instance_count = self.command_count = 0
        self._sent = (0, 0)
        self._feed.begin(few_pixels=few_pixels)
        self._arena.lists.begin()

    def add(
        self,
        items: I4,
        count: int,
        origin: F8,
        listed: DrawItems,
        world: F8,
        drawn: Drawn,
        *,
        shadow: bool = False,
        single: bool = False,
    ) -> list[DrawRun]:
        """Append instances and the commands that draw them.

        Args:
            items: Numbers of items in draw order, [>= count].
            count: Number of items.
            origin: Origin of the shaders' frame, world [m], [3].
            listed: The draw items.
            world: T_world_from_node per row, [rows, 4, 4].
            drawn: With what each item is drawn.
            shadow: True where they are states of the shadow pass.
            single: True for one run per item.
        """
        if not count:
            return []
        self._reserve(self.instance_count + count, self.command_count + count, count)
        first, first_command = self.instance_count, self.command_count
        write_instances(items, count, first, origin, listed.rows, world, listed.instance_params, self._instances)
        commands, runs = write_commands(items, count, first, first_command, drawn, single, self._commands, self._runs)
        self.instance_count += count
        self.command_count += commands
        of_state = listed.of_shadow if shadow else listed.of_state
        return [_run(row, of_state) for row in self._runs[:runs].tolist()]

    def double(self, runs: list[DrawRun]) -> None:
        """Draw each instance of runs that were added together for two eyes."""
        if runs:
            self._commands[runs[0].first : runs[-1].first + runs[-1].count, _INSTANCES] *= 2
        for run in runs:
            run.eyes = 2

    def upload(self) -> None:
        """Send what was added since the last upload of the frame to the GPU."""
        instances, commands = self._sent
        if self.command_count == commands:
            return
        self._arena.write_instances(self._instances[: self.instance_count], instances)
        self._arena.write_lists()
        size = self.command_count * _COMMAND_BYTES
        if self._buffer is None or self._buffer.size < size:
            self._free_buffer()
            self._buffer, commands = self._ctx.buffer(reserve=2 * size), 0
        if commands == 0:
            self._buffer.orphan()
        self._buffer.write(self._commands[commands : self.command_count], offset=commands * _COMMAND_BYTES)
        self._sent = self.instance_count, self.command_count

    def flush(self) -> None:
        """Let the driver start the draws so far, while the caller prepares the next ones."""
        self._feed.flush()

    def draw(self, run: DrawRun, shader: ShaderProgram) -> None:
        """Draw one run with a shader of its material, which is bound already."""
        array = self._arena.arrays.of(shader, run.wide, run.eyes)
        if run.mirrored:
            self._ctx.front_face = "cw"
            self._render(run, array)
            self._ctx.front_face = "ccw"
        else:
            self._render(run, array)

    def _render(self, run: DrawRun, array: moderngl.VertexArray) -> None:
        assert self._buffer is not None, "runs are drawn after upload"
        commands = self._commands[run.first : run.first + run.count]
        self._feed.draw(array, self._buffer, run.first, commands, run.eyes * run.triangles)

    def release(self) -> None:
        """Free everything."""
        self._feed.release()
        self._free_buffer()

    def _free_buffer(self) -> None:
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None

    def _reserve(self, instances: int, commands: int, runs: int) -> None:
        self._instances = grown(self._instances, instances)
        self._commands = grown(self._commands, commands)
        self._runs = grown(self._runs, runs)


def _run(row: list[int], of_state: list[DrawState]) -> DrawRun:
    state, first, count, triangles = row
    drawn = of_state[state // 2]
    return DrawRun(drawn.material_instance, first, count, triangles, bool(state % 2), drawn.wide)
