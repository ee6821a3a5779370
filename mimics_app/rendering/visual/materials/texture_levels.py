"""Levels of a texture (mipmaps), each drawn from the next finer one by a shader of ours.

`glGenerateMipmap` of a software driver compiles a shader of its own in every process and for every format, 70 ms each,
which its cache of compiled shaders leaves out; ours is in that cache. The texels are the same, see decision 060.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from mimics_app.rendering.visual.materials.shader_library import ShaderLibrary
from mimics_app.rendering.visual.materials.vertex_arrays import bare_arrays
from mimics_app.rendering.visual.surfaces.raw_gl import SRGB8_ALPHA8, function_address

if TYPE_CHECKING:
    import moderngl

__all__ = ["TextureLevels"]

_BINDING = 20
"""Binding of the texture in shaders/texture/level.frag."""

_FRAMEBUFFER, _COLOUR = 0x8D40, 0x8CE0
_TEXTURE_2D, _TEXTURE_2D_ARRAY, _TEXTURE0 = 0x0DE1, 0x8C1A, 0x84C0
_RGBA8, _RGBA, _UNSIGNED_BYTE = 0x8058, 0x1908, 0x1401
_BASE_LEVEL, _MAX_LEVEL, _MIN_FILTER, _WRAP_S, _WRAP_T = 0x813C, 0x813D, 0x2801, 0x2802, 0x2803
_LINEAR_WITH_LEVELS, _CLAMP_TO_EDGE, _ALL_LEVELS = 0x2701, 0x812F, 1000
_FRAMEBUFFER_SRGB = 0x8DB9
_STATES = (0x0BE2, 0x0B71, 0x0B44, 0x0C11, 0x0B90, _FRAMEBUFFER_SRGB)
"""Capabilities that would change what is drawn: blending, depth test, culling, scissor, stencil test, encoding."""

_FRAMEBUFFER_BINDING, _VIEWPORT, _COLOUR_MASK = 0x8CA6, 0x0BA2, 0x0C23

_UINT, _INT, _BYTE = ctypes.c_uint, ctypes.c_int, ctypes.c_ubyte
_FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "glGenFramebuffers": (None, _INT, ctypes.POINTER(_UINT)),
    "glDeleteFramebuffers": (None, _INT, ctypes.POINTER(_UINT)),
    "glBindFramebuffer": (None, _UINT, _UINT),
    "glFramebufferTexture2D": (None, _UINT, _UINT, _UINT, _UINT, _INT),
    "glFramebufferTextureLayer": (None, _UINT, _UINT, _UINT, _INT, _INT),
    "glActiveTexture": (None, _UINT),
    "glTexParameteri": (None, _UINT, _UINT, _INT),
    "glTexImage2D": (None, _UINT, *(_INT,) * 5, _UINT, _UINT, ctypes.c_void_p),
    "glTexImage3D": (None, _UINT, *(_INT,) * 6, _UINT, _UINT, ctypes.c_void_p),
    "glViewport": (None, *(_INT,) * 4),
    "glColorMask": (None, *(_BYTE,) * 4),
    "glGetIntegerv": (None, _UINT, ctypes.POINTER(_INT)),
    "glGetBooleanv": (None, _UINT, ctypes.POINTER(_BYTE)),
    "glIsEnabled": (_BYTE, _UINT),
    "glEnable": (None, _UINT),
    "glDisable": (None, _UINT),
}


class TextureLevels:
    """Makes the levels of textures of 8 bits per channel; compiled on first use.

    Args:
        ctx: Context of the textures.
        shaders: Shader library.
    """

    def __init__(self, ctx: moderngl.Context, shaders: ShaderLibrary) -> None:
        self._ctx, self._shaders = ctx, shaders
        self._arrays = bare_arrays(ctx)
        self._calls: dict[str, Callable[..., Any]] = {}

    def make(self, texture: moderngl.Texture | moderngl.TextureArray, *, srgb: bool) -> None:
        """Fill all levels of a texture from its finest one; wrap and filter are set by the caller afterwards.

        Args:
            texture: The texture.
            srgb: True where it stores display values that the sampler decodes (`SRGB8_ALPHA8`).
        """
        width, height = texture.size[:2]
        layers = texture.size[2] if len(texture.size) == 3 else 0
        kind = _TEXTURE_2D_ARRAY if layers else _TEXTURE_2D
        sizes = _sizes(width, height)
        with self._state(encodes=srgb):
            texture.use(_BINDING)
            self._calls["glActiveTexture"](_TEXTURE0 + _BINDING)
            for level, (wide, high) in enumerate(sizes[1:], 1):
                self._reserve(kind, level, (wide, high, layers), SRGB8_ALPHA8 if srgb else _RGBA8)
            for which, value in (
                (_MIN_FILTER, _LINEAR_WITH_LEVELS),
                (_WRAP_S, _CLAMP_TO_EDGE),
                (_WRAP_T, _CLAMP_TO_EDGE),
            ):
                self._calls["glTexParameteri"](kind, which, value)
            for level, size in enumerate(sizes[1:], 1):
                self._restrict(kind, level - 1, level - 1)
                self._calls["glViewport"](0, 0, *size)
                self._draw(texture, level, layers)
            self._restrict(kind, 0, _ALL_LEVELS)

    def release(self) -> None:
        """Free the vertex arrays."""
        self._arrays.release()

    def _draw(self, texture: moderngl.Texture | moderngl.TextureArray, level: int, layers: int) -> None:
        """Draw a level of each layer; the finer one alone is sampled."""
        import moderngl

        shader = self._shaders.program("texture/level.vert", "texture/level.frag", ("LAYERS",) if layers else ())
        array = self._arrays.of(shader)
        for layer in range(max(layers, 1)):
            if layers:
                shader.set_number("layer", layer)
                self._calls["glFramebufferTextureLayer"](_FRAMEBUFFER, _COLOUR, texture.glo, level, layer)
            else:
                self._calls["glFramebufferTexture2D"](_FRAMEBUFFER, _COLOUR, _TEXTURE_2D, texture.glo, level)
            array.render(moderngl.TRIANGLES, vertices=3)
            # llvmpipe never frees the targets of the most draws that were pending at once: from 64 on it draws nothing
            # ahead any more, and whatever samples one of these targets flushes its queue, for the rest of the run.
            self._ctx.finish()

    def _reserve(self, kind: int, level: int, size: tuple[int, int, int], inner: int) -> None:
        """Allocate a level."""
        wide, high, layers = size
        if layers:
            self._calls["glTexImage3D"](kind, level, inner, wide, high, layers, 0, _RGBA, _UNSIGNED_BYTE, None)
        else:
            self._calls["glTexImage2D"](kind, level, inner, wide, high, 0, _RGBA, _UNSIGNED_BYTE, None)

    def _restrict(self, kind: int, first: int, last: int) -> None:
        """Restrict sampling to some levels."""
        self._calls["glTexParameteri"](kind, _BASE_LEVEL, first)
        self._calls["glTexParameteri"](kind, _MAX_LEVEL, last)

    @contextmanager
    def _state(self, *, encodes: bool) -> Iterator[None]:
        """Draw into a framebuffer of our own; framebuffer, viewport and capabilities are restored afterwards."""
        calls = self._calls = self._calls or _load(self._ctx)
        enabled = [state for state in _STATES if calls["glIsEnabled"](state)]
        for state in enabled:
            calls["glDisable"](state)
        if encodes:
            calls["glEnable"](_FRAMEBUFFER_SRGB)
        target, viewport, mask = (_INT * 1)(), (_INT * 4)(), (_BYTE * 4)()
        calls["glGetIntegerv"](_FRAMEBUFFER_BINDING, target)
        calls["glGetIntegerv"](_VIEWPORT, viewport)
        calls["glGetBooleanv"](_COLOUR_MASK, mask)
        name = _UINT()
        calls["glGenFramebuffers"](1, ctypes.byref(name))
        calls["glBindFramebuffer"](_FRAMEBUFFER, name.value)
        calls["glColorMask"](1, 1, 1, 1)
        try:
            yield
        finally:
            calls["glDeleteFramebuffers"](1, ctypes.byref(name))
            calls["glDisable"](_FRAMEBUFFER_SRGB)
            for state in enabled:
                calls["glEnable"](state)
            calls["glBindFramebuffer"](_FRAMEBUFFER, target[0])
            calls["glViewport"](*viewport)
            calls["glColorMask"](*mask)


def _load(ctx: moderngl.Context) -> dict[str, Callable[..., Any]]:
    """Return the functions of OpenGL that moderngl lacks."""
    return {name: ctypes.CFUNCTYPE(*kinds)(function_address(ctx, name)) for name, kinds in _FUNCTIONS.items()}


def _sizes(width: int, height: int) -> list[tuple[int, int]]:
    """Return the sizes of all levels, the finest first [texels]."""
    count = max(width, height).bit_length()
    return [(max(1, width >> level), max(1, height >> level)) for level in range(count)]
