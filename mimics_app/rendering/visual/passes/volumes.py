"""Stencil shadows of the sun: shadow volumes counted by depth fail."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.rendering.visual.drawing.draw_items import DrawItems
from mimics_app.rendering.visual.drawing.t_junctions import unmatched_edges
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary, ShaderProgram
from mimics_app.rendering.visual.materials.vertex_arrays import VertexArrays, bare_arrays
from mimics_app.rendering.visual.passes.eye_passes import EyePass
from mimics_app.rendering.visual.surfaces.raw_gl import NOT_EQUAL, RawGL
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["VolumePass", "VolumeSource", "extrude"]


_BIAS = (0.05, 8.0)
"""Depth bias of volumes behind their casters, as slopes per pixel and smallest depth steps: a cap in front of its own
surface would shadow it. More than rounding needs would displace the shadows' edges."""

_SAME_LIGHT = 1e-4
"""Largest rotation of the light in a body's frame for which its volume is reused [rad]."""


_WELD = 1e-6
"""Distance over the mesh's size within which vertices are welded."""


class VolumeSource:
    """A mesh with welded vertices: normals and texture coordinates split vertices, silhouettes must not.

    Attributes:
        points: Its distinct positions [m], float64 [p, 3].
        triangles: Numbers of points, int64 [n, 3], without degenerate triangles.
        closed: True where every directed edge has its counterpart.
    """

    def __init__(self, mesh: MeshData) -> None:
        positions = mesh.positions.astype(np.float64)
        cell = max(float(np.ptp(positions, axis=0).max(initial=0.0)) * _WELD, 1e-12)
        keys = np.round((positions - positions.min(axis=0, initial=np.inf)) / cell).astype(np.int64)
        _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        self.points = positions[first]
        triangles = number.reshape(-1)[mesh.indices.reshape(-1, 3).astype(np.int64)]
        a, b, c = triangles.T
        self.triangles = triangles[(a != b) & (b != c) & (c != a)]
        self.closed = len(unmatched_edges(self.triangles)) == 0


def extrude(source: VolumeSource, towards_light: F8) -> F4:
    """Return the shadow volume of a mesh under directional light.

    Triangles that face the light are the cap; their silhouette edges are extruded to infinity. Under directional light
    all points at infinity coincide, so that there is no far cap (Everitt and Kilgard 2002). Of an open mesh, triangles
    that face away cast as well, with reversed winding.

    Args:
        source: The mesh.
        towards_light: Direction to the light in the mesh's frame, of any length, float64 [3].

    Returns:
        Vertices of triangles that face outwards, homogeneous, float32 [3 m, 4]; w is 0 at infinity.
    """
    vertices = source.points[source.triangles]
    facing = np.cross(vertices[:, 1] - vertices[:, 0], vertices[:, 2] - vertices[:, 0]) @ towards_light
    lit = source.triangles[facing > 0.0]
    if not source.closed:
        lit = np.concatenate([lit, source.triangles[facing < 0.0][:, ::-1]])
    edges = unmatched_edges(lit)
    cap = np.ones((3 * len(lit), 4), np.float32)
    cap[:, :3] = source.points[lit.reshape(-1)]
    sides = np.ones((len(edges), 3, 4), np.float32)
    # An edge a, b of its triangle gives a side b, a, infinity, counter-clockwise seen from outside.
    sides[:, 0, :3], sides[:, 1, :3] = source.points[edges[:, 1]], source.points[edges[:, 0]]
    sides[:, 2] = (*(-towards_light), 0.0)
    return np.concatenate([cap, sides.reshape(-1, 4)])


