"""Techniques: methods to draw a surface, each a list of passes, and what a graphics driver must have for them."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta

from mimics_app.world.components.registry import Component

__all__ = ["Blend", "Cull", "Depth", "Needs", "PassSpec", "Profile", "TechniqueSpec"]

Texts = Annotated[tuple[str, ...], Meta(max_length=100)]
Profile = Literal["draft", "training", "study"]
Blend = Literal["material", "none", "alpha", "add", "multiply"]
Cull = Literal["material", "none", "back", "front"]
Depth = Literal["material", "write", "test", "off"]


class Needs(Component, frozen=True):
    """What a driver must have."""

    gl: Annotated[int, Meta(ge=0, le=1000, description="Version of OpenGL, 430 for 4.3")] = 0
    texture_units: Annotated[int, Meta(ge=0, le=1000, description="Pictures a fragment shader can read")] = 0
    texture_size: Annotated[int, Meta(ge=0, le=100_000, description="Longest side of a picture [texels]")] = 0
    extensions: Annotated[Texts, Meta(description="Such as GL_ARB_shader_viewport_layer_array")] = ()


class PassSpec(Component, frozen=True):
    """One drawing of the surface: shaders and the state they are used with."""

    vertex: Annotated[str, Meta(description="File below the shaders folder")] = "common/mesh.vert"
    fragment: Annotated[str, Meta(description="File below the shaders folder")] = "unlit/unlit.frag"
    defines: Annotated[Texts, Meta(description="Always #define'd")] = ()
    features: Annotated[
        Texts,
        Meta(description="#define'd where a material has them: TEXTURED, MASKED, GRID, NORMAL_MAP and so on"),
    ] = ()
    blend: Annotated[Blend, Meta(description="How it mixes with what is behind; material: as its alpha_mode says")] = (
        "material"
    )
    cull: Annotated[Cull, Meta(description="Faces left out; material: back ones unless it is double-sided")] = (
        "material"
    )
    depth: Annotated[Depth, Meta(description="material: written where nothing is blended, tested always")] = "material"


class TechniqueSpec(Component, frozen=True):
    """A method to draw a surface; where the driver or the profile cannot have it, its fallback is tried."""

    inherits: Annotated[str | None, Meta(description="Technique whose keys it takes over where it has none")] = None
    passes: Annotated[tuple[PassSpec, ...], Meta(max_length=16, description="In the order they are drawn")] = ()
    needs: Annotated[Needs, Meta(description="What the driver must have")] = Needs()
    profiles: Annotated[tuple[Profile, ...], Meta(max_length=3, description="Those it is for")] = (
        "draft",
        "training",
        "study",
    )
    fallback: Annotated[str | None, Meta(description="Technique to try instead")] = None
