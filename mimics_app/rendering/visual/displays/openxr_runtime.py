"""OpenXR through pyopenxr (extra `hmd`): instance, session, swapchains, frames.

The loader prints to stderr unless that is disabled before the import, which takes at least a tenth of a second; so the
module `xr` is imported by `_load_openxr` alone, and only where a runtime is installed.
"""

from __future__ import annotations

import ctypes
import importlib.util
import math
import os
import platform
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from ctypes import POINTER, byref, c_void_p, cast, pointer
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.display_port import DisplayFrame, FrameTiming, HeadsetState, Size
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.contracts.version import __version__
from mimics_app.maths.poses import pose_from_parts
from mimics_app.rendering.visual.displays.headset_session import (
    EyeLocation,
    HeadsetRuntime,
    RuntimeLostError,
    sample_of,
)
from mimics_app.rendering.visual.displays.openxr_binding import EGL_EXTENSION, OwnContext, graphics_binding
from mimics_app.rendering.visual.displays.openxr_hands import OpenXrHands

if TYPE_CHECKING:
    from types import ModuleType

    import xr

__all__ = ["OpenXrRuntime", "no_runtime"]

_NS = 1_000_000_000
_SRGB8_ALPHA8 = 0x8C43
"""Swapchain format for display values; compositors take 8-bit values of any other format for linear light."""
_VALID = 3
"""Flags of a valid orientation (1) and position (2)."""
_STOP_TIMEOUT_NS = 1_000_000_000
"""Time-out of a session that was asked to stop [ns]."""
_TIME_EXTENSION = "XR_KHR_convert_timespec_time"


def _load_openxr() -> ModuleType:
    """Import and return the module `xr`, its loader silenced.

    Raises:
        DeviceError: pyopenxr is not installed.
    """
    os.environ.setdefault("XR_LOADER_DEBUG", "none")
    try:
        import xr  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        raise DeviceError("pyopenxr is not installed", "pip install mimics_app[hmd]") from None
    # "Not focused" and "frame discarded" are results, not errors.
    xr.exception.raise_on_qualified_success = False
    return xr  # type: ignore[no-any-return,unused-ignore]


def no_runtime() -> str:
    """Return why no OpenXR runtime is available, in words; "" where there is one.

    A machine without any runtime is recognised by its files, without the loader.
    """
    if importlib.util.find_spec("xr") is None:
        return "pyopenxr is not installed; pip install mimics_app[hmd]"
    if sys.platform == "linux":
        named = os.environ.get("XR_RUNTIME_JSON")
        if named and not Path(named).is_file():
            return f"no OpenXR runtime: XR_RUNTIME_JSON names {named}, which does not exist"
        if not named and not any(file.is_file() for file in _manifests()):
            return "no OpenXR runtime: none is set as active (openxr/1/active_runtime.json), nor by XR_RUNTIME_JSON"
    try:
        xr = _load_openxr()
    except DeviceError as error:
        return str(error)
    try:
        xr.enumerate_instance_extension_properties()
    except Exception as error:  # noqa: BLE001  the loader's errors have no useful common base
        return f"no OpenXR runtime: {_words(error)}"
    return ""


def _manifests() -> list[Path]:
    """Return the files of the active runtime in the loader's order ("Desktop Active Runtime File Location")."""
    own = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    shared = (os.environ.get("XDG_CONFIG_DIRS") or "/etc/xdg").split(":")
    folders = [own, *map(Path, shared), Path("/usr/local/etc"), Path("/etc")]
    names = (f"active_runtime.{platform.machine()}.json", "active_runtime.json")
    return [folder / "openxr" / "1" / name for folder in folders for name in names]


