"""Vertex arrays by program."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, TypeVarTuple

from mimics_app.rendering.visual.materials.shader_library import ShaderProgram

if TYPE_CHECKING:
    import moderngl

__all__ = ["VertexArrays", "bare_arrays"]

_Variant = TypeVarTuple("_Variant")


class VertexArrays(Generic[*_Variant]):
    """Vertex arrays by program and variant, made on first use and again after a reload of the program.

    Args:
        make: Makes the vertex array of a program, in a variant.
    """

    def __init__(self, make: Callable[[ShaderProgram, *_Variant], moderngl.VertexArray]) -> None:
        self._make = make
        self._made: dict[tuple[ShaderProgram, *_Variant], tuple[int, moderngl.VertexArray]] = {}

    def of(self, shader: ShaderProgram, *variant: *_Variant) -> moderngl.VertexArray:
        """Return the vertex array of a program."""
        known = self._made.get((shader, *variant))
        if known is not None and known[0] == shader.revision:
            return known[1]
        if known is not None:
            known[1].release()
        array = self._make(shader, *variant)
        self._made[shader, *variant] = shader.revision, array
        return array

    def release(self) -> None:
        """Free all of them; the next use makes them again, of the buffers of that time."""
        for _, array in self._made.values():
            array.release()
        self._made.clear()


def bare_arrays(ctx: moderngl.Context) -> VertexArrays[()]:
    """Return the vertex arrays of programs without attributes, whose vertices have nothing but a number."""
    return VertexArrays(lambda shader: ctx.vertex_array(shader.program, []))
