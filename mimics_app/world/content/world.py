"""World: scene graph, components and assets of the running scene, updated at each frame's end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import require_key
from mimics_app.world.components.pictures import Inset, Mirror, Screen
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.effects import Effects
from mimics_app.world.content.environment import Sky
from mimics_app.world.content.following import Follower
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.content.materials.technique import TechniqueSpec
from mimics_app.world.content.meshes.mesh import MeshData
from mimics_app.world.content.meshes.mesh_buffer import MeshBuffer
from mimics_app.world.content.motion.motion import Motion
from mimics_app.world.graph.camera import Camera
from mimics_app.world.graph.light import Light
from mimics_app.world.graph.node_tables import Content
from mimics_app.world.graph.render_list import RenderList
from mimics_app.world.graph.scene_graph import SceneGraph
from mimics_app.world.graph.scene_node import SceneNode
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["DEFAULT_MATERIAL", "World"]

DEFAULT_MATERIAL = "default"
"""Name of the plain grey material every world has."""


class World:
    """Nodes, their components, and the meshes, materials and textures they show.

    Attributes:
        graph: Structure, names and transforms.
        content: Component tables.
        effects: Billboards, particles and projectors on nodes, and their time.
        motion: Animators of models, skinned and morphed bodies, and their time.
        meshes: By key; replace one with `replace_mesh` or change it through `open_mesh`, so that renderers see it.
        meshes_published: Number of times a mesh was replaced or changed.
        materials: By key; change one with `set_material`.
        textures: By key.
        techniques: Further techniques of materials, by name.
        environment: The sky.
        cords: By name of the node at their first end.
        mirrors, screens, insets: Views of the world itself, by name of the node (`world.live_pictures`).
        followers: Nodes that keep their place beside another one, by name.
        cut_to: Name of the camera that a scenario shows in the place of the chosen view; "": none.
    """

    def __init__(self) -> None:
        self.graph = SceneGraph()
        self.content = Content()
        self.effects = Effects(self.graph)
        self.motion = Motion()
        self.meshes: dict[str, MeshData] = {}
        self.materials: dict[str, Material] = {DEFAULT_MATERIAL: Material(DEFAULT_MATERIAL)}
        self.textures: dict[str, TextureData] = {}
        self.techniques: dict[str, TechniqueSpec] = {}
        self.environment = Sky()
        self.cords: dict[str, Cord] = {}
        self.mirrors: dict[str, Mirror] = {}
        self.screens: dict[str, Screen] = {}
        self.insets: dict[str, Inset] = {}
        self.followers: dict[str, Follower] = {}
        self.cut_to = ""
        self._mesh_revisions: dict[str, int] = {}
        self.meshes_published = 0
        self._mesh_buffers: dict[str, MeshBuffer] = {}
        self._order = self.transforms.revision
        self._render_list = self.content.refresh(None, self.transforms, moved=True)

    @property
    def transforms(self) -> TransformTable:
        """The Transform table: `world` matrices, bulk setters."""
        return self.graph.transforms

    @property
    def root(self) -> SceneNode:
        """Root node of the scene graph."""
        return self.node(self.graph.root)

    def create_node(self, name: str = "", parent: SceneNode | None = None) -> SceneNode:
        """Create a node below `parent` (default: the root).

        Raises:
            ValueError: another node has that name.
        """
        return self.node(self.graph.create(name, self.graph.root if parent is None else parent.index))

    def find(self, name: str) -> SceneNode:
        """Return a node by name.

        Raises:
            KeyError: there is none; the message names the nearest.
        """
        return self.node(self.graph.find(name))

    def __contains__(self, name: str) -> bool:
        """True when a node has that name."""
        return name in self.graph

    def node(self, index: int) -> SceneNode:
        """Return a handle on the node that has this entity index now."""
        return SceneNode(self, self.graph.store.id_of(index))

    @property
    def lights(self) -> list[Light]:
        """Every light whose node is in the scene."""
        return [Light(self, self.graph.store.id_of(index)) for index in self._attached(self.content.lights.entities)]

    @property
    def cameras(self) -> list[Camera]:
        """Every camera whose node is in the scene."""
        return [Camera(self, self.graph.store.id_of(index)) for index in self._attached(self.content.cameras.entities)]

    def eye(self, name: str = "") -> SceneNode | None:
        """Return the node at the person's eyes: that of a name, else of the first camera; None in a scene without one.

        Sound, attention of models and their levels of motion go by it, whichever view is shown.
        """
        if name in self:
            return self.find(name)
        cameras = self.cameras
        return self.node(cameras[0].index) if cameras else None

    def update(self) -> int:
        """The frame's end: apply structural edits, then all world matrices in one pass; returns the rows computed."""
        gone = self.graph.apply_edits()
        if gone.size:
            self.content.drop(gone)
            self.effects.remove(gone.tolist())
            for index in gone.tolist():
                self.forget_motion(index)
        self.motion.pose(self.transforms)
        for follower in self.followers.values():
            follower.step(self.graph, self.motion.time)
        computed = self.transforms.update()
        self.motion.follow(self.transforms)
        moved = self._order != self.transforms.revision
        self._order = self.transforms.revision
        self._render_list = self.content.refresh(self._render_list, self.transforms, moved=moved)
        return computed

    def subentities(self) -> RenderList:
        """Return the render list as of the last update."""
        return self._render_list

    def mesh_revision(self, name: str) -> int:
        """Changes when the data of a mesh is replaced."""
        return self._mesh_revisions.get(name, 0)

    def replace_mesh(self, name: str, mesh: MeshData) -> None:
        """Put new data under a mesh's key, or add it.

        Raises:
            ValueError: the data is not a mesh (see `MeshData.validated`).
        """
        self.set_mesh(name, mesh.validated())

    def set_mesh(self, name: str, mesh: MeshData) -> None:
        """Put validated data under a mesh's key, or add it."""
        self._mesh_buffers.pop(name, None)
        self._publish(name, mesh)

    def open_mesh(self, name: str) -> MeshBuffer:
        """Return the buffers of a mesh, to change it range by range; the same ones until it is replaced.

        Raises:
            KeyError: the world has no such mesh; the message names the nearest.
            ValueError: the data is not a mesh (see `MeshData.validated`).
        """
        self.require_mesh(name)
        if name not in self._mesh_buffers:
            revision = self.mesh_revision(name) + 1
            buffer = MeshBuffer(self.meshes[name], revision, lambda own: self._rewrite(name, own))
            self._mesh_buffers[name] = buffer
            self._publish(name, buffer.mesh)
        return self._mesh_buffers[name]

    def opened_mesh(self, name: str) -> MeshBuffer | None:
        """Return the buffers of a mesh that `open_mesh` opened; None for any other."""
        return self._mesh_buffers.get(name)

    def forget_motion(self, index: int) -> None:
        """Remove the animator and deformable body of a node, with the meshes made for them alone."""
        gone = self.motion.remove([index])
        for name in gone:
            self.meshes.pop(name, None)
        self.meshes_published += bool(gone)

    def mesh_bounds(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the bounding box of a mesh in its node's frame, as deformed now: minimum and maximum [m], [3] each."""
        body = self.motion.body_of.get(name)
        return self.meshes[name].bounds if body is None else body.bounds

    def mesh_positions(self, name: str) -> NDArray[np.float64]:
        """Return the vertices of a mesh in its node's frame, as deformed now [m], float64 [n, 3]."""
        mesh, body = self.meshes[name], self.motion.body_of.get(name)
        if body is None:
            return mesh.positions.astype(np.float64)
        from mimics_app.world.content.motion.posing import posed_positions

        return posed_positions(mesh, body)

    def set_material(self, material: Material) -> None:
        """Add a material, or change the one of that name."""
        self.materials[material.name] = material

    def require_mesh(self, name: str) -> None:
        """Raise a KeyError that names the nearest when the world has no such mesh."""
        require_key(name, self.meshes, "mesh")

    def require_material(self, name: str) -> None:
        """Raise a KeyError that names the nearest when the world has no such material."""
        require_key(name, self.materials, "material")

    def _rewrite(self, name: str, buffer: MeshBuffer) -> int:
        """Publish the mesh of a buffer, unless another mesh has replaced it; return the revision."""
        if self._mesh_buffers.get(name) is buffer:
            self._publish(name, buffer.mesh)
        return self.mesh_revision(name)

    def _publish(self, name: str, mesh: MeshData) -> None:
        self.meshes[name] = mesh
        self._mesh_revisions[name] = self.mesh_revision(name) + 1
        self.meshes_published += 1

    def _attached(self, indices: NDArray[np.int32]) -> list[int]:
        return [index for index in indices.tolist() if not self.graph.is_detached(index)]