class OpenXrRuntime(HeadsetRuntime):
    """The headset of this machine; the surface's context must be current.

    Args:
        backend: Backend of the surface: "egl" or "window".

    Raises:
        DeviceError: no runtime, no headset, or an unsupported context.
    """

    def __init__(self, backend: str) -> None:
        self._xr = _load_openxr()
        self._backend, self._clock = backend, MonotonicClock()
        self._state = HeadsetState.IDLE
        self._display, self._display_ns = 0, 0
        self._views: Any = None
        self._located: list[EyeLocation] = []
        self._open()

    def eye_size(self, shown: Size) -> Size:
        return self._size

    def states(self) -> list[HeadsetState]:
        xr, entered = self._xr, list[HeadsetState]()
        with self._calling():
            while (event := xr.poll_event(self._instance)).type != xr.StructureType.EVENT_DATA_BUFFER:
                if event.type == xr.StructureType.EVENT_DATA_SESSION_STATE_CHANGED:
                    changed = cast(byref(event), POINTER(xr.EventDataSessionStateChanged)).contents
                    with suppress(ValueError):  # a state of an extension
                        entered.append(HeadsetState(xr.SessionState(changed.state).name.lower()))
                elif event.type == xr.StructureType.EVENT_DATA_INSTANCE_LOSS_PENDING:
                    entered.append(HeadsetState.LOSS_PENDING)
        self._state = entered[-1] if entered else self._state
        return entered

    def begin_session(self) -> None:
        xr = self._xr
        with self._calling():
            kind = xr.ViewConfigurationType.PRIMARY_STEREO
            xr.begin_session(self._session, xr.SessionBeginInfo(primary_view_configuration_type=kind))

    def end_session(self) -> None:
        """End the session; a running one is asked to stop first, since only the runtime may stop it."""
        xr = self._xr
        with self._calling():
            if self._state is not HeadsetState.STOPPING:
                xr.request_exit_session(self._session)
                self._wait_for_stop()
            if self._state is HeadsetState.STOPPING:
                xr.end_session(self._session)

    def _wait_for_stop(self) -> None:
        limit_ns = self._clock.now_ns() + _STOP_TIMEOUT_NS
        while self._clock.now_ns() < limit_ns:
            if HeadsetState.STOPPING in self.states():
                self._state = HeadsetState.STOPPING
                return
            self.wait_frame(0)  # a runtime may stop between frames only
            self.begin_frame()
            self.end_frame(0, [], None)

    def rebuild(self) -> None:
        self.close()
        self._open()

    def wait_frame(self, now_ns: int) -> FrameTiming:
        # By ctypes: other threads run on while this one waits.
        called_ns = self._clock.now_ns()
        with self._calling():
            frame = self._xr.wait_frame(self._session, self._xr.FrameWaitInfo())
        self._display = int(frame.predicted_display_time)
        self._display_ns = now_ns + self._display - self._epoch_ns - called_ns
        return FrameTiming(self._display_ns, int(frame.predicted_display_period), bool(frame.should_render))

    def begin_frame(self) -> None:
        with self._calling():
            self._xr.begin_frame(self._session, self._xr.FrameBeginInfo())
            self._hands.sync()

    def locate(self, display_ns: int) -> list[EyeLocation]:
        """Return the eyes at a time; their last poses while the headset is not tracked."""
        if self._display:
            xr = self._xr
            with self._calling():
                state, views = xr.locate_views(
                    self._session,
                    xr.ViewLocateInfo(
                        view_configuration_type=xr.ViewConfigurationType.PRIMARY_STEREO,
                        display_time=self._display,
                        space=self._space,
                    ),
                )
            if int(state.view_state_flags) & _VALID == _VALID:
                self._views = views
                self._located = [_location(view) for view in views]
        return self._located

    def end_frame(self, display_ns: int, eyes: list[EyeLocation], frame: DisplayFrame | None) -> None:
        xr = self._xr
        with self._calling():
            layers = [] if frame is None or self._views is None else [byref(self._project(frame))]
            xr.end_frame(
                self._session,
                xr.FrameEndInfo(display_time=self._display, environment_blend_mode=self._blend, layers=layers),
            )

    def tracked(self) -> list[TrackerSample]:
        if not self._display:
            return []
        with self._calling():
            found = self._hands.poses(self._space, self._display)
            head = self._hands.place(self._head, self._space, self._display)
        poses = ({} if head is None else {"head": head}) | found
        return [sample_of(sensor, self._display_ns, pose) for sensor, pose in poses.items()]

    def take_pressed(self) -> list[str]:
        return self._hands.take_pressed()

    def close(self) -> None:
        self._owned.close()
        self._own_context.take_back()

    @contextmanager
    def _calling(self) -> Iterator[None]:
        """Surround calls of the runtime: raise its errors as RuntimeLostError, and restore the context."""
        try:
            yield
        except self._xr.exception.XrException as error:
            raise RuntimeLostError(f"OpenXR: {_words(error)}", "start the headset's runtime") from None
        finally:
            self._own_context.take_back()

    def _owns(self, destroy: Callable[[Any], object], handle: Any) -> Any:
        """Register a handle to be freed on close, and return it."""

        def free() -> None:
            with suppress(self._xr.exception.XrException):  # a lost runtime can free nothing
                destroy(handle)

        self._owned.callback(free)
        return handle

    def _open(self) -> None:
        """Open instance, session and swapchain.

        Raises:
            DeviceError: not available; nothing is left open.
        """
        self._own_context = OwnContext(self._backend)
        self._state, self._display, self._views = HeadsetState.IDLE, 0, None
        with ExitStack() as self._owned:
            with self._calling():
                self._make()
            self._owned = self._owned.pop_all()

    def _make(self) -> None:
        xr = self._xr
        wanted = [xr.KHR_OPENGL_ENABLE_EXTENSION_NAME, _TIME_EXTENSION]
        wanted += [EGL_EXTENSION] if self._backend == "egl" else []
        offered = {each.extension_name.decode() for each in xr.enumerate_instance_extension_properties()}
        missing = [name for name in wanted if name not in offered]
        if missing:
            raise DeviceError(f"the OpenXR runtime has no {' and no '.join(missing)}", "use another runtime")
        application = xr.ApplicationInfo(application_name=f"mimics {__version__}", api_version=xr.Version(1, 0, 0))
        info = xr.InstanceCreateInfo(application_info=application, enabled_extension_names=wanted)
        self._instance = self._owns(xr.destroy_instance, xr.create_instance(info))
        system = xr.get_system(self._instance, xr.SystemGetInfo(form_factor=xr.FormFactor.HEAD_MOUNTED_DISPLAY))
        self._query_requirements(system)
        binding = graphics_binding(xr, self._backend)
        create = xr.SessionCreateInfo(system_id=system, next=cast(pointer(binding), c_void_p))
        self._session = self._owns(xr.destroy_session, xr.create_session(self._instance, create))
        self._own_context.take_back()
        self._space, self._head = (self._make_space(kind) for kind in ("LOCAL", "VIEW"))
        self._blend = xr.enumerate_environment_blend_modes(
            self._instance, system, xr.ViewConfigurationType.PRIMARY_STEREO
        )[0]
        self._hands = OpenXrHands(xr, self._instance, self._session, self._owns)
        self._make_swapchain(system)
        self._epoch_ns = self._time_offset()

    def _make_space(self, kind: str) -> Any:
        xr = self._xr
        info = xr.ReferenceSpaceCreateInfo(reference_space_type=xr.ReferenceSpaceType[kind])
        return self._owns(xr.destroy_space, xr.create_reference_space(self._session, info))

    def _query_requirements(self, system: int) -> None:
        """Query the requirements of OpenGL, as OpenXR demands before a session is created."""
        xr, needs = self._xr, self._xr.GraphicsRequirementsOpenGLKHR()
        address = xr.get_instance_proc_addr(self._instance, "xrGetOpenGLGraphicsRequirementsKHR")
        cast(address, xr.PFN_xrGetOpenGLGraphicsRequirementsKHR)(self._instance, system, byref(needs))

    def _make_swapchain(self, system: int) -> None:
        """Create one swapchain for both eyes side by side."""
        xr = self._xr
        views = xr.enumerate_view_configuration_views(self._instance, system, xr.ViewConfigurationType.PRIMARY_STEREO)
        limits = xr.get_system_properties(self._instance, system).graphics_properties
        wanted = [
            max(view.recommended_image_rect_width for view in views),
            max(view.recommended_image_rect_height for view in views),
        ]
        share = min(
            1.0, limits.max_swapchain_image_width / (2 * wanted[0]), limits.max_swapchain_image_height / wanted[1]
        )
        self._size = int(share * wanted[0]), int(share * wanted[1])
        if _SRGB8_ALPHA8 not in list(xr.enumerate_swapchain_formats(self._session)):
            raise DeviceError("the headset does not support 8-bit sRGB images", "update its runtime")
        flags = xr.SwapchainUsageFlags
        chain = xr.create_swapchain(
            self._session,
            xr.SwapchainCreateInfo(
                usage_flags=flags.COLOR_ATTACHMENT_BIT | flags.SAMPLED_BIT | flags.TRANSFER_DST_BIT,
                format=_SRGB8_ALPHA8,
                sample_count=1,
                width=2 * self._size[0],
                height=self._size[1],
                face_count=1,
                array_size=1,
                mip_count=1,
            ),
        )
        self._swapchain = self._owns(xr.destroy_swapchain, chain)
        images = xr.enumerate_swapchain_images(self._swapchain, xr.SwapchainImageOpenGLKHR)
        self._images = [image.image for image in images]

    def _time_offset(self) -> int:
        """Return OpenXR's time minus the monotonic clock's [ns]; both have the same rate."""
        xr = self._xr
        address = xr.get_instance_proc_addr(self._instance, "xrConvertTimespecTimeToTimeKHR")
        moment, converted = _Timespec(), ctypes.c_int64()
        now_ns = self._clock.now_ns()
        moment.seconds, moment.nanoseconds = divmod(now_ns, _NS)
        convert = ctypes.CFUNCTYPE(ctypes.c_int, c_void_p, POINTER(_Timespec), POINTER(ctypes.c_int64))
        if cast(address, convert)(cast(self._instance, c_void_p), byref(moment), byref(converted)) != 0:
            raise DeviceError("OpenXR cannot convert its time", "update the headset's runtime")
        return int(converted.value) - now_ns

    def _project(self, frame: DisplayFrame) -> Any:
        """Copy the picture into the swapchain and return a layer with the poses it was drawn from."""
        xr = self._xr
        index = xr.acquire_swapchain_image(self._swapchain, xr.SwapchainImageAcquireInfo())
        xr.wait_swapchain_image(self._swapchain, xr.SwapchainImageWaitInfo(timeout=xr.INFINITE_DURATION))
        self._own_context.take_back()
        self._own_context.copy_image(frame.texture, self._images[index], frame.size)
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


def _words(error: Exception) -> str:
    """Return the message of an error of pyopenxr in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def _location(view: xr.View) -> EyeLocation:
    place, turn, fov = view.pose.position, view.pose.orientation, view.fov
    pose = pose_from_parts((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
    tangents = (fov.angle_left, fov.angle_right, fov.angle_down, fov.angle_up)
    left, right, bottom, top = (math.tan(angle) for angle in tangents)
    return EyeLocation(pose, (left, right, bottom, top))
