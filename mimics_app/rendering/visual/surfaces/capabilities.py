"""Capabilities of a graphics driver, by which techniques are chosen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mimics_app.world.content.materials.technique import Needs

if TYPE_CHECKING:
    import moderngl

__all__ = ["Capabilities", "read_capabilities"]


@dataclass(frozen=True)
class Capabilities:
    """Capabilities that a technique can require.

    Attributes:
        gl: Version of OpenGL, 430 for 4.3.
        texture_units: Texture units of a fragment shader.
        texture_size: Maximum width and height of a texture [texels].
        extensions: Names of the extensions.
        renderer: The driver's name of the renderer.
    """

    gl: int
    texture_units: int
    texture_size: int
    extensions: frozenset[str]
    renderer: str = ""

    def missing(self, needs: Needs) -> list[str]:
        """Return the needs that are not met, in words; [] when all are."""
        figures = (
            (needs.gl, self.gl, "OpenGL {:.1f}", 0.01),
            (needs.texture_units, self.texture_units, "{:.0f} texture units", 1.0),
            (needs.texture_size, self.texture_size, "textures of {:.0f}", 1.0),
        )
        found = [words.format(wanted * unit) for wanted, there, words, unit in figures if wanted > there]
        return found + [name for name in needs.extensions if name not in self.extensions]


def read_capabilities(ctx: moderngl.Context) -> Capabilities:
    """Read the capabilities of a context."""
    info = ctx.info
    return Capabilities(
        gl=ctx.version_code,
        texture_units=int(info["GL_MAX_TEXTURE_IMAGE_UNITS"]),
        texture_size=int(info["GL_MAX_TEXTURE_SIZE"]),
        extensions=frozenset(ctx.extensions),
        renderer=str(info["GL_RENDERER"]),
    )
