"""Projectors of a frame: their textures, volumes and the surfaces they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from mimics_app.contracts.arrays import F8, I4
from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun
from mimics_app.rendering.visual.view import compute_frustum_planes
from mimics_app.rendering.visual.view_matrices import TEXTURE_FROM_CLIP, compose_clip_from_view
from mimics_app.world.components.effects import Projector
from mimics_app.world.content.materials.material import TextureData
from mimics_app.world.content.materials.sprite_pictures import sprite_picture
from mimics_app.world.content.world import World

__all__ = ["Beam", "BeamRuns", "ProjectorField", "clip_from_projector"]


_CUBE = np.array([[*corner, 1.0] for corner in product((-1.0, 1.0), repeat=3)]).T


@dataclass(frozen=True, eq=False)
class Beam:
    """A projector in a frame.

    Attributes:
        spec: Its component in the scene.
        key: Name of its texture.
        picture: Its texture.
        texture_from_world: Projection to texture coordinates and depth in [0, 1], before the division by w; float64
            [4, 4].
        towards: Unit vector against parallel rays, and 0; or origin of the rays, world [m], and 1; float64 [4].
        planes: Planes of its volume, normals inwards, float64 [6, 4].
        corners: Corners of its volume, world [m], float64 [8, 3].
        onto: Entity indices that it affects, int32; None: all.
    """

    spec: Projector
    key: str
    picture: TextureData
    texture_from_world: F8
    towards: F8
    planes: F8
    corners: F8
    onto: I4 | None

    def is_seen(self, view_planes: F8) -> bool:
        """Return False when the whole volume is behind one plane of a view's frustum, [k, 4]."""
        depth = view_planes[:, :3] @ self.corners.T + view_planes[:, 3:]
        return not bool((depth < 0.0).all(axis=1).any())


@dataclass(frozen=True, eq=False)
class BeamRuns:
    """A projector with the surfaces of a view that it hits."""

    beam: Beam
    runs: list[DrawRun]


class ProjectorField:
    """All projectors of a world.

    Attributes:
        beams: The projectors of this frame whose nodes are shown, by the node's index.
        issues: Missing textures, each reported once; the caller removes what it reports.
    """

    def __init__(self) -> None:
        self.beams: dict[int, Beam] = {}
        self._reported: set[Issue] = set()
        self.issues: list[Issue] = []

    def update(self, world: World, *, shadows: bool) -> None:
        """Update the projectors from the world; where its `shadows` are drawn, without contact shadows."""
        shown, instead = world.transforms.shown, world.effects.contact_shadows if shadows else ()
        rows = {index: world.transforms.row(index) for index in world.effects.projectors}
        self.beams = {
            index: self._beam(world, spec, world.transforms.world[rows[index]])
            for index, spec in world.effects.projectors.items()
            if shown[rows[index]] and index not in instead
        }

    def _beam(self, world: World, spec: Projector, world_from_node: F8) -> Beam:
        pose = world_from_node.copy()
        pose[:3, :3] /= np.linalg.norm(pose[:3, :3], axis=0)
        clip = clip_from_projector(spec) @ np.linalg.inv(pose)
        towards = np.append(pose[:3, 3], 1.0) if spec.kind == "slide" else np.append(pose[:3, 2], 0.0)
        key, picture = self._picture(world, spec)
        onto = _with_below(world, spec.onto) if spec.onto else None
        cube = np.linalg.inv(clip) @ _CUBE
        corners = (cube[:3] / cube[3]).T
        return Beam(spec, key, picture, TEXTURE_FROM_CLIP @ clip, towards, compute_frustum_planes(clip), corners, onto)

    def _picture(self, world: World, spec: Projector) -> tuple[str, TextureData]:
        own = f"#{spec.shape}", sprite_picture(spec.shape)
        if spec.texture is None:
            return own
        picture = world.textures.get(spec.texture)
        if picture is not None:
            return spec.texture, picture
        issue = Issue("", "", f'projector: no texture "{spec.texture}"; a {spec.shape} is projected instead')
        if issue not in self._reported:
            self._reported.add(issue)
            self.issues.append(issue)
        return own


def clip_from_projector(spec: Projector) -> F8:
    """Return the projection from the projector's frame, float64 [4, 4]: of a box around it, or a pyramid along -z."""
    width, height = spec.size
    if spec.kind == "decal":
        return np.diag([2.0 / width, 2.0 / height, -2.0 / spec.depth, 1.0])
    up = math.tan(0.5 * spec.fov)
    across = up * width / height
    return compose_clip_from_view((-across, across, -up, up), spec.near, spec.depth)


def _with_below(world: World, names: tuple[str, ...]) -> I4:
    """Return the entity indices of nodes and all their descendants; unknown names are ignored."""
    hierarchy, capacity = world.graph.hierarchy, world.graph.store.capacity
    found = [hierarchy.subtree(world.graph.find(name), capacity) for name in names if name in world]
    return np.concatenate([np.zeros(0, np.int32), *found]).astype(np.int32)
