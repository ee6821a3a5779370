"""OpenGL contexts as graphics bindings of OpenXR, by EGL or GLX, with the actual configuration and visual id.

The context must be current on this thread. `xr.utils` of pyopenxr is not used, since it sets both to 0.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_int, c_uint, c_ulong, c_void_p, cast
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import DeviceError

if TYPE_CHECKING:
    from types import ModuleType

__all__ = ["EGL_EXTENSION", "OwnContext", "graphics_binding"]

EGL_EXTENSION = "XR_MNDX_egl_enable"

_EGL_CONFIG_ID, _EGL_NONE, _EGL_DRAW, _EGL_READ = 0x3028, 0x3038, 0x3059, 0x305A
_GLX_FBCONFIG_ID, _GLX_VISUAL_ID = 0x8013, 0x800B
_TEXTURE_2D = 0x0DE1
_FIX = "use a desktop display, or --display sim-hmd"


def graphics_binding(xr: ModuleType, backend: str) -> Any:
    """Return the graphics binding of the current context, for creating a session.

    Args:
        xr: The pyopenxr module.
        backend: Backend of the surface: "egl" or "window".

    Raises:
        DeviceError: another backend, or no usable context is current.
    """
    if backend == "egl":
        return _egl_binding(xr)
    if backend == "window":
        return _glx_binding(xr)
    raise DeviceError(f"OpenXR does not support contexts of {backend}", _FIX)


def _library(name: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise DeviceError(f"the library {name} is missing: {error}", _FIX) from None


def _egl_binding(xr: ModuleType) -> Any:
    from xr.platform import linux  # type: ignore[import-not-found,unused-ignore]

    egl = _library("libEGL.so.1")
    for name in ("eglGetCurrentDisplay", "eglGetCurrentContext"):
        getattr(egl, name).restype = c_void_p
    egl.eglQueryContext.argtypes = [c_void_p, c_void_p, c_int, POINTER(c_int)]
    egl.eglChooseConfig.argtypes = [c_void_p, POINTER(c_int), POINTER(c_void_p), c_int, POINTER(c_int)]
    display, context = egl.eglGetCurrentDisplay(), egl.eglGetCurrentContext()
    number, count, config = c_int(), c_int(), c_void_p()
    if not context or not egl.eglQueryContext(display, context, _EGL_CONFIG_ID, byref(number)):
        raise DeviceError("no EGL context is current", _FIX)
    wanted = (c_int * 3)(_EGL_CONFIG_ID, number.value, _EGL_NONE)
    if not egl.eglChooseConfig(display, wanted, byref(config), 1, byref(count)) or count.value < 1:
        raise DeviceError("the EGL context's configuration cannot be found", _FIX)
    # Plain integers are rejected: the structure has its own pointer types.
    return xr.GraphicsBindingEGLMNDX(
        get_proc_address=cast(egl.eglGetProcAddress, xr.PFN_xrEglGetProcAddressMNDX),
        display=cast(c_void_p(display), linux.EGLDisplay),
        config=cast(config, linux.EGLConfig),
        context=cast(c_void_p(context), linux.EGLContext),
    )


def _glx_binding(xr: ModuleType) -> Any:
    gl = _library("libGL.so.1")
    for name in ("glXGetCurrentDisplay", "glXGetCurrentContext", "glXGetCurrentDrawable"):
        getattr(gl, name).restype = c_void_p
    gl.glXQueryContext.argtypes = [c_void_p, c_void_p, c_int, POINTER(c_int)]
    gl.glXChooseFBConfig.restype = POINTER(c_void_p)
    gl.glXChooseFBConfig.argtypes = [c_void_p, c_int, POINTER(c_int), POINTER(c_int)]
    gl.glXGetFBConfigAttrib.argtypes = [c_void_p, c_void_p, c_int, POINTER(c_int)]
    display, context = gl.glXGetCurrentDisplay(), gl.glXGetCurrentContext()
    if not context:
        raise DeviceError("no GLX context is current", "run under X11: DISPLAY, not Wayland alone")
    number, count, visual = c_int(), c_int(), c_int()
    gl.glXQueryContext(display, context, _GLX_FBCONFIG_ID, byref(number))
    wanted = (c_int * 3)(_GLX_FBCONFIG_ID, number.value, 0)
    configs = gl.glXChooseFBConfig(display, 0, wanted, byref(count))
    if not configs or count.value < 1:
        raise DeviceError("the GLX context's configuration cannot be found", _FIX)
    gl.glXGetFBConfigAttrib(display, configs[0], _GLX_VISUAL_ID, byref(visual))
    kinds = dict(xr.GraphicsBindingOpenGLXlibKHR._fields_)
    return xr.GraphicsBindingOpenGLXlibKHR(
        x_display=cast(c_void_p(display), kinds["x_display"]),
        visualid=visual.value,
        glx_fbconfig=cast(c_void_p(configs[0]), kinds["glx_fbconfig"]),
        glx_drawable=gl.glXGetCurrentDrawable() or 0,
        glx_context=cast(c_void_p(context), kinds["glx_context"]),
    )


class OwnContext:
    """The context that is current on this thread, to be restored after runtime calls, and to copy textures in.

    Args:
        backend: Backend of the surface: "egl" or "window".

    Raises:
        DeviceError: another backend.
    """

    def __init__(self, backend: str) -> None:
        if backend not in ("egl", "window"):
            raise DeviceError(f"OpenXR does not support contexts of {backend}", _FIX)
        egl = backend == "egl"
        library = _library("libEGL.so.1" if egl else "libGL.so.1")
        prefix = "egl" if egl else "glX"
        drawable = c_void_p if egl else c_ulong
        self._current = getattr(library, f"{prefix}GetCurrentContext")
        self._current.restype, self._current.argtypes = c_void_p, []
        self._context = self._current()
        display = getattr(library, f"{prefix}GetCurrentDisplay")
        display.restype = c_void_p
        if egl:
            surface = library.eglGetCurrentSurface
            surface.restype, surface.argtypes = c_void_p, [c_int]
            drawables = [surface(_EGL_DRAW), surface(_EGL_READ)]
        else:
            library.glXGetCurrentDrawable.restype = c_ulong
            drawables = [library.glXGetCurrentDrawable()]
        self._make = getattr(library, f"{prefix}MakeCurrent")
        self._make.argtypes = [c_void_p, *[drawable] * len(drawables), c_void_p]
        self._arguments = [display(), *drawables, self._context]
        loader = getattr(library, "eglGetProcAddress" if egl else "glXGetProcAddress")
        loader.restype, loader.argtypes = c_void_p, [ctypes.c_char_p]
        arguments = [c_uint, c_uint, *[c_int] * 4, c_uint, c_uint, *[c_int] * 4, *[c_int] * 3]
        self._copy = ctypes.CFUNCTYPE(None, *arguments)(loader(b"glCopyImageSubData"))

    def take_back(self) -> None:
        """Make it current again where it is not: some runtimes leave their own or none current (pyopenxr#55)."""
        if self._current() != self._context:
            self._make(*self._arguments)

    def copy_image(self, source: int, target: int, size: tuple[int, int]) -> None:
        """Copy a texture bit for bit: display values are written to an sRGB image without encoding them again.

        Args:
            source: RGBA texture, 8 bits per channel.
            target: Texture of a swapchain, sRGB with alpha, 8 bits per channel.
            size: Size of both [px].
        """
        self._copy(source, _TEXTURE_2D, 0, 0, 0, 0, target, _TEXTURE_2D, 0, 0, 0, 0, *size, 1)
