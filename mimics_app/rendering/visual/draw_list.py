"""What is drawn in a frame: culled, grouped and sorted sub-entities as instances and indirect draws."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.rendering.visual.materials import Look, MaterialStore
from mimics_app.rendering.visual.mesh_arena import COMMAND, MeshArena
from mimics_app.rendering.visual.view import View, compute_frustum_planes
from mimics_app.world.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["Casters", "DrawList", "DrawRun", "FrameBuffers"]

F8 = NDArray[np.float64]
Rows = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class DrawRun:
    """Consecutive indirect draws that share a look: one call to the driver.

    Attributes:
        look: Material and shaders.
        first: Index of the first command.
        count: Number of commands.
        triangles: In all of them.
        mirrored: True where a negative scale turned the faces over, so that clockwise ones are outside.
    """

    look: Look
    first: int
    count: int
    triangles: int
    mirrored: bool


@dataclass(frozen=True, eq=False)
class Casters:
    """Bounding spheres of what casts a shadow: rows of the draw list, centres [m] and radii [m] in the world."""

    rows: Rows
    centres: F8
    radii: F8


@dataclass(eq=False)
class FrameBuffers:
    """Instances and commands of all passes of one frame, gathered first and uploaded once."""

    ctx: moderngl.Context
    instances: list[NDArray[np.float32]] = field(default_factory=list)
    commands: list[NDArray[np.void]] = field(default_factory=list)
    instance_count: int = 0
    command_count: int = 0
    buffer: moderngl.Buffer | None = None

    def begin(self) -> None:
        """Forget the last frame."""
        self.instances.clear()
        self.commands.clear()
        self.instance_count = self.command_count = 0

    def add(self, instances: NDArray[np.float32], commands: NDArray[np.void]) -> int:
        """Append instances and the commands that draw them, whose `base` counts from the first of these instances.

        Returns:
            Index of the first command.
        """
        first = self.command_count
        commands["base"] += self.instance_count
        self.instances.append(instances)
        self.commands.append(commands)
        self.instance_count += len(instances)
        self.command_count += len(commands)
        return first

    def upload(self, arena: MeshArena) -> None:
        """Send the frame to the GPU."""
        if not self.command_count:
            return
        arena.write_instances(np.concatenate(self.instances))
        data = np.concatenate(self.commands).tobytes()
        if self.buffer is None or self.buffer.size < len(data):
            self.release()
            self.buffer = self.ctx.buffer(reserve=2 * len(data))
        self.buffer.orphan()
        self.buffer.write(data)

    def draw(self, arena: MeshArena, run: DrawRun, *, shadow: bool = False) -> None:
        """Issue one run with its look already bound."""
        import moderngl

        assert self.buffer is not None, "runs are drawn after upload"
        self.ctx.front_face = "cw" if run.mirrored else "ccw"
        array = arena.vertex_array(run.look.shadow_shader if shadow else run.look.shader)
        array.render_indirect(self.buffer, moderngl.TRIANGLES, run.count, first=run.first)

    def release(self) -> None:
        """Free the command buffer."""
        if self.buffer is not None:
            self.buffer.release()
            self.buffer = None


class DrawList:
    """The world's sub-entities as arrays, refreshed when the world's structure changes."""

    def __init__(self, arena: MeshArena, materials: MaterialStore) -> None:
        self._arena = arena
        self._materials = materials
        self._revision: int | None = None
        self._looks: list[Look] = []
        self._matrices: F8 = np.zeros((0, 4, 4))
        self._centres: F8 = np.zeros((0, 3))
        self._radii: F8 = np.zeros(0)

    def update(self, world: World, *, placed_lights: bool) -> None:
        """Take over structure where it changed, and this frame's transforms always.

        Args:
            world: What is drawn.
            placed_lights: True when a point or spot light shines.
        """
        meshes = self._arena.update(world)
        materials = self._materials.update(world, placed_lights=placed_lights)
        listed = world.subentities()
        if meshes or materials or listed.revision != self._revision:
            self._take_structure(world)
            self._revision = listed.revision
        self._visible = np.asarray(listed.visible, np.bool_) & self._drawable
        self._matrices = world.transforms.world[self._node_rows]
        self._mirrored = np.linalg.det(self._matrices[:, :3, :3]) < 0.0
        turned = np.einsum("nij,nj->ni", self._matrices[:, :3, :3], self._local_centres)
        self._centres = turned + self._matrices[:, :3, 3]
        # The Frobenius norm bounds the largest stretch also where parents' scales shear their children.
        scale = np.sqrt(np.einsum("nij,nij->n", self._matrices[:, :3, :3], self._matrices[:, :3, :3]) / 3.0)
        stretch = np.maximum(scale, np.linalg.norm(self._matrices[:, :3, :3], axis=1).max(axis=1, initial=0.0))
        self._radii = self._local_radii * np.where(self._rigid(stretch), stretch, scale * np.sqrt(3.0))

    def casters(self, longest: float) -> Casters:
        """What casts shadows, and the spheres a shadow map has to hold.

        Args:
            longest: Bodies of a radius beyond this [m] are left out of the spheres: grounds and skies.
        """
        rows = np.flatnonzero(self._visible & self._casting)
        held = rows[self._radii[rows] <= longest]
        return Casters(rows, self._centres[held], self._radii[held])

    def batch_casters(self, frame: FrameBuffers, casters: Casters, origin: F8) -> list[DrawRun]:
        """Queue the shadow pass: instances relative to `origin` [m], grouped by look and mesh."""
        rows = casters.rows
        order = np.lexsort((self._mesh_ids[rows], self._mirrored[rows], self._look_ids[rows]))
        return self._queue(frame, rows[order], origin, split=False)

    def batch_view(self, frame: FrameBuffers, view: View) -> tuple[list[DrawRun], list[DrawRun]]:
        """Queue what is in a view's frustum.

        Returns:
            Opaque runs, grouped by look and mesh with the nearest groups first, and blended runs, far to near.
        """
        rows = np.flatnonzero(self._in_frustum(view))
        away = np.linalg.norm(self._centres[rows] - view.eye_world, axis=1)
        blended = self._transparent[rows]
        far_first = rows[blended][np.argsort(-away[blended], kind="stable")]
        solid, away = rows[~blended], away[~blended]
        nearest = np.full(len(self._looks), np.inf)
        np.minimum.at(nearest, self._look_ids[solid], away)
        looks = self._look_ids[solid]
        near_first = solid[np.lexsort((away, self._mesh_ids[solid], self._mirrored[solid], looks, nearest[looks]))]
        opaque = self._queue(frame, near_first, view.eye_world, split=False)
        return opaque, self._queue(frame, far_first, view.eye_world, split=True)

    def _take_structure(self, world: World) -> None:
        listed, arena = world.subentities(), self._arena
        names = list(dict.fromkeys(listed.material))
        meshes = list(dict.fromkeys(listed.mesh))
        look_id = {name: index for index, name in enumerate(names)}
        mesh_id = {name: index for index, name in enumerate(meshes)}
        self._looks = [self._materials.look(name) for name in names]
        self._ranges = [arena.ranges.get(name) for name in meshes]
        self._node_rows = np.asarray(listed.row, np.intp)
        self._look_ids = np.array([look_id[name] for name in listed.material], np.intp)
        self._mesh_ids = np.array([mesh_id[name] for name in listed.mesh], np.intp)
        known = [world.meshes.get(name) for name in listed.mesh]
        self._drawable = np.array([mesh is not None and mesh.indices.size > 0 for mesh in known], np.bool_)
        self._local_centres = np.array([mesh.centre if mesh else np.zeros(3) for mesh in known]).reshape(-1, 3)
        self._local_radii = np.array([mesh.radius if mesh else 0.0 for mesh in known])
        self._transparent = np.array([self._looks[index].transparent for index in self._look_ids], np.bool_)
        self._casting = np.asarray(listed.casts_shadow, np.bool_)

    def _rigid(self, stretch: F8) -> NDArray[np.bool_]:
        axes = self._matrices[:, :3, :3]
        gram = np.einsum("nki,nkj->nij", axes, axes)
        gram[:, range(3), range(3)] = 0.0
        return np.asarray(np.abs(gram).max(axis=(1, 2), initial=0.0) < 1e-9 * np.maximum(stretch, 1e-300) ** 2)

    def _in_frustum(self, view: View) -> NDArray[np.bool_]:
        planes = compute_frustum_planes(view.clip_from_world)
        depths = self._centres @ planes[:, :3].T + planes[:, 3]
        return np.asarray(self._visible & (depths >= -self._radii[:, None]).all(axis=1))

    def _queue(self, frame: FrameBuffers, order: Rows, origin: F8, *, split: bool) -> list[DrawRun]:
        """Turn sorted rows into instances, commands and runs; `split` gives each row its own command."""
        if not len(order):
            return []
        instances = self._matrices[order, :3, :]
        instances[:, :, 3] -= origin
        states, meshes = 2 * self._look_ids[order] + self._mirrored[order], self._mesh_ids[order]
        new = np.ones(len(order), np.bool_)
        if not split:
            new[1:] = (states[1:] != states[:-1]) | (meshes[1:] != meshes[:-1])
        starts = np.flatnonzero(new)
        commands = self._commands(starts, meshes[starts], len(order))
        first = frame.add(instances.astype(np.float32), commands)
        return self._group(first, commands, states[starts], split=split)

    def _commands(self, starts: Rows, meshes: Rows, total: int) -> NDArray[np.void]:
        commands = np.zeros(len(starts), COMMAND)
        commands["base"] = starts
        commands["instances"] = np.diff(np.append(starts, total))
        for index, mesh in enumerate(meshes):
            place = self._ranges[mesh]
            if place is not None:
                commands[index]["count"], commands[index]["first"] = place.count, place.first
                commands[index]["base_vertex"] = place.base_vertex
        return commands

    def _group(self, first: int, commands: NDArray[np.void], states: Rows, *, split: bool) -> list[DrawRun]:
        """Runs of commands whose state (look and winding) is one."""
        runs: list[DrawRun] = []
        triangles = commands["count"].astype(np.int64) * commands["instances"] // 3
        begin = 0
        for index in range(1, len(states) + 1):
            if index < len(states) and not split and states[index] == states[begin]:
                continue
            look, mirrored = self._looks[states[begin] // 2], bool(states[begin] % 2)
            runs.append(DrawRun(look, first + begin, index - begin, int(triangles[begin:index].sum()), mirrored))
            begin = index
        return runs
