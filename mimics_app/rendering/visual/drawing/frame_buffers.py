"""Instances and indirect draw commands of all passes of one frame: written by kernels, uploaded in few calls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8, I4, U1
from mimics_app.rendering.visual.drawing.mesh_arena import COMMAND_WORDS, MeshArena
from mimics_app.rendering.visual.kernels.commands import MAX_TRIANGLES, write_commands, write_instances
from mimics_app.rendering.visual.materials.look import Look
from mimics_app.rendering.visual.surfaces.fence import Fence
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of
from mimics_app.rendering.visual.surfaces.raw_gl import TRIANGLES, RawGL
from mimics_app.world.entity_ids import grown

if TYPE_CHECKING:
    import moderngl

    from mimics_app.rendering.visual.drawing.draw_items import DrawItems, DrawState
    from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

__all__ = ["MAX_TRIANGLES_OF_FEW_PIXELS", "DrawRun", "FrameBuffers"]

MAX_TRIANGLES_OF_FEW_PIXELS = 2_000
"""Number of triangles after which a flush follows in a small picture, which one thread rasterises (decision 118)."""
_FLUSHES_APART = 16
"""Number of flushes after each of which the driver is waited for up to the one before: once 64 are pending, llvmpipe
never draws ahead again."""

_INSTANCES = 1
"""Index of the instance count among the words of a command."""
_COMMAND_BYTES = 4 * COMMAND_WORDS


@dataclass(slots=True)
class DrawRun:
    """Consecutive indirect commands that share a state: one draw call. Made and changed by `FrameBuffers` alone.

    Not frozen: a frame makes thousands, and constructing a frozen one takes three times as long.

    Attributes:
        look: Material and shaders, one of those that share the state.
        first: Number of the first command.
        count: Number of commands.
        triangles: Triangles of all commands.
        mirrored: True where a negative scale reversed the winding, so that clockwise faces are front faces.
        wide: True where indices have 32 bits.
        eyes: Number of eyes each instance is drawn for, in successive instances.
    """

    look: Look
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
        self._raw = RawGL(ctx) if rasteriser_of(ctx).defers else None
        self._fence = Fence(ctx)
        self._waiting, self._most_waiting, self._flushes = 0, MAX_TRIANGLES, 0
        self.instance_count = self.command_count = 0
        self.few_pixels = False
        self._sent = (0, 0)

    def begin(self, *, few_pixels: bool) -> None:
        """Discard the last frame; a picture of few pixels is flushed more often."""
        self.few_pixels = few_pixels
        self._most_waiting = MAX_TRIANGLES_OF_FEW_PIXELS if few_pixels else MAX_TRIANGLES
        self.instance_count = self.command_count = self._waiting = 0
        self._sent = (0, 0)
        if self._arena.seen is not None:
            self._arena.seen.begin()

    def add(
        self,
        items: I4,
        count: int,
        origin: F8,
        listed: DrawItems,
        world: F8,
        states: I4,
        mirrored: U1,
        parts: I4,
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
            states: State of each item before mirroring, [n].
            mirrored: 1 where the winding of an item's faces is reversed, [n].
            parts: First index and number of indices of each item's triangles, -1 for all of them; [n, 2].
            shadow: True where they are states of the shadow pass.
            single: True for one run per item.
        """
        if not count:
            return []
        self._reserve(self.instance_count + count, self.command_count + count, count)
        first, first_command = self.instance_count, self.command_count
        write_instances(items, count, first, origin, listed.rows, world, listed.paint, self._instances)
        commands, runs = write_commands(
            items,
            count,
            first,
            first_command,
            states,
            mirrored,
            listed.meshes,
            listed.ranges,
            parts,
            single,
            self._commands,
            self._runs,
        )
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
        self._arena.write_seen()
        size = self.command_count * _COMMAND_BYTES
        if self._buffer is None or self._buffer.size < size:
            self.release()
            self._buffer, commands = self._ctx.buffer(reserve=2 * size), 0
        if commands == 0:
            self._buffer.orphan()
        self._buffer.write(self._commands[commands : self.command_count], offset=commands * _COMMAND_BYTES)
        self._sent = self.instance_count, self.command_count

    def flush(self) -> None:
        """Let a software driver start the draws so far, while the caller prepares the next ones."""
        if self._raw is None:
            return
        self._flushes = (self._flushes + 1) % _FLUSHES_APART
        self._raw.flush()
        self._waiting = 0
        if self._flushes == 0:
            self._fence.wait()
            self._fence.set()

    def draw(self, run: DrawRun, shader: ShaderProgram) -> None:
        """Draw one run with a shader of its look, which is bound already."""
        array = self._arena.arrays.of(shader, run.wide, run.eyes)
        if run.mirrored:
            self._ctx.front_face = "cw"
            self._render(run, array)
            self._ctx.front_face = "ccw"
        else:
            self._render(run, array)

    def _render(self, run: DrawRun, array: moderngl.VertexArray) -> None:
        """Draw one run, in parts with flushes between them where many triangles are waiting."""
        assert self._buffer is not None, "runs are drawn after upload"
        waiting = self._waiting + run.eyes * run.triangles
        if self._raw is None or waiting < self._most_waiting or run.count == 1:
            self._waiting = waiting
            array.render_indirect(self._buffer, TRIANGLES, run.count, first=run.first)
            if waiting >= self._most_waiting:
                self.flush()
            return
        for first, count in self._split(run):
            array.render_indirect(self._buffer, TRIANGLES, count, first=first)
            if self._waiting >= self._most_waiting:
                self.flush()

    def _split(self, run: DrawRun) -> Iterator[tuple[int, int]]:
        """Yield first command and number of commands of each part of a run; counts the triangles since the last flush.

        A software driver transforms vertices in one thread and rasterises in others, which start at a flush or at the
        end of the frame: flushing in between lets a large frame do both at once.
        """
        commands = self._commands[run.first : run.first + run.count].astype(np.int64)
        begun = 0
        for number, triangles in enumerate((commands[:, 0] // 3 * commands[:, _INSTANCES]).tolist(), 1):
            self._waiting += triangles
            if self._waiting >= self._most_waiting or number == run.count:
                yield run.first + begun, number - begun
                begun = number

    def release(self) -> None:
        """Free the command buffer and the fence."""
        self._fence.release()
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
    return DrawRun(drawn.look, first, count, triangles, bool(state % 2), drawn.wide)
