"""OpenXR through pyopenxr (extra `hmd`): instance, session, swapchains, frames.

The loader prints to stderr unless switched off before it is imported, and importing it takes a tenth of a second
and more; so the module `xr` is imported by `load_openxr` alone, and only where a runtime says that it is there.
"""

from __future__ import annotations

import ctypes
import importlib.util
import math
import os
import platform
import sys
from contextlib import suppress
from ctypes import POINTER, byref, c_void_p, cast, pointer
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app import __version__
from mimics_app.contracts.clock import Clock, MonotonicClock
from mimics_app.contracts.display_port import DisplayFrame, FrameTiming, HeadsetState, Size
from mimics_app.contracts.errors import DeviceError
from mimics_app.maths.poses import pose_from_parts
from mimics_app.rendering.visual.displays.headset_session import EyeLocation, HeadsetRuntime
from mimics_app.rendering.visual.displays.openxr_binding import EGL_EXTENSION, copy_image, graphics_binding

if TYPE_CHECKING:
    from types import ModuleType

    import xr

__all__ = ["OpenXrRuntime", "load_openxr", "no_runtime"]

F8 = NDArray[np.float64]
_NS = 1_000_000_000
_FORMATS = (0x8C43, 0x8058)
"""SRGB8_ALPHA8, then RGBA8: both take display values bit for bit."""
_TIME_EXTENSION = "XR_KHR_convert_timespec_time"


def load_openxr() -> ModuleType:
    """The module `xr`, its loader silenced.

    Raises:
        DeviceError: pyopenxr is not installed.
    """
    os.environ.setdefault("XR_LOADER_DEBUG", "none")
    try:
        import xr  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        raise DeviceError("pyopenxr is not installed", "pip install mimics_app[hmd]") from None
    return xr  # type: ignore[no-any-return,unused-ignore]


def no_runtime() -> str:
    """Why no OpenXR runtime can be had, in words; "" where there is one.

    What has no runtime at all is found out by looking for files, without the loader.
    """
    if importlib.util.find_spec("xr") is None:
        return "pyopenxr is not installed; pip install mimics_app[hmd]"
    if sys.platform == "linux":
        named = os.environ.get("XR_RUNTIME_JSON")
        if named and not Path(named).is_file():
            return f"no OpenXR runtime: XR_RUNTIME_JSON names {named}, which is not there"
        if not named and not any(file.is_file() for file in _manifests()):
            return "no OpenXR runtime: none is set as active (openxr/1/active_runtime.json), nor by XR_RUNTIME_JSON"
    try:
        xr = load_openxr()
    except DeviceError as error:
        return str(error)
    try:
        xr.enumerate_instance_extension_properties()
    except Exception as error:  # noqa: BLE001  the loader's errors share no useful base
        return f"no OpenXR runtime: {' '.join(str(error).split()) or type(error).__name__}"
    return ""


def _manifests() -> list[Path]:
    """Where the loader looks for the active runtime (OpenXR loader, "Desktop Active Runtime File Location")."""
    own = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    shared = (os.environ.get("XDG_CONFIG_DIRS") or "/etc/xdg").split(":")
    folders = [own, *map(Path, shared), Path("/usr/local/etc"), Path("/etc")]
    names = (f"active_runtime.{platform.machine()}.json", "active_runtime.json")
    return [folder / "openxr" / "1" / name for folder in folders for name in names]


