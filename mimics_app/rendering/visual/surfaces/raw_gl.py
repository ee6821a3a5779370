"""OpenGL functions that moderngl lacks, called in its context: stencil, viewports, copies, flushes."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import moderngl

__all__ = [
    "ALWAYS",
    "CLIP_DISTANCE_0",
    "DECREMENT",
    "EQUAL",
    "INCREMENT",
    "KEEP",
    "NOT_EQUAL",
    "SRGB8_ALPHA8",
    "TRIANGLES",
    "RawGL",
    "function_address",
]

ALWAYS, EQUAL, NOT_EQUAL = 0x0207, 0x0202, 0x0205
KEEP, INCREMENT, DECREMENT = 0x1E00, 0x8507, 0x8508
"""Stencil operations; increment and decrement wrap around."""

TRIANGLES = 4
"""Primitive of three vertices each, as `moderngl.TRIANGLES`."""

CLIP_DISTANCE_0 = 0x3000
"""Capability: clipping by gl_ClipDistance[0]."""

SRGB8_ALPHA8 = 0x8C43
"""Internal format of textures that the sampler decodes to linear light."""

_STENCIL_TEST, _DEPTH_CLAMP, _STENCIL_BUFFER_BIT = 0x0B90, 0x864F, 0x0400
_FRONT, _BACK = 0x0404, 0x0405
_RENDERBUFFER, _FRAMEBUFFER, _DEPTH_STENCIL_ATTACHMENT, _DEPTH24_STENCIL8 = 0x8D41, 0x8D40, 0x821A, 0x88F0

_TEXTURE_2D, _READ_FRAMEBUFFER, _DRAW_FRAMEBUFFER, _COLOUR_BUFFER_BIT, _NEAREST = 0x0DE1, 0x8CA8, 0x8CA9, 0x4000, 0x2600

_RGBA, _BGRA, _UNSIGNED_BYTE = 0x1908, 0x80E1, 0x1401
_DEPTH_COMPONENT32F, _DEPTH_COMPONENT, _GL_FLOAT = 0x8CAC, 0x1902, 0x1406

_UINT, _INT, _BYTE, _FLOAT = ctypes.c_uint, ctypes.c_int, ctypes.c_ubyte, ctypes.c_float
_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "glFlush": (),
    "glStencilFunc": (_UINT, _INT, _UINT),
    "glStencilOpSeparate": (_UINT, _UINT, _UINT, _UINT),
    "glClearStencil": (_INT,),
    "glStencilMask": (_UINT,),
    "glClear": (_UINT,),
    "glColorMask": (_BYTE, _BYTE, _BYTE, _BYTE),
    "glGenRenderbuffers": (_INT, ctypes.POINTER(_UINT)),
    "glDeleteRenderbuffers": (_INT, ctypes.POINTER(_UINT)),
    "glBindRenderbuffer": (_UINT, _UINT),
    "glRenderbufferStorageMultisample": (_UINT, _INT, _UINT, _INT, _INT),
    "glBindFramebuffer": (_UINT, _UINT),
    "glViewportIndexedf": (_UINT, _FLOAT, _FLOAT, _FLOAT, _FLOAT),
    "glBlitFramebuffer": (*(_INT,) * 8, _UINT, _UINT),
    "glBindTexture": (_UINT, _UINT),
    "glTexImage2D": (_UINT, *(_INT,) * 5, _UINT, _UINT, ctypes.c_void_p),
    "glBindVertexArray": (_UINT,),
    "glVertexAttribDivisor": (_UINT, _UINT),
    "glCopyImageSubData": (_UINT, _UINT, *(_INT,) * 4, _UINT, _UINT, *(_INT,) * 7),
    "glFramebufferRenderbuffer": (_UINT, _UINT, _UINT, _UINT),
}

Corners = tuple[int, int, int, int]
"""Left, bottom, right and top of a rectangle [px]."""


def function_address(ctx: moderngl.Context, name: str) -> int:
    """Return the address of an OpenGL function; 0 where the driver has none."""
    loader: Any = ctx.mglo._context  # moderngl's own function loader
    return int(loader.load_opengl_function(name))


class RawGL:
    """Functions by their addresses from the context's own loader, for EGL, OSMesa and windows alike."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._calls = {
            name: ctypes.CFUNCTYPE(None, *arguments)(function_address(ctx, name))
            for name, arguments in _ARGUMENTS.items()
        }
        self._buffers: dict[int, tuple[moderngl.Framebuffer, int]] = {}

    def attach_stencil(self, framebuffer: moderngl.Framebuffer, samples: int) -> None:
        """Replace a framebuffer's depth buffer by one with stencil, until `release`."""
        width, height = framebuffer.size
        had = self._buffers.get(framebuffer.glo)
        if had is not None and had[0] is framebuffer:
            return
        if had is not None:  # the driver reused the name of a freed framebuffer
            self._delete(had[1])
        name = _UINT()
        self._calls["glGenRenderbuffers"](1, ctypes.byref(name))
        self._calls["glBindRenderbuffer"](_RENDERBUFFER, name.value)
        self._calls["glRenderbufferStorageMultisample"](_RENDERBUFFER, samples, _DEPTH24_STENCIL8, width, height)
        self._calls["glBindFramebuffer"](_FRAMEBUFFER, framebuffer.glo)
        place = (_FRAMEBUFFER, _DEPTH_STENCIL_ATTACHMENT, _RENDERBUFFER)
        self._calls["glFramebufferRenderbuffer"](*place, name.value)
        self._buffers[framebuffer.glo] = framebuffer, name.value

    def flush(self) -> None:
        """Let the driver start the commands submitted so far."""
        self._calls["glFlush"]()

    def use_viewports(self, places: Sequence[tuple[int, int, int, int]]) -> None:
        """Set the viewports [px] that a vertex shader selects from; valid until the viewport is set again."""
        for number, place in enumerate(places):
            self._calls["glViewportIndexedf"](number, *place)

    def set_divisor(self, array: int, locations: Sequence[int], instances: int) -> None:
        """Advance attributes of a vertex array only once per some instances."""
        self._calls["glBindVertexArray"](array)
        for location in locations:
            self._calls["glVertexAttribDivisor"](location, instances)

    def store_as_bgra(self, texture: moderngl.Texture) -> None:
        """Store the bytes of a texture as blue, green, red, alpha; its content is undefined afterwards."""
        self._calls["glBindTexture"](_TEXTURE_2D, texture.glo)
        form = (_RGBA, *texture.size, 0, _BGRA, _UNSIGNED_BYTE)  # drivers choose the order of the pixels given
        self._calls["glTexImage2D"](_TEXTURE_2D, 0, *form, None)

    def store_as_float(self, texture: moderngl.Texture) -> None:
        """Store the depths of a texture in single precision; its content is undefined afterwards."""
        self._calls["glBindTexture"](_TEXTURE_2D, texture.glo)
        form = (_DEPTH_COMPONENT32F, *texture.size, 0, _DEPTH_COMPONENT, _GL_FLOAT)
        self._calls["glTexImage2D"](_TEXTURE_2D, 0, *form, None)

    def copy_texels(self, source: moderngl.Texture, target: moderngl.Texture, place: tuple[int, int, int, int]) -> None:
        """Copy a rectangle [texel] of one texture to the same place in another one of the same format."""
        x, y, width, height = place
        each = [(texture.glo, _TEXTURE_2D, 0, x, y, 0) for texture in (source, target)]
        self._calls["glCopyImageSubData"](*each[0], *each[1], width, height, 1)

    def copy_colours(
        self,
        source: moderngl.Framebuffer,
        target: moderngl.Framebuffer,
        places: Sequence[tuple[int, int, int, int]],
    ) -> None:
        """Copy and resolve rectangles [px] of a framebuffer's colours to the same places in another one.

        Changes the framebuffer in use.
        """
        target.scissor = None  # type: ignore[assignment]  # disables it
        target.use()
        corners = [(x, y, x + width, y + height) for x, y, width, height in places]
        self.blit(source.glo, target.glo, [(each, each) for each in corners])

    def blit(self, source: int, target: int, corners: Sequence[tuple[Corners, Corners]]) -> None:
        """Copy rectangles of one framebuffer's colours to another one; changes the framebuffers in use.

        Args:
            source: Name of the framebuffer to read.
            target: Name of the framebuffer to draw into; 0: the window's.
            corners: Corners in both; rows are reversed where the bottom is above the top in one of them.
        """
        self._calls["glBindFramebuffer"](_READ_FRAMEBUFFER, source)
        self._calls["glBindFramebuffer"](_DRAW_FRAMEBUFFER, target)
        for read, drawn in corners:
            self._calls["glBlitFramebuffer"](*read, *drawn, _COLOUR_BUFFER_BIT, _NEAREST)

    def clear_stencil(self) -> None:
        """Set the stencil of the framebuffer in use to 0."""
        self._calls["glStencilMask"](0xFF)
        self._calls["glClearStencil"](0)
        self._calls["glClear"](_STENCIL_BUFFER_BIT)

    def count_faces(self) -> None:
        """Count faces that fail the depth test in the stencil: +1 for back faces, -1 for front faces (Carmack 2000).

        Colours are not written, and depth is clamped, so that volumes may cross the near and the far plane.
        """
        self._calls["glColorMask"](0, 0, 0, 0)
        self._ctx.enable_direct(_STENCIL_TEST)
        self._ctx.enable_direct(_DEPTH_CLAMP)
        self._calls["glStencilFunc"](ALWAYS, 0, 0xFF)
        self._calls["glStencilOpSeparate"](_BACK, KEEP, INCREMENT, KEEP)
        self._calls["glStencilOpSeparate"](_FRONT, KEEP, DECREMENT, KEEP)

    def draw_where(self, test: int) -> None:
        """Restrict drawing to pixels whose stencil is EQUAL or NOT_EQUAL to 0."""
        self._ctx.enable_direct(_STENCIL_TEST)
        self._ctx.disable_direct(_DEPTH_CLAMP)
        self._calls["glStencilFunc"](test, 0, 0xFF)
        for face in (_FRONT, _BACK):
            self._calls["glStencilOpSeparate"](face, KEEP, KEEP, KEEP)

    def draw_everywhere(self) -> None:
        """Draw colours without a stencil test again."""
        self._calls["glColorMask"](1, 1, 1, 1)
        self._ctx.disable_direct(_STENCIL_TEST)
        self._ctx.disable_direct(_DEPTH_CLAMP)

    def release(self) -> None:
        """Free the stencil buffers; their framebuffers have no depth afterwards."""
        for _, name in self._buffers.values():
            self._delete(name)
        self._buffers.clear()

    def _delete(self, name: int) -> None:
        self._calls["glDeleteRenderbuffers"](1, ctypes.byref(_UINT(name)))
