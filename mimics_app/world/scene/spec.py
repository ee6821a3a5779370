"""The shape of a scene file: what stands at its top level. Component types stand in `world.components`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from mimics_app.world.components.bounds import (
    Angle,
    Extent,
    FarPoint,
    Light,
    Quaternion,
    SignedFactor,
    Vector,
)
from mimics_app.world.components.registry import Component
from mimics_app.world.materials.material import AlphaMode, Filter, Wrap
from mimics_app.world.materials.technique import TechniqueSpec

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
"""Most entities of one scene, prefabs unfolded."""

VERSION = 1
"""Newest version of the format; older ones are read through `source.MIGRATIONS`."""

Share = Annotated[float, Meta(ge=0, le=1)]
Pair = tuple[SignedFactor, SignedFactor]
Texts = Annotated[list[str], Meta(max_length=1000)]
Components = dict[str, dict[str, Any] | None]


class TransformSpec(Component, frozen=True):
    """Place, turn and size of an entity, relative to its parent."""

    translation: Annotated[FarPoint, Meta(description="[m]")] = (0.0, 0.0, 0.0)
    rotation: Annotated[Quaternion, Meta(description="Unit quaternion x, y, z, w")] = (
        0.0,
        0.0,
        0.0,
        1.0,
    )
    scale: Annotated[Vector, Meta(description="Factors, none of them 0")] = (1.0, 1.0, 1.0)


class OverrideSpec(Component, frozen=True):
    """What one instance changes of an entity inside its prefab or model."""

    transform: Annotated[TransformSpec | None, Meta(description="Replaces what it names")] = None
    components: Annotated[Components, Meta(description="Merged over the original's; null takes one away")] = (
        msgspec.field(default_factory=dict)
    )


class PrefabSpec(Component, frozen=True):
    """A pattern for entities. `prefab` names another one it is built on."""

    prefab: Annotated[str | None, Meta(description="Prefab this one is built on")] = None
    transform: Annotated[TransformSpec | None, Meta(description="Default of the instances")] = None
    components: Annotated[Components, Meta(description="By type, one of each")] = msgspec.field(default_factory=dict)
    children: Annotated[
        list[EntitySpec],
        Meta(max_length=MAX_ENTITIES, description="Entities below; the id of an instance is put before theirs"),
    ] = msgspec.field(default_factory=list)


class EntitySpec(Component, frozen=True):
    """One thing of the scene."""

    id: Annotated[str, Meta(description="Unique; letters, digits, _ - and .")]
    parent: Annotated[str | None, Meta(description="Id of the entity it moves with")] = None
    prefab: Annotated[str | None, Meta(description="Pattern it is an instance of")] = None
    transform: Annotated[TransformSpec | None, Meta(description="Relative to the parent")] = None
    components: Annotated[Components, Meta(description="By type, one of each")] = msgspec.field(default_factory=dict)
    overrides: Annotated[
        dict[str, OverrideSpec], Meta(description="Changes of entities inside the prefab or model, by their path")
    ] = msgspec.field(default_factory=dict)


class AssetSpec(Component, frozen=True):
    """A file the scene uses: model (.glb .gltf), picture (.png .jpg), sound (.wav .ogg .flac), head (.sofa), path."""

    uri: Annotated[str, Meta(description="Relative to this file, inside the scene's folder; mimics:... is shipped")]
    srgb: Annotated[bool, Meta(description="Picture: colours are sRGB encoded")] = True
    wrap: Annotated[tuple[Wrap, Wrap], Meta(description="Picture: what lies outside, along u and v")] = (
        "repeat",
        "repeat",
    )
    filter: Annotated[Filter, Meta(description="Picture: how texels are mixed")] = "trilinear"


class UvTransform(Component, frozen=True):
    """Where the pictures of a material lie (KHR_texture_transform): scaled, then turned, then shifted."""

    offset: Annotated[Pair, Meta(description="Of the origin, in texture coordinates")] = (0.0, 0.0)
    rotation: Annotated[Angle, Meta(description="Anticlockwise about the origin, as texture coordinates lie [rad]")] = (
        0.0
    )
    scale: Annotated[Pair, Meta(description="Factors on u and v")] = (1.0, 1.0)


class MaterialSpec(Component, frozen=True):
    """How a surface answers light; colours are linear."""

    inherits: Annotated[str | None, Meta(description="Material whose keys it takes over where it has none")] = None
    technique: Annotated[
        str,
        Meta(description="pbr, lit, lit_matt, unlit, glass (translucent with a bright rim), or one of `techniques`"),
    ] = "lit"
    base_colour: Annotated[tuple[Share, Share, Share, Share], Meta(description="Linear RGBA")] = (0.8, 0.8, 0.8, 1.0)
    metallic: Annotated[float, Meta(ge=0, le=1, description="0 dielectric, 1 metal")] = 0.0
    roughness: Annotated[float, Meta(ge=0, le=1, description="0 mirror, 1 matt")] = 0.6
    emission: Annotated[tuple[Light, Light, Light], Meta(description="Linear RGB it gives off")] = (
        0.0,
        0.0,
        0.0,
    )
    base_texture: Annotated[str | None, Meta(description="Of the scene's `assets`, a picture")] = None
    normal_texture: Annotated[str | None, Meta(description="Picture of normals, y upwards")] = None
    surface_texture: Annotated[str | None, Meta(description="Picture of roughness (green) and metal (blue)")] = None
    occlusion_texture: Annotated[str | None, Meta(description="Picture of sky light let in (red)")] = None
    emission_texture: Annotated[str | None, Meta(description="Picture multiplied with `emission`")] = None
    normal_scale: Annotated[SignedFactor, Meta(description="Factor on the slopes of the normal picture")] = 1.0
    occlusion_strength: Annotated[float, Meta(ge=0, le=1, description="How much of the occlusion picture counts")] = 1.0
    uv_transform: Annotated[UvTransform, Meta(description="Where its pictures lie")] = UvTransform()
    alpha_mode: Annotated[AlphaMode, Meta(description="What alpha does")] = "opaque"
    alpha_cutoff: Annotated[float, Meta(ge=0, le=1, description="Where mask cuts")] = 0.5
    double_sided: Annotated[bool, Meta(description="Back faces are drawn too")] = False
    grid: Annotated[Extent, Meta(description="Spacing of lines drawn over it [m]; 0: none")] = 0.0
    softness: Annotated[float, Meta(ge=0, le=1, description="Light creeps round into its shade: 0 stone, 1 skin")] = 0.0


class SceneSpec(Component, frozen=True):
    """A scene of the application. Keys that begin with x- are left to you."""

    format: Annotated[Literal["mimics-scene"], Meta(description="Always mimics-scene")]
    version: Annotated[int, Meta(ge=1, le=1000, description="Of the format; the newest is 1")]
    units: Annotated[Literal["m-kg-s"], Meta(description="SI: metres, kilograms, seconds, newtons, radians")] = "m-kg-s"
    up: Annotated[Literal["+Y"], Meta(description="Right-handed, +y up, as in glTF")] = "+Y"
    name: Annotated[str | None, Meta(description="Short name; absent: that of the file")] = None
    title: Annotated[str | None, Meta(description="As people read it")] = None
    description: Annotated[str | None, Meta(description="One or two sentences for the launcher")] = None
    picture: Annotated[str | None, Meta(description="Picture for the launcher, relative to this file")] = None
    scenario: Annotated[str | None, Meta(description="What runs it; absent: that of its name; none: nothing")] = None
    include: Annotated[Texts, Meta(description="Scene files whose content is added, relative to this one")] = (
        msgspec.field(default_factory=list)
    )
    assets: Annotated[dict[str, AssetSpec], Meta(description="Files by id")] = msgspec.field(default_factory=dict)
    materials: Annotated[dict[str, MaterialSpec], Meta(description="By id")] = msgspec.field(default_factory=dict)
    techniques: Annotated[dict[str, TechniqueSpec], Meta(description="Further techniques to draw surfaces, by id")] = (
        msgspec.field(default_factory=dict)
    )
    prefabs: Annotated[dict[str, PrefabSpec], Meta(description="By id")] = msgspec.field(default_factory=dict)
    entities: Annotated[list[EntitySpec], Meta(max_length=MAX_ENTITIES, description="Everything in the scene")] = (
        msgspec.field(default_factory=list)
    )
    systems: Annotated[dict[str, dict[str, Any]], Meta(description="Settings of the stages, by name")] = msgspec.field(
        default_factory=dict
    )
    task: Annotated[dict[str, Any] | None, Meta(description="What is to be done, and how it is scored")] = None
