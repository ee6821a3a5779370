"""ModelPrefab: creates instances of a model's nodes, meshes, lights and cameras, which share its data."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from mimics_app.world.content.world import DEFAULT_MATERIAL, World
from mimics_app.world.files.gltf.file import GltfDocument
from mimics_app.world.files.scene.assets import ModelPart
from mimics_app.world.graph.scene_node import SceneNode

__all__ = ["ModelPrefab"]


class ModelPrefab:
    """Part of a glTF file that can be instantiated in a world.

    Args:
        part: Nodes with their subtrees, or one mesh.
        material: Key of a material of the world that replaces the model's own, or None.
    """

    def __init__(self, part: ModelPart, material: str | None = None) -> None:
        self._part = part
        self._material = material

    @property
    def document(self) -> GltfDocument:
        """The glTF file."""
        return self._part.model

    def mesh_name(self, key: str) -> str:
        """Return the file's name of a mesh of the world; "" where it has none or is not of this file."""
        own = key.split("@")[0]
        for number, mesh in enumerate(self._part.model.meshes):
            if any(self._mesh_key(number, k) == own for k in range(len(mesh.primitives))):
                return mesh.name
        return ""

    def instantiate(self, world: World, node: SceneNode) -> list[SceneNode]:
        """Create an instance on a node; return it and all new nodes.

        A single node of the file becomes `node` (its transform in the file is ignored); the nodes of a whole model
        become children of it. New nodes are named "node/Name"; those without a name, or with one that is taken,
        have none.
        """
        self._load(world)
        part, model = self._part, self._part.model
        if part.mesh is not None:
            self._show(world, node, part.mesh)
            return [node]
        made: dict[int, SceneNode] = {}
        if part.node is not None:
            made[part.node] = node
            self._fill(world, node, part.node)
        for index in part.members:
            if index not in made:
                made[index] = self._create(world, self._above(made, node, index), node.name, index)
        if model.moves:
            self._set_in_motion(world, node, made)
        return [node, *(each for each in made.values() if each != node)]

    def _above(self, made: dict[int, SceneNode], node: SceneNode, index: int) -> SceneNode:
        """Return the parent in the world of a node of the file."""
        above = self._part.model.nodes[index].parent
        return made.get(-1 if above is None else above, node)

    def _create(self, world: World, parent: SceneNode, prefix: str, index: int) -> SceneNode:
        child = self._create_bare(world, parent, prefix, index)
        self._fill(world, child, index)
        return child

    def _create_bare(self, world: World, parent: SceneNode, prefix: str, index: int) -> SceneNode:
        source = self._part.model.nodes[index]
        name = f"{prefix}/{source.name}" if source.name else ""
        child = parent.create_child("" if name in world else name, source.translation, source.rotation, source.scale)
        child.visible = source.visible
        return child

    def _set_in_motion(self, world: World, node: SceneNode, made: dict[int, SceneNode]) -> None:
        """Create the animator and the deformable bodies of an instance."""
        from mimics_app.world.files.gltf.bending import bind_body, make_animator, missing_joints

        model = self._part.model
        for index in missing_joints(model, made):
            made[index] = self._create_bare(world, self._above(made, node, index), node.name, index)
        animator = make_animator(model, made, self._part.node)
        if animator is None:
            return
        world.motion.add(node.index, animator)
        for index, child in made.items():
            if model.bends(index):
                body = bind_body(model, index, made, animator, partial(self._own_key, child))
                for key, mesh in body.meshes.items():
                    world.set_mesh(key, mesh)
                world.motion.add_body(body)
                self._show_node(world, child, index, child)

    def _fill(self, world: World, node: SceneNode, index: int) -> None:
        model, source = self._part.model, self._part.model.nodes[index]
        if source.mesh is not None and not model.bends(index):
            self._show_node(world, node, index)
        if source.occluder is not None and node.index not in world.content.occluders:
            centre, size = source.occluder
            world.content.occluders.add(node.index, centre=centre, size=size)
        light = None if source.light is None else model.lights[source.light]
        if light is not None and node.light is None:
            node.create_light(
                light.kind,
                colour=light.colour,
                intensity=light.intensity,
                range=light.range,
                inner_cone=light.inner_cone,
                outer_cone=light.outer_cone,
            )
        camera = None if source.camera is None else model.cameras[source.camera]
        if camera is not None and node.camera is None:
            node.create_camera(camera.vertical_fov, camera.near, camera.far)

    def _show_node(self, world: World, node: SceneNode, index: int, owner: SceneNode | None = None) -> None:
        """Show the mesh of a node of the file with its levels of detail; `owner` has meshes of its own."""
        source = self._part.model.nodes[index]
        if source.levels:
            self._show_levels(world, node, index, owner)
        elif source.mesh is not None:
            self._show(world, node, source.mesh, owner)

    def _show(self, world: World, node: SceneNode, mesh: int, owner: SceneNode | None = None) -> None:
        parts = self._parts(mesh, owner)
        if parts:
            node.show(parts)

    def _show_levels(self, world: World, node: SceneNode, index: int, owner: SceneNode | None) -> None:
        """Show all levels of detail of a node with its own transform; theirs in the file are ignored."""
        source, nodes = self._part.model.nodes[index], self._part.model.nodes
        meshes = [source.mesh, *(nodes[level].mesh for level in source.levels)]
        levels = [[] if mesh is None else self._parts(mesh, owner) for mesh in meshes]
        halved = [*(0.25 ** (k + 1) for k in range(len(levels) - 1)), 0.0]
        world.content.add_levels(node.index, levels, source.coverages or halved)

    def _parts(self, mesh: int, owner: SceneNode | None = None) -> list[tuple[str, str]]:
        return [
            (
                self._mesh_key(mesh, number) if owner is None else self._own_key(owner, mesh, number),
                self._material or self._material_key(primitive.material),
            )
            for number, primitive in enumerate(self._part.model.meshes[mesh].primitives)
        ]

    def _load(self, world: World) -> None:
        """Put the file's meshes, textures and materials into the world, once per file."""
        model, asset = self._part.model, self._part.asset.id
        static = self._static_meshes()
        for i, mesh in enumerate(model.meshes):
            for number, primitive in enumerate(mesh.primitives if i in static else ()):
                if world.meshes.get(self._mesh_key(i, number)) is not primitive.mesh:
                    world.set_mesh(self._mesh_key(i, number), primitive.mesh)
        for key, texture in model.textures.items():
            world.textures[f"{asset}#{key}"] = texture
        for i, material in enumerate(model.materials):
            keys: dict[str, Any] = {f"{which}_texture": f"{asset}#{key}" for which, key in material.textures.items()}
            own = replace(material, name=self._material_key(i), **keys)
            if world.materials.get(own.name) != own:
                world.set_material(own)

    def _mesh_key(self, mesh: int, primitive: int) -> str:
        return f"{self._part.asset.id}#{mesh}/{primitive}"

    def _static_meshes(self) -> set[int]:
        """Return the meshes that are shown undeformed."""
        model = self._part.model
        if not model.moves:
            return set(range(len(model.meshes)))
        if self._part.mesh is not None:
            return {self._part.mesh}
        from mimics_app.world.files.gltf.bending import unbent_meshes

        return unbent_meshes(model)

    def _own_key(self, owner: SceneNode, mesh: int, primitive: int) -> str:
        """Return the key of a deformable mesh, which every node that shows it has a copy of."""
        return f"{self._mesh_key(mesh, primitive)}@{owner.index}"

    def _material_key(self, material: int | None) -> str:
        if material is None:
            return DEFAULT_MATERIAL
        return f"{self._part.asset.id}#{self._part.model.materials[material].name}"
