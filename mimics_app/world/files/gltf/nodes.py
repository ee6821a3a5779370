"""Nodes, cameras and lights of a glTF file: one tree, checked without recursion."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from types import NoneType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from mimics_app.contracts.arrays import Vec3
from mimics_app.maths.decompose import decompose_trs
from mimics_app.world.content.meshes.mesh import FARTHEST
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.graph.levels import MAX_LEVELS

if TYPE_CHECKING:  # the tables are compiled, and a file is checked before
    from mimics_app.world.graph.node_tables import LightKind

__all__ = ["MAX_DEPTH", "GltfCamera", "GltfLight", "GltfNode", "GltfNodes"]

MAX_DEPTH = 256
"""Maximum depth of the node tree."""

_QUATERNION_TOLERANCE = 1e-2
"""Deviation of a quaternion's length from 1 that is taken as rounding (normalised bytes) and corrected."""

_LIGHT_KINDS: tuple[LightKind, ...] = ("directional", "point", "spot")
_LIGHTS = "/extensions/KHR_lights_punctual"
_IDENTITY = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


_Reach = tuple[float, float]
"""Upper bounds of a node's distance from the model's origin [m], and of the scale factor of its subtree."""


@dataclass(eq=False)
class GltfNode:
    """One node.

    Attributes:
        name: Name, "" for none.
        translation: Translation [m].
        rotation: Unit quaternion xyzw.
        scale: Scale, possibly negative.
        children: Indices of the children.
        parent: Index of the parent, or None.
        mesh, camera, light, skin: Indices into the file's lists, or None.
        morph_weights: Weights of morph targets in place of the mesh's own; () where the node has none.
        visible: Visibility of KHR_node_visibility.
        occluder: Centre and size [m] of `extras.mimics.occluder`, a box inside the body that hides what is behind it.
        levels: Nodes of its coarser levels of detail (MSFT_lod), finest first.
        coverages: Smallest share of the picture for itself and each level; [] where the file has none.
        components: `extras.mimics.components`, undecoded.
        extras: All of `extras`.
    """

    name: str = ""
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    children: list[int] = field(default_factory=list)
    parent: int | None = None
    mesh: int | None = None
    camera: int | None = None
    light: int | None = None
    skin: int | None = None
    morph_weights: tuple[float, ...] = ()
    visible: bool = True
    levels: list[int] = field(default_factory=list)
    coverages: list[float] = field(default_factory=list)
    occluder: tuple[Vec3, Vec3] | None = None
    components: dict[str, Any] = field(default_factory=dict)
    extras: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class GltfCamera:
    """A perspective camera: full vertical angle of view [rad], distances of the near and far planes [m]."""

    name: str
    vertical_fov: float
    near: float
    far: float


@dataclass(frozen=True)
class GltfLight:
    """A light of KHR_lights_punctual; its lux or candela are taken as intensity factor."""

    name: str
    kind: LightKind
    colour: tuple[float, float, float]
    intensity: float
    range: float
    inner_cone: float
    outer_cone: float


