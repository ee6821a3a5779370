"""Whether a driver has lost a context, with everything in it: after a hang, an update, or a card that was pulled."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import moderngl

__all__ = ["ResetStatus"]

_NAMES = ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB")
"""Of one function: OpenGL 4.5, KHR_robustness, ARB_robustness."""

_WORDS = {
    0x8253: "this program made the driver hang",
    0x8254: "another program made the driver hang",
    0x8255: "the driver was reset",
}


class ResetStatus:
    """Asks a context; a driver that cannot be asked is taken to be well."""

    def __init__(self, ctx: moderngl.Context) -> None:
        loader: Any = ctx.mglo._context  # what moderngl loads its own functions with
        address = next((found for name in _NAMES if (found := loader.load_opengl_function(name))), 0)
        self._ask = ctypes.CFUNCTYPE(ctypes.c_uint)(address) if address else None

    def __call__(self) -> str:
        """What happened to the context, in words; "" while it is well."""
        if self._ask is None:
            return ""
        status = self._ask()
        return _WORDS.get(status, f"the driver says 0x{status:x}") if status else ""