class OpenXrRuntime(HeadsetRuntime):
    """A headset of this machine; the surface's context must be current.

    Args:
        backend: Of the surface: "egl" or "window".
        clock: The session's; OpenXR's time is converted to it.

    Raises:
        DeviceError: no runtime, no headset, or a context it does not take.
    """

    def __init__(self, backend: str, clock: Clock | None = None) -> None:
        self._xr = load_openxr()
        self._backend, self._clock = backend, clock or MonotonicClock()
        try:
            self._open()
        except self._xr.exception.XrException as error:
            raise DeviceError(f"OpenXR: {error or type(error).__name__}", "start the headset's runtime") from None

    def eye_size(self, shown: Size) -> Size:
        return self._size

    def states(self) -> list[HeadsetState]:
        xr, entered = self._xr, list[HeadsetState]()
        while True:
            try:
                event = xr.poll_event(self._instance)
            except xr.EventUnavailable:
                return entered
            if event.type == xr.StructureType.EVENT_DATA_SESSION_STATE_CHANGED:
                changed = cast(byref(event), POINTER(xr.EventDataSessionStateChanged)).contents
                name = xr.SessionState(changed.state).name.lower()
                with suppress(ValueError):  # a state that an extension brings
                    entered.append(HeadsetState(name))
            elif event.type == xr.StructureType.EVENT_DATA_INSTANCE_LOSS_PENDING:
                entered.append(HeadsetState.LOSS_PENDING)

    def begin_session(self) -> None:
        xr = self._xr
        xr.begin_session(
            self._session,
            xr.SessionBeginInfo(primary_view_configuration_type=xr.ViewConfigurationType.PRIMARY_STEREO),
        )

    def end_session(self) -> None:
        self._xr.end_session(self._session)

    def rebuild(self) -> None:
        self.close()
        self._open()

    def wait_frame(self, now_ns: int) -> FrameTiming:
        # Through ctypes: the haptic thread and Python's others run on while this one waits.
        self._state = self._xr.wait_frame(self._session, self._xr.FrameWaitInfo())
        display = int(self._state.predicted_display_time)
        return FrameTiming(
            self._to_session(display), int(self._state.predicted_display_period), bool(self._state.should_render)
        )

    def begin_frame(self) -> None:
        self._xr.begin_frame(self._session, self._xr.FrameBeginInfo())

    def locate(self, display_ns: int) -> list[EyeLocation]:
        xr = self._xr
        _, views = xr.locate_views(
            self._session,
            xr.ViewLocateInfo(
                view_configuration_type=xr.ViewConfigurationType.PRIMARY_STEREO,
                display_time=self._state.predicted_display_time,
                space=self._space,
            ),
        )
        self._views = views
        return [_location(view) for view in views]

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        xr = self._xr
        layers = [] if frame is None else [byref(self._project(frame))]
        xr.end_frame(
            self._session,
            xr.FrameEndInfo(
                display_time=self._state.predicted_display_time,
                environment_blend_mode=xr.EnvironmentBlendMode.OPAQUE,
                layers=layers,
            ),
        )

    def close(self) -> None:
        xr = self._xr
        with suppress(xr.exception.XrException):  # of a runtime that is gone nothing can be freed
            xr.destroy_swapchain(self._swapchain)
            xr.destroy_session(self._session)
            xr.destroy_instance(self._instance)

    def _open(self) -> None:
        xr = self._xr
        wanted = [xr.KHR_OPENGL_ENABLE_EXTENSION_NAME, _TIME_EXTENSION]
        wanted += [EGL_EXTENSION] if self._backend == "egl" else []
        application = xr.ApplicationInfo(application_name=f"mimics {__version__}", api_version=xr.Version(1, 0, 0))
        info = xr.InstanceCreateInfo(application_info=application, enabled_extension_names=wanted)
        self._instance = xr.create_instance(info)
        system = xr.get_system(self._instance, xr.SystemGetInfo(form_factor=xr.FormFactor.HEAD_MOUNTED_DISPLAY))
        self._ask_requirements(system)
        binding = graphics_binding(xr, self._backend)
        info = xr.SessionCreateInfo(system_id=system, next=cast(pointer(binding), c_void_p))
        self._session = xr.create_session(self._instance, info)
        self._space = xr.create_reference_space(
            self._session, xr.ReferenceSpaceCreateInfo(reference_space_type=xr.ReferenceSpaceType.LOCAL)
        )
        self._make_swapchain(system)
        self._offset_ns = self._clock_offset()

    def _ask_requirements(self, system: int) -> None:
        """Obligatory before a session is created, whatever the answer."""
        xr, needs = self._xr, self._xr.GraphicsRequirementsOpenGLKHR()
        address = xr.get_instance_proc_addr(self._instance, "xrGetOpenGLGraphicsRequirementsKHR")
        cast(address, xr.PFN_xrGetOpenGLGraphicsRequirementsKHR)(self._instance, system, byref(needs))

    def _make_swapchain(self, system: int) -> None:
        """One wide picture for both eyes: each is a rectangle of it."""
        xr = self._xr
        views = xr.enumerate_view_configuration_views(self._instance, system, xr.ViewConfigurationType.PRIMARY_STEREO)
        self._size = (views[0].recommended_image_rect_width, views[0].recommended_image_rect_height)
        offered = list(xr.enumerate_swapchain_formats(self._session))
        chosen = next((one for one in _FORMATS if one in offered), None)
        if chosen is None:
            raise DeviceError("the headset takes no pictures of 8 bits a colour", "update its runtime")
        flags = xr.SwapchainUsageFlags
        self._swapchain = xr.create_swapchain(
            self._session,
            xr.SwapchainCreateInfo(
                usage_flags=flags.COLOR_ATTACHMENT_BIT | flags.SAMPLED_BIT | flags.TRANSFER_DST_BIT,
                format=chosen,
                sample_count=1,
                width=2 * self._size[0],
                height=self._size[1],
                face_count=1,
                array_size=1,
                mip_count=1,
            ),
        )
        self._images = [
            image.image for image in xr.enumerate_swapchain_images(self._swapchain, xr.SwapchainImageOpenGLKHR)
        ]

    def _clock_offset(self) -> int:
        """Session time minus OpenXR's time [ns]; both count at the same rate."""
        xr = self._xr
        address = xr.get_instance_proc_addr(self._instance, "xrConvertTimespecTimeToTimeKHR")
        moment, converted = _Timespec(), ctypes.c_int64()
        now_ns = self._clock.now_ns()
        moment.seconds, moment.nanoseconds = divmod(MonotonicClock().now_ns(), _NS)
        convert = ctypes.CFUNCTYPE(ctypes.c_int, c_void_p, POINTER(_Timespec), POINTER(ctypes.c_int64))
        if cast(address, convert)(cast(self._instance, c_void_p), byref(moment), byref(converted)) != 0:
            raise DeviceError("OpenXR does not convert its time", "update the headset's runtime")
        return now_ns - int(converted.value)

    def _to_session(self, xr_time: int) -> int:
        return xr_time + self._offset_ns

    def _project(self, frame: DisplayFrame) -> Any:
        """Copy the picture into the swapchain and describe it with the very poses it was drawn from."""
        xr = self._xr
        index = xr.acquire_swapchain_image(self._swapchain, xr.SwapchainImageAcquireInfo())
        xr.wait_swapchain_image(self._swapchain, xr.SwapchainImageWaitInfo(timeout=xr.INFINITE_DURATION))
        copy_image(self._backend, frame.texture, 0, self._images[index], 0, frame.size)
        xr.release_swapchain_image(self._swapchain, xr.SwapchainImageReleaseInfo())
        width, height = self._size
        parts = [
            xr.CompositionLayerProjectionView(
                pose=view.pose,
                fov=view.fov,
                sub_image=xr.SwapchainSubImage(
                    swapchain=self._swapchain,
                    image_rect=xr.Rect2Di(xr.Offset2Di(number * width, 0), xr.Extent2Di(width, height)),
                    image_array_index=0,
                ),
            )
            for number, view in enumerate(self._views)
        ]
        self._parts = (xr.CompositionLayerProjectionView * 2)(*parts)  # kept alive until the frame has ended
        self._layer = xr.CompositionLayerProjection(space=self._space, views=self._parts)
        return self._layer


class _Timespec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


def _location(view: xr.View) -> EyeLocation:
    place, turn, fov = view.pose.position, view.pose.orientation, view.fov
    pose = pose_from_parts((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
    tangents = (fov.angle_left, fov.angle_right, fov.angle_down, fov.angle_up)
    left, right, bottom, top = (math.tan(angle) for angle in tangents)
    return EyeLocation(pose, (left, right, bottom, top))
