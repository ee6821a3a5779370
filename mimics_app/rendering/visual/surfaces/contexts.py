"""The one factory of GL contexts: a window, EGL without a display, or OSMesa without a driver."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import DeviceError, UsageError, nearest
from mimics_app.rendering.visual.surfaces.surface import Size, Surface

if TYPE_CHECKING:
    import moderngl

__all__ = ["create_surface"]

_GL_REQUIRED = 430
"""OpenGL 4.3 core: multi-draw-indirect and shader storage."""

_BACKENDS = ("window", "egl", "osmesa")

_EGL = "libEGL.so.1"
"""Usual name of the library; the search for it by its short name would run a process."""

_APT_EGL = "install it with: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"
_APT_OSMESA = "install it with: apt-get install libosmesa6 (Mesa before 25.1), or use --backend egl"
_OSMESA_NAMES = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")


def create_surface(
    backend: str, size: Size, title: str = "mimics", *, vsync: bool = True, stereo: bool = False
) -> Surface:
    """Create a context and its surface.

    Args:
        backend: "window", "egl" or "osmesa".
        size: Width and height [px], each >= 1.
        title: Title of the window; unused by other backends.
        vsync: Whether a window's `swap` waits for the display.
        stereo: Whether a window has quad buffers, one back buffer per eye.

    Raises:
        UsageError: unknown backend, or a size below 1 px.
        DeviceError: the library, the driver or the display is missing; names the package to install.
    """
    if backend not in _BACKENDS:
        raise UsageError(f'no graphics backend "{backend}"', nearest(backend, _BACKENDS))
    if min(size) < 1:
        raise UsageError(f"a picture of {size[0]} x {size[1]} pixels is not possible", "give a size like 1280x720")
    if backend == "window":
        return create_window(size, title, vsync=vsync, stereo=stereo)
    return _EglSurface(size) if backend == "egl" else _OSMesaSurface(_OSMesaLoader(), size)


def create_window(
    size: Size | None,
    title: str,
    *,
    vsync: bool = True,
    stereo: bool = False,
    scene: bool = True,
    visible: bool = True,
) -> Surface:
    """Create a window as `create_surface` does; without a size, of one that suits the monitor.

    Args:
        size: Width and height [px], or None.
        title: Title.
        vsync: Whether `swap` waits for the display.
        stereo: Whether it has quad buffers.
        scene: Whether a scene is drawn in it; False: pages of words, which may be large in software too.
        visible: Whether it is on the desktop at once; False: with `Surface.show`.

    Raises:
        DeviceError: See `create_surface`.
    """
    from mimics_app.rendering.visual.surfaces.window import WindowSurface

    return WindowSurface(size, title, vsync=vsync, stereo=stereo, scene=scene, visible=visible)


class _EglSurface(Surface):
    """Offscreen surface of the EGL driver."""

    def __init__(self, size: Size) -> None:
        super().__init__("egl", _create_egl_context(), size)

    def renew(self) -> None:
        self.close()
        self._take(_create_egl_context())

    def close(self) -> None:
        # A destroyed EGL context stays current until unbound, and a window opened later in this thread is refused.
        library = ctypes.CDLL(_EGL)
        library.eglGetCurrentDisplay.restype = ctypes.c_void_p
        library.eglMakeCurrent.argtypes = [ctypes.c_void_p] * 4
        display = library.eglGetCurrentDisplay()
        super().close()
        library.eglMakeCurrent(display, None, None, None)


def _create_egl_context() -> moderngl.Context:
    import moderngl

    create: Any = moderngl.create_context  # its signature omits the backend's settings
    try:
        context: moderngl.Context = create(
            standalone=True, backend="egl", require=_GL_REQUIRED, libgl="libGL.so.1", libegl=_EGL
        )
    except Exception as error:  # glcontext raises plain Exception
        raise DeviceError(f"no EGL context with OpenGL 4.3 ({error})", _APT_EGL) from error
    return context


class _OSMesaLoader:
    """An OSMesa context as moderngl's function loader.

    The glcontext package has no OSMesa backend, and its EGL backend with libOSMesa is still EGL.
    """

    _FORMAT, _RGBA, _DEPTH_BITS, _STENCIL_BITS = 0x22, 0x1908, 0x30, 0x31
    _PROFILE, _CORE, _MAJOR, _MINOR = 0x33, 0x34, 0x36, 0x37
    _UNSIGNED_BYTE = 0x1401

    def __init__(self) -> None:
        self._library = self._open()
        self._declare()
        attributes = (ctypes.c_int * 14)(
            *(self._FORMAT, self._RGBA, self._DEPTH_BITS, 24, self._STENCIL_BITS, 8),
            *(self._PROFILE, self._CORE, self._MAJOR, 4, self._MINOR, 3, 0, 0),
        )
        self._context = self._library.OSMesaCreateContextAttribs(attributes, None)
        if not self._context:
            raise DeviceError("OSMesa refuses an OpenGL 4.3 core context", _APT_OSMESA)
        # The default framebuffer, which is required; one pixel is enough, since framebuffer objects are drawn into.
        self._screen = (ctypes.c_ubyte * 4)()
        if not self._library.OSMesaMakeCurrent(self._context, self._screen, self._UNSIGNED_BYTE, 1, 1):
            raise DeviceError("OSMesa does not make its context current", _APT_OSMESA)

    @staticmethod
    def _open() -> ctypes.CDLL:
        for name in _OSMESA_NAMES:
            try:
                return ctypes.CDLL(name)
            except OSError:
                continue
        raise DeviceError("the OSMesa library is missing", _APT_OSMESA)

    def _declare(self) -> None:
        pointer, integer = ctypes.c_void_p, ctypes.c_int
        library = self._library
        library.OSMesaCreateContextAttribs.restype = pointer
        library.OSMesaCreateContextAttribs.argtypes = [ctypes.POINTER(integer), pointer]
        library.OSMesaGetProcAddress.restype = pointer
        library.OSMesaGetProcAddress.argtypes = [ctypes.c_char_p]
        library.OSMesaMakeCurrent.argtypes = [pointer, pointer, ctypes.c_uint, integer, integer]
        library.OSMesaDestroyContext.argtypes = [pointer]

    def load_opengl_function(self, name: str) -> int:
        """Return the address of a GL function, 0 when there is none."""
        return self._library.OSMesaGetProcAddress(name.encode()) or 0

    load = load_opengl_function

    def __enter__(self) -> None:
        """Do nothing: moderngl enters the context before use from another thread, and this one stays current."""

    def __exit__(self, *exception: object) -> None:
        """Do nothing; see `__enter__`."""

    def release(self) -> None:
        """Destroy the context; further calls do nothing."""
        if self._context:
            self._library.OSMesaDestroyContext(self._context)
            self._context = None


class _OSMesaSurface(Surface):
    """Offscreen surface that owns its loader, and with it the context."""

    def __init__(self, loader: _OSMesaLoader, size: Size) -> None:
        self._loader = loader
        super().__init__("osmesa", _adopt(loader), size)

    def renew(self) -> None:
        self.close()
        self._loader = _OSMesaLoader()
        self._take(_adopt(self._loader))


def _adopt(loader: _OSMesaLoader) -> moderngl.Context:
    import moderngl

    create: Any = moderngl.create_context  # its signature omits the loader
    context: moderngl.Context = create(require=_GL_REQUIRED, context=loader)
    return context
