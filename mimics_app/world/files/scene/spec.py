"""Structs of the top level of a scene file; `world.components` has the component types."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.world.components.bounds import (
    NO_ROTATION,
    Angle,
    Extent,
    FarPoint,
    Light,
    Quaternion,
    Share,
    SignedFactor,
    Vector,
)
from mimics_app.world.components.registry import Component
from mimics_app.world.content.materials.material import AlphaMode, Filter, Wrap
from mimics_app.world.content.materials.technique import TechniqueSpec

__all__ = [
    "FORMAT",
    "MAX_ENTITIES",
    "VERSION",
    "AssetSpec",
    "EntitySpec",
    "MaterialSpec",
    "OverrideSpec",
    "PrefabSpec",
    "SceneSpec",
    "TransformSpec",
    "UvTransform",
]

FORMAT = "mimics-scene"
MAX_ENTITIES = 100_000
"""Maximum number of entities of a scene, prefabs expanded."""

VERSION = 1
"""Newest version of the format; `source.MIGRATIONS` converts older ones."""

Pair = tuple[SignedFactor, SignedFactor]
Texts = Annotated[list[str], Meta(max_length=1000)]
Components = dict[str, dict[str, Any] | None]


class TransformSpec(Component, frozen=True):
    """Translation, rotation and scale of an entity, relative to its parent."""

    translation: Annotated[FarPoint, Meta(description="Translation [m]")] = (0.0, 0.0, 0.0)
    rotation: Annotated[Quaternion, Meta(description="Unit quaternion x, y, z, w")] = NO_ROTATION
    scale: Annotated[Vector, Meta(description="Factors, none of them 0")] = (1.0, 1.0, 1.0)


class OverrideSpec(Component, frozen=True):
    """Changes of an entity inside a prefab or model, for one instance."""

    transform: Annotated[TransformSpec | None, Meta(description="Replaces the fields it names")] = None
    components: Annotated[Components, Meta(description="Merged over the original's; null removes one")] = msgspec.field(
        default_factory=dict
    )


class PrefabSpec(Component, frozen=True):
    """A prefab: template of entities, optionally based on another one."""

    prefab: Annotated[str | None, Meta(description="Base prefab")] = None
    transform: Annotated[TransformSpec | None, Meta(description="Default of the instances")] = None
    components: Annotated[Components, Meta(description="By type, one of each")] = msgspec.field(default_factory=dict)
    children: Annotated[
        list[EntitySpec],
        Meta(max_length=MAX_ENTITIES, description="Child entities; the id of an instance is prefixed to theirs"),
    ] = msgspec.field(default_factory=list)


class EntitySpec(Component, frozen=True):
    """One entity of the scene."""

    id: Annotated[str, Meta(description="Unique; letters, digits, _ - and .")]
    parent: Annotated[str | None, Meta(description="Id of the entity it moves with")] = None
    prefab: Annotated[str | None, Meta(description="Prefab it is an instance of")] = None
    transform: Annotated[TransformSpec | None, Meta(description="Relative to the parent")] = None
    components: Annotated[Components, Meta(description="By type, one of each")] = msgspec.field(default_factory=dict)
    overrides: Annotated[
        dict[str, OverrideSpec], Meta(description="Changes of entities inside the prefab or model, by their path")
    ] = msgspec.field(default_factory=dict)


class AssetSpec(Component, frozen=True):
    """A file of the scene: model (.glb .gltf .vrm), picture (.png .jpg) sound (.wav .ogg .flac), head (.sofa), path."""

    uri: Annotated[str, Meta(description="Relative to this file, inside the scene's folder; mimics:... is shipped")]
    srgb: Annotated[bool, Meta(description="Picture: colours are sRGB encoded")] = True
    wrap: Annotated[
        tuple[Wrap, Wrap], Meta(description="Picture: texture addressing outside 0 to 1, along u and v")
    ] = (
        "repeat",
        "repeat",
    )
    filter: Annotated[Filter, Meta(description="Picture: texture filter")] = "trilinear"


class UvTransform(Component, frozen=True):
    """Texture transform of a material (KHR_texture_transform): scaled, then rotated, then translated."""

    offset: Annotated[Pair, Meta(description="Offset of the origin, in texture coordinates")] = (0.0, 0.0)
    rotation: Annotated[
        Angle, Meta(description="Anticlockwise angle about the origin of texture coordinates [rad]")
    ] = 0.0
    scale: Annotated[Pair, Meta(description="Factors on u and v")] = (1.0, 1.0)


class MaterialSpec(Component, frozen=True):
    """Material of a surface; colours are linear."""

    inherits: Annotated[str | None, Meta(description="Base material, whose keys hold where absent")] = None
    technique: Annotated[
        str,
        Meta(description="pbr, lit, lit_matt, unlit, glass (translucent with a bright rim), or one of `techniques`"),
    ] = "lit"
    base_colour: Annotated[tuple[Share, Share, Share, Share], Meta(description="Linear RGBA")] = (0.8, 0.8, 0.8, 1.0)
    metallic: Annotated[Share, Meta(description="0 dielectric, 1 metal")] = 0.0
    roughness: Annotated[Share, Meta(description="0 mirror, 1 matt")] = 0.6
    emission: Annotated[tuple[Light, Light, Light], Meta(description="Emitted radiance, linear RGB")] = (
        0.0,
        0.0,
        0.0,
    )
    base_texture: Annotated[str | None, Meta(description="Base colour texture: image file of the scene's `assets`")] = (
        None
    )
    normal_texture: Annotated[str | None, Meta(description="Normal map, y upwards")] = None
    surface_texture: Annotated[str | None, Meta(description="Texture of roughness (green) and metallic (blue)")] = None
    occlusion_texture: Annotated[str | None, Meta(description="Texture of ambient occlusion (red)")] = None
    emission_texture: Annotated[str | None, Meta(description="Texture multiplied with `emission`")] = None
    normal_scale: Annotated[SignedFactor, Meta(description="Factor on the slopes of the normal map")] = 1.0
    occlusion_strength: Annotated[Share, Meta(description="Strength of the occlusion texture")] = 1.0
    uv_transform: Annotated[UvTransform, Meta(description="Transform of all its textures")] = UvTransform()
    alpha_mode: Annotated[AlphaMode, Meta(description="Use of alpha: opaque, mask or blend")] = "opaque"
    alpha_cutoff: Annotated[Share, Meta(description="Threshold of mask")] = 0.5
    double_sided: Annotated[bool, Meta(description="Back faces are drawn too")] = False
    grid: Annotated[Extent, Meta(description="Spacing of lines drawn over it [m]; 0: none")] = 0.0
    softness: Annotated[Share, Meta(description="Wrap of diffuse light into the shade: 0 stone, 1 skin")] = 0.0


class SceneSpec(Component, frozen=True):
    """A scene of the application. Keys that begin with x- are comments."""

    format: Annotated[Literal["mimics-scene"], Meta(description="Always mimics-scene")]
    version: Annotated[int, Meta(ge=1, le=1000, description="Version of the format; the newest is 1")]
    units: Annotated[Literal["m-kg-s"], Meta(description="SI: metres, kilograms, seconds, newtons, radians")] = "m-kg-s"
    up: Annotated[Literal["+Y"], Meta(description="Right-handed, +y up, as in glTF")] = "+Y"
    name: Annotated[str | None, Meta(description="Short name; absent: that of the file")] = None
    title: Annotated[str | None, Meta(description="Title for display")] = None
    description: Annotated[str | None, Meta(description="One or two sentences for the launcher")] = None
    picture: Annotated[str | None, Meta(description="Image file for the launcher, relative to this file")] = None
    scenario: Annotated[
        str | None, Meta(description="Scenario that runs it; absent: that of its name; none: no code")
    ] = None
    include: Annotated[Texts, Meta(description="Scene files whose content is added, relative to this one")] = (
        msgspec.field(default_factory=list)
    )
    assets: Annotated[dict[str, AssetSpec], Meta(description="Files by id")] = msgspec.field(default_factory=dict)
    materials: Annotated[dict[str, MaterialSpec], Meta(description="Materials by id")] = msgspec.field(
        default_factory=dict
    )
    techniques: Annotated[dict[str, TechniqueSpec], Meta(description="Further techniques of materials, by id")] = (
        msgspec.field(default_factory=dict)
    )
    prefabs: Annotated[dict[str, PrefabSpec], Meta(description="Prefabs by id")] = msgspec.field(default_factory=dict)
    entities: Annotated[list[EntitySpec], Meta(max_length=MAX_ENTITIES, description="Entities of the scene")] = (
        msgspec.field(default_factory=list)
    )
    devices: Annotated[
        dict[str, list[EntitySpec]],
        Meta(description="Entities where a device of this name plays, instead of those of the same id"),
    ] = msgspec.field(default_factory=dict)
    systems: Annotated[dict[str, dict[str, Any]], Meta(description="Settings of the stages, by name")] = msgspec.field(
        default_factory=dict
    )
    task: Annotated[dict[str, Any] | None, Meta(description="Task and its scoring")] = None