class GltfNodes:
    """Reader of the node tree, cameras and lights.

    Args:
        source: The file.
        farthest: Largest coordinate of each mesh [m].
        morphs: Number of morph targets of each mesh.
    """

    def __init__(self, source: GltfSource, farthest: list[float], morphs: list[int]) -> None:
        self._source = source
        self._farthest = farthest
        self._morphs = morphs
        self.nodes: list[GltfNode] = []
        self.cameras: list[GltfCamera | None] = []
        self.lights: list[GltfLight | None] = []

    def read_all(self) -> None:
        """Fill `nodes`, `cameras` and `lights`; faults are collected."""
        source = self._source
        self.cameras = source.read_each(source.table("cameras"), "/cameras", self._camera, lambda: None)
        lights = source.list(source.extension(source.json, "KHR_lights_punctual", ""), "lights", _LIGHTS)
        self.lights = source.read_each(lights, f"{_LIGHTS}/lights", self._light, lambda: None)
        self.nodes = source.read_each(source.table("nodes"), "/nodes", self._node, GltfNode)
        self._link()
        for node in self.nodes:
            self._check_levels(node)

    def roots(self) -> list[int]:
        """Return the root nodes of the default scene; without scenes, all nodes without parent."""
        source = self._source
        scenes = source.table("scenes")
        if not scenes:
            return [i for i, node in enumerate(self.nodes) if node.parent is None]
        chosen = source.index(source.json.get("scene", 0), len(scenes), "scenes", "/scene")
        place = f"/scenes/{chosen}/nodes"
        roots: dict[int, None] = {}
        for i, value in enumerate(source.list(scenes[chosen], "nodes", f"/scenes/{chosen}")):
            index = source.index(value, len(self.nodes), "nodes", f"{place}/{i}")
            if self.nodes[index].parent is not None:
                source.fail(f"{place}/{i}", f"node {index} is not a root node: it hangs on {self.nodes[index].parent}")
            if index in roots:
                source.fail(f"{place}/{i}", f"node {index} is listed twice")
            roots[index] = None
        return list(roots)

    def _node(self, item: dict[str, Any], place: str) -> GltfNode:
        source = self._source
        node = GltfNode(name=source.text(item, "name", place))
        self._place(node, item, place)
        punctual = source.extension(item, "KHR_lights_punctual", place)
        where = f"{place}/extensions/KHR_lights_punctual/light"
        if "mesh" in item:
            node.mesh = source.index(item["mesh"], len(self._farthest), "meshes", f"{place}/mesh")
        if "skin" in item:
            node.skin = source.index(item["skin"], len(source.table("skins")), "skins", f"{place}/skin")
        if node.mesh is not None and "weights" in item:
            count = self._morphs[node.mesh]
            node.morph_weights = source.vector(item, "weights", place, (0.0,) * count)
        if "camera" in item:
            node.camera = source.index(item["camera"], len(self.cameras), "cameras", f"{place}/camera")
        if "light" in punctual:
            node.light = source.index(punctual["light"], len(self.lights), "lights", where)
        node.visible = source.extension(item, "KHR_node_visibility", place).get("visible") is not False
        self._read_levels(node, source.extension(item, "MSFT_lod", place), item, place)
        extras = item.get("extras")
        if isinstance(extras, dict):
            node.extras = extras
            ours = source.object(extras, "mimics", f"{place}/extras")
            node.components = source.object(ours, "components", f"{place}/extras/mimics")
            for name, value in node.components.items():
                if not isinstance(value, dict | NoneType):
                    source.fail(f"{place}/extras/mimics/components/{escape(name)}", "must be an object")
            node.occluder = self._occluder(ours, f"{place}/extras/mimics")
        return node

    def _read_levels(self, node: GltfNode, lod: dict[str, Any], item: dict[str, Any], place: str) -> None:
        if not lod:
            return
        source, count = self._source, len(self._source.table("nodes"))
        where = f"{place}/extensions/MSFT_lod/ids"
        for i, value in enumerate(source.list(lod, "ids", f"{place}/extensions/MSFT_lod")):
            node.levels.append(source.index(value, count, "nodes", f"{where}/{i}"))
        if len(node.levels) >= MAX_LEVELS:
            source.fail(where, f"{len(node.levels)} coarser levels are more than {MAX_LEVELS - 1}")
        extras = item.get("extras")
        coverages = extras.get("MSFT_screencoverage") if isinstance(extras, dict) else None
        if isinstance(coverages, list) and coverages:
            numbers = [float(part) for part in coverages if isinstance(part, int | float) and 0.0 <= part <= 1.0]
            decreasing = all(after < before for before, after in itertools.pairwise(numbers))
            if len(numbers) != len(coverages) or len(coverages) != len(node.levels) + 1 or not decreasing:
                what = f"is not {len(node.levels) + 1} decreasing numbers from 1 to 0"
                source.fail(f"{place}/extras/MSFT_screencoverage", what)
            node.coverages = numbers

    def _check_levels(self, node: GltfNode) -> None:
        """Refuse levels of detail with more morph targets than their node: it has no weights for them."""
        own = 0 if node.mesh is None else self._morphs[node.mesh]
        for level in node.levels if own else ():
            mesh = self.nodes[level].mesh
            if mesh is not None and self._morphs[mesh] > own:
                with self._source.collecting():
                    what = f"has {self._morphs[mesh]} morph targets, the node whose level it is has {own}"
                    self._source.fail(f"/nodes/{level}/mesh", what)

    def _occluder(self, ours: dict[str, Any], place: str) -> tuple[Vec3, Vec3] | None:
        if "occluder" not in ours:
            return None
        source = self._source
        box = source.object(ours, "occluder", place)
        x, y, z = source.vector(box, "centre", f"{place}/occluder", (0.0, 0.0, 0.0))
        width, height, depth = source.vector(box, "size", f"{place}/occluder", (0.0, 0.0, 0.0))
        if min(width, height, depth) <= 0.0:
            source.fail(f"{place}/occluder/size", "is not greater than 0 along every axis")
        return (x, y, z), (width, height, depth)

    def _place(self, node: GltfNode, item: dict[str, Any], place: str) -> None:
        source = self._source
        if "matrix" in item:
            self._decompose(node, source.vector(item, "matrix", place, _IDENTITY), place)
            return
        x, y, z = source.vector(item, "translation", place, (0.0, 0.0, 0.0))
        sx, sy, sz = source.vector(item, "scale", place, (1.0, 1.0, 1.0))
        rotation = source.vector(item, "rotation", place, (0.0, 0.0, 0.0, 1.0))
        length = math.sqrt(sum(part * part for part in rotation))
        if abs(length - 1.0) > _QUATERNION_TOLERANCE:
            source.fail(f"{place}/rotation", f"a quaternion of length {length:.4g} instead of 1")
        qx, qy, qz, qw = (part / length for part in rotation)
        node.translation, node.rotation, node.scale = (x, y, z), (qx, qy, qz, qw), (sx, sy, sz)

    def _decompose(self, node: GltfNode, values: tuple[float, ...], place: str) -> None:
        matrix = np.array(values).reshape(4, 4).T
        if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
            self._source.fail(f"{place}/matrix", "its last row is not 0 0 0 1")
        translation, rotation, scale, shear = decompose_trs(matrix)
        if shear > 1e-4:
            self._source.note(f"{place}: its matrix shears; the nearest rotation and scale were taken")
        node.translation = tuple(translation.tolist())
        node.rotation = tuple(rotation.tolist())
        node.scale = tuple(scale.tolist())

    def _link(self) -> None:
        """Set parents from children; refuse a second parent, a loop, and trees that are too deep."""
        source = self._source
        for i, item in enumerate(source.table("nodes")):
            with source.collecting():
                for j, value in enumerate(source.list(item, "children", f"/nodes/{i}")):
                    place = f"/nodes/{i}/children/{j}"
                    child = source.index(value, len(self.nodes), "nodes", place)
                    if self.nodes[child].parent is not None:
                        source.fail(place, f"node {child} hangs on node {self.nodes[child].parent} already")
                    self.nodes[child].parent = i
                    self.nodes[i].children.append(child)
        depth = {i: 0 for i, node in enumerate(self.nodes) if node.parent is None}
        reach: dict[int, _Reach] = {}
        waiting = list(depth)
        while waiting:
            index = waiting.pop()
            if depth[index] >= MAX_DEPTH:
                source.fail(f"/nodes/{index}", f"more than {MAX_DEPTH} nodes hang on each other")
            for child in self.nodes[index].children:
                depth[child] = depth[index] + 1
                waiting.append(child)
            self._check_reach(index, reach)
        if len(depth) < len(self.nodes):
            lost = next(i for i in range(len(self.nodes)) if i not in depth)
            source.fail(f"/nodes/{lost}", "is part of a loop: it hangs on itself")

    def _check_reach(self, index: int, reach: dict[int, _Reach]) -> None:
        """Refuse a node whose mesh may be too far from the model's origin, with all scales of its parents."""
        node = self.nodes[index]
        above = (0.0, 1.0) if node.parent is None else reach[node.parent]
        away = above[0] + above[1] * math.hypot(*node.translation)
        factor = above[1] * max(map(abs, node.scale))
        reach[index] = away, factor
        farthest = away + factor * (0.0 if node.mesh is None else self._farthest[node.mesh])
        if not max(farthest, factor) <= FARTHEST:
            self._source.fail(f"/nodes/{index}", f"it reaches {farthest:g} m, which is beyond {FARTHEST:g} m")

    def _camera(self, item: dict[str, Any], place: str) -> GltfCamera | None:
        source = self._source
        if source.text(item, "type", place) != "perspective":
            source.note(f"{place} left out: only perspective cameras are used")
            return None
        lens = source.object(item, "perspective", place)
        here = f"{place}/perspective"
        fov = source.number(lens, "yfov", here, 0.0, 0.0)
        near = source.number(lens, "znear", here, 0.0, 0.0)
        far = source.number(lens, "zfar", here, math.inf, 0.0) if "zfar" in lens else math.inf
        if not 0.0 < fov < math.pi:
            source.fail(f"{here}/yfov", f"{fov:g} rad is not between 0 and pi")
        if not 0.0 < near < far:
            source.fail(here, f"znear {near:g} is not between 0 and zfar {far:g}")
        return GltfCamera(source.text(item, "name", place), fov, near, far)

    def _light(self, item: dict[str, Any], place: str) -> GltfLight:
        source = self._source
        kind = cast("LightKind", source.choice(item, "type", place, _LIGHT_KINDS))
        spot = source.object(item, "spot", place)
        inner = source.number(spot, "innerConeAngle", f"{place}/spot", 0.0, 0.0)
        outer = source.number(spot, "outerConeAngle", f"{place}/spot", math.pi / 4, 0.0)
        if kind == "spot" and not inner < outer <= math.pi / 2:
            source.fail(f"{place}/spot", f"cones of {inner:g} and {outer:g} rad are not nested")
        red, green, blue = source.vector(item, "color", place, (1.0, 1.0, 1.0))
        reach = source.number(item, "range", place, math.inf, 0.0) if "range" in item else math.inf
        intensity = source.number(item, "intensity", place, 1.0, 0.0)
        return GltfLight(source.text(item, "name", place), kind, (red, green, blue), intensity, reach, inner, outer)
