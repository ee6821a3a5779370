"""Techniques: methods of drawing a surface, each a list of passes, with requirements on the graphics driver."""

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
    """Requirements on the driver."""

    gl: Annotated[int, Meta(ge=0, le=1000, description="Minimum version of OpenGL, 430 for 4.3")] = 0
    texture_units: Annotated[int, Meta(ge=0, le=1000, description="Minimum texture units of a fragment shader")] = 0
    texture_size: Annotated[int, Meta(ge=0, le=100_000, description="Minimum of the largest texture size [texels]")] = 0
    extensions: Annotated[Texts, Meta(description="Extensions, such as GL_ARB_shader_viewport_layer_array")] = ()


class PassSpec(Component, frozen=True):
    """One pass: shaders and render state."""

    vertex: Annotated[str, Meta(description="File below the shaders folder")] = "common/mesh.vert"
    fragment: Annotated[str, Meta(description="File below the shaders folder")] = "unlit/unlit.frag"
    defines: Annotated[Texts, Meta(description="Macros that are always defined")] = ()
    features: Annotated[
        Texts,
        Meta(description="Macros defined where a material needs them: TEXTURED, MASKED, GRID, NORMAL_MAP and so on"),
    ] = ()
    blend: Annotated[Blend, Meta(description="Blending; material: by the material's alpha_mode")] = "material"
    cull: Annotated[Cull, Meta(description="Culled faces; material: back faces unless it is double-sided")] = "material"
    depth: Annotated[Depth, Meta(description="Depth buffer; material: always tested, written unless blended")] = (
        "material"
    )


class TechniqueSpec(Component, frozen=True):
    """A method of drawing a surface; its fallback replaces it where driver or profile do not allow it."""

    inherits: Annotated[str | None, Meta(description="Base technique, whose keys hold where absent")] = None
    passes: Annotated[tuple[PassSpec, ...], Meta(max_length=16, description="Passes in order")] = ()
    needs: Annotated[Needs, Meta(description="Requirements on the driver")] = Needs()
    profiles: Annotated[tuple[Profile, ...], Meta(max_length=3, description="Profiles that may use it")] = (
        "draft",
        "training",
        "study",
    )
    fallback: Annotated[str | None, Meta(description="Technique to try instead")] = None
