"""Fence among the commands of a context, which can be waited for without those after it."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

from mimics_app.rendering.visual.surfaces.raw_gl import function_address

if TYPE_CHECKING:
    import moderngl

__all__ = ["Fence"]

_COMMANDS_COMPLETE, _FLUSH = 0x9117, 0x0001
_FOREVER = (1 << 64) - 1

_UINT, _SYNC = ctypes.c_uint, ctypes.c_void_p


class Fence:
    """A fence that is set again and again.

    Args:
        ctx: The context.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        create, delete, wait = (
            function_address(ctx, name) for name in ("glFenceSync", "glDeleteSync", "glClientWaitSync")
        )
        self._create = ctypes.CFUNCTYPE(_SYNC, _UINT, _UINT)(create)
        self._delete = ctypes.CFUNCTYPE(None, _SYNC)(delete)
        self._wait = ctypes.CFUNCTYPE(_UINT, _SYNC, _UINT, ctypes.c_uint64)(wait)
        self._sync: int | None = None

    def set(self) -> None:
        """Set it after the commands so far."""
        self.release()
        self._sync = self._create(_COMMANDS_COMPLETE, 0)

    def wait(self) -> None:
        """Wait until the driver has executed the commands before it; return at once where it was never set."""
        if self._sync is not None:
            self._wait(self._sync, _FLUSH, _FOREVER)

    def release(self) -> None:
        """Delete it."""
        if self._sync is not None:
            self._delete(self._sync)
            self._sync = None
