"""The sky behind the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import Issue
from mimics_app.rendering.visual.lighting import Lighting
from mimics_app.rendering.visual.materials.picture_arrays import encode_srgb, shrunk
from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.texture_store import TextureStore
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8
from mimics_app.world.content.environment import Backdrop
from mimics_app.world.content.materials.material import TextureData
from mimics_app.world.content.world import World

if TYPE_CHECKING:
    import moderngl

__all__ = ["SkyPass", "flat_sky"]

_BINDING = 9


def flat_sky(lighting: Lighting, settings: RenderSettings) -> tuple[float, float, float] | None:
    """Return the display values of a sky of one colour, the clear colour of plain shading; None for any other sky."""
    if settings.shading != "plain" or lighting.backdrop is not None:
        return None
    if not (np.array_equal(lighting.zenith, lighting.horizon) and np.array_equal(lighting.horizon, lighting.ground)):
        return None
    red, green, blue = encode_srgb(settings.exposure * lighting.zenith).tolist()
    return red, green, blue


class SkyPass:
    """Draws the sky behind the opaque surfaces, with the textures of its backdrop if there is one.

    Attributes:
        issues: Backdrops that could not be drawn, each reported once; the caller removes what it reports.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary, max_size: int) -> None:
        self._ctx = ctx
        self._shaders = shaders
        self._max_size = max_size
        self._textures = TextureStore(ctx, shaders, max_size)
        self._shader = shaders.program("sky/sky.vert", "sky/sky.frag")
        self._arrays = bare_arrays(ctx)
        self._cube: tuple[list[TextureData], moderngl.TextureCube] | None = None
        self._reported: set[Backdrop] = set()
        self.issues: list[Issue] = []

    def prepare(self, world: World) -> None:
        """Select shader and textures for the backdrop of a world."""
        backdrop = world.environment.backdrop
        pictures = self._pictures(backdrop, world)
        defines: tuple[str, ...] = ()
        if backdrop is not None and pictures:
            defines = (backdrop.kind.upper(),)
            if backdrop.kind == "box":
                self._box(pictures).use(_BINDING)
            else:
                self._textures.get(backdrop.textures[0], pictures[0]).use(_BINDING)
        self._shader = self._shaders.program("sky/sky.vert", "sky/sky.frag", defines)
        if backdrop is not None and defines == ("PLANE",):
            self._shader.set_number("height", backdrop.height / backdrop.tile)

    def draw(self) -> int:
        """Draw the sky; return the draw calls."""
        import moderngl

        self._ctx.enable_only(moderngl.DEPTH_TEST)
        self._ctx.depth_func = "<="
        self._arrays.of(self._shader).render(moderngl.TRIANGLES, vertices=3)
        self._ctx.depth_func = "<"
        return 1

    def release(self) -> None:
        """Free the vertex arrays and the textures."""
        self._arrays.release()
        if self._cube is not None:
            self._cube[1].release()
            self._cube = None
        self._textures.release()

    def _pictures(self, backdrop: Backdrop | None, world: World) -> list[TextureData]:
        """Return all textures of a backdrop; none where one is missing or those of a box differ in size."""
        if backdrop is None:
            return []
        found = [world.textures[key] for key in backdrop.textures if key in world.textures]
        sizes = {picture.pixels.shape for picture in found}
        square = all(height == width for height, width, _ in sizes)
        fault = ""
        if len(found) != len(backdrop.textures) or len(found) != (6 if backdrop.kind == "box" else 1):
            missing = [key for key in backdrop.textures if key not in world.textures]
            fault = f"no texture {', '.join(missing)}" if missing else f"{len(found)} textures make no {backdrop.kind}"
        elif backdrop.kind == "box" and (len(sizes) > 1 or not square):
            fault = "its six textures are not squares of one size"
        if fault and backdrop not in self._reported:
            self._reported.add(backdrop)
            self.issues.append(Issue("", "", f"backdrop of the sky: {fault}; drawn without it"))
        return [] if fault else found

    def _box(self, pictures: list[TextureData]) -> moderngl.TextureCube:
        if self._cube is not None and all(a is b for a, b in zip(self._cube[0], pictures, strict=True)):
            return self._cube[1]
        if self._cube is not None:
            self._cube[1].release()
        # Cube map faces are defined as seen from outside: mirror the sides, flip top and bottom.
        turned = (np.flip(each.pixels, 0 if number in (2, 3) else 1) for number, each in enumerate(pictures))
        faces = [shrunk(face, self._max_size) for face in turned]
        data = b"".join(np.ascontiguousarray(face).tobytes() for face in faces)
        size = (faces[0].shape[1], faces[0].shape[0])
        inner = SRGB8_ALPHA8 if pictures[0].srgb else None
        cube = self._ctx.texture_cube(size, 4, data, internal_format=inner)
        self._cube = (pictures, cube)
        return cube
