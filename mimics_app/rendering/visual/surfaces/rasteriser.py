"""The seam to drivers that draw on the processor: they take other members of some classes than a graphics card.

The room `rendering.visual.software` is imported for such a driver only, and by this module alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib import import_module
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import moderngl

__all__ = ["Rasteriser", "leave_out", "rasteriser_of", "without_software"]

_SOFTWARE = ("llvmpipe", "softpipe", "SwiftShader")
"""Names of renderers that draw on the processor."""

_ROOM = "mimics_app.rendering.visual.software.software_rasteriser"

_Part = TypeVar("_Part")
_off: ContextVar[bool] = ContextVar("off", default=False)


class Rasteriser:
    """Fills the pixels; this class itself is a graphics card, for which the classes of the renderer are as they are.

    Attributes:
        defers: Whether all drawing is put off until the driver is waited for or the picture is shown.
        pays_for_pixels: Whether the time of a frame grows with its pixels, beside which everything else is small.
    """

    defers = False
    pays_for_pixels = False

    def member(self, part: type[_Part]) -> type[_Part]:
        """Return the class to use for a class of the renderer: itself, or a subclass that suits the driver better."""
        return part

    @property
    def parts(self) -> tuple[type, ...]:
        """The classes of the renderer that have another member here."""
        return ()

    def without(self, *parts: type) -> Rasteriser:
        """Return a rasteriser for which some of `parts` are their own members, to measure what they are worth."""
        return self


def rasteriser_of(ctx: moderngl.Context) -> Rasteriser:
    """Return the rasteriser of a context, the same one for its life."""
    if not isinstance(ctx.extra, Rasteriser):
        drawn = not _off.get() and any(name in str(ctx.info["GL_RENDERER"]) for name in _SOFTWARE)
        ctx.extra = import_module(_ROOM).SoftwareRasteriser() if drawn else Rasteriser()
    return ctx.extra


def leave_out(ctx: moderngl.Context, *parts: type) -> None:
    """Let some of the rasteriser's `parts` be their own members in a context, in all that is created there later."""
    ctx.extra = rasteriser_of(ctx).without(*parts)


@contextmanager
def without_software() -> Iterator[None]:
    """Take every driver for a graphics card in contexts that are created meanwhile."""
    before = _off.set(True)
    try:
        yield
    finally:
        _off.reset(before)