class VolumePass:
    """Draws the shadow volumes of all casters, and darkens or excludes what they cover.

    Volumes are extruded per body on the processor and kept while the light does not move in the body's frame.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self.gl = RawGL(ctx)
        self._ctx, self._shaders = ctx, shaders
        self._shader = shaders.program("volume/volume.vert", "volume/volume.frag")
        self._darken = shaders.program("post/screen.vert", "volume/darken.frag")
        self._sources: dict[str, tuple[MeshData, VolumeSource]] = {}
        self._kept: dict[int, _Volume] = {}
        self._screen = bare_arrays(ctx)

    def count(
        self,
        target: moderngl.Framebuffer,
        world: World,
        items: DrawItems,
        views: Sequence[View],
        lighting: Lighting,
        eyes: EyePass,
    ) -> int:
        """Count the volumes into the target's cleared stencil; its depth has all receivers.

        Blended surfaces have no volume; those with alpha test cast as a whole.

        Args:
            target: The framebuffer in use.
            world: The world.
            items: Its sub-entities.
            views: One view, or two that are drawn in one pass.
            lighting: Light of the frame.
            eyes: Eyes to draw.

        Returns:
            Draw calls made.
        """
        import moderngl

        ctx, listed = self._ctx, world.subentities()
        shader = self._shaders.also_with(self._shader, eyes.defines)
        ctx.enable_only(moderngl.DEPTH_TEST)
        ctx.front_face = "ccw"
        self.gl.count_faces()
        target.depth_mask = False
        ctx.polygon_offset = _BIAS
        casting = np.flatnonzero(listed.visible & items.casting & ~items.transparent)
        drawn = 0
        for item in casting.tolist():
            world_from_node = world.transforms.world[listed.row[item]]
            volume = self._volume(item, listed.mesh[item], world, world_from_node, lighting.sun_direction)
            if volume is not None:
                clip = [view.clip_from_eye @ _eye_from_node(world_from_node, view) for view in views]
                shader.set_array("clip_from_volume", np.stack([each.T for each in clip]).astype(np.float32))
                volume.arrays.of(shader).render(moderngl.TRIANGLES, instances=eyes.instances)
                drawn += 1
        ctx.polygon_offset = (0.0, 0.0)
        target.depth_mask = True
        self.gl.draw_everywhere()
        return drawn

    def darken(self, tone: float) -> int:
        """Multiply the display values in shadow by `tone`; return the draw calls."""
        import moderngl

        ctx = self._ctx
        self._darken.set_number("tone", tone)
        ctx.enable_only(moderngl.BLEND)
        ctx.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        self.gl.draw_where(NOT_EQUAL)
        self._screen.of(self._darken).render(moderngl.TRIANGLES, vertices=3)
        self.gl.draw_everywhere()
        return 1

    def release(self) -> None:
        """Free all volumes and buffers."""
        for volume in self._kept.values():
            volume.release()
        self._kept.clear()
        self._screen.release()
        self.gl.release()

    def _volume(self, item: int, name: str, world: World, world_from_node: F8, towards: F8) -> _Volume | None:
        mesh = world.meshes.get(name)
        if mesh is None:
            return None
        # A direction transforms into the node's frame by the inverse of the matrix.
        local = np.asarray(np.linalg.solve(world_from_node[:3, :3], towards), np.float64)
        local = local / np.linalg.norm(local)
        kept = self._kept.get(item)
        if kept is not None and kept.fits(mesh, local):
            return kept
        if kept is not None:
            kept.release()
        known = self._sources.get(name)
        if known is None or known[0] is not mesh:
            known = self._sources[name] = (mesh, VolumeSource(mesh))
        self._kept[item] = _Volume(self._ctx, mesh, local, extrude(known[1], local))
        return self._kept[item]


class _Volume:
    """A volume on the GPU, with the mesh and light direction it was made for."""

    def __init__(self, ctx: moderngl.Context, mesh: MeshData, light: F8, vertices: F4) -> None:
        self._mesh, self._light = mesh, light
        self._buffer = ctx.buffer(vertices.tobytes() or bytes(16))
        self.arrays = VertexArrays(partial(_vertex_array, ctx, self._buffer))

    def fits(self, mesh: MeshData, light: F8) -> bool:
        """Whether the volume can be reused."""
        return self._mesh is mesh and float(np.linalg.norm(light - self._light)) <= _SAME_LIGHT

    def release(self) -> None:
        """Free buffer and vertex arrays."""
        self.arrays.release()
        self._buffer.release()


def _vertex_array(ctx: moderngl.Context, buffer: moderngl.Buffer, shader: ShaderProgram) -> moderngl.VertexArray:
    return ctx.vertex_array(shader.program, [(buffer, "4f", "in_corner")])


def _eye_from_node(world_from_node: F8, view: View) -> F8:
    eye_from_node = world_from_node.copy()
    eye_from_node[:3, 3] -= view.eye_world
    return eye_from_node
