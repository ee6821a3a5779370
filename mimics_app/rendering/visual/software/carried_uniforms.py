"""Uniforms that vertices carry to the pixels, as flat outputs.

llvmpipe loads every component of a uniform for each pixel on its own and checks its bounds, one of a constant address
too: more than half of the instructions of a lit surface. A flat output costs as much as a constant.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

from mimics_app.rendering.visual.materials.shader_source import PixelInputs, ShaderLine, ShaderSource

__all__ = ["CarriedUniforms", "carry_uniforms"]

_BLOCK = re.compile(r"layout\(std140, binding = \d+\) uniform (\w+) \{")
_BLOCK_END = "};"
_MEMBER = re.compile(r"\s*(uniform )?(float|vec[234]) (\w+)(\[[1-4]\])?;")
"""Long arrays are left out: outputs are limited to 32 vectors."""


@dataclass(frozen=True)
class _Carried:
    """A uniform: its type, name and dimension, and the index of the line from which on it is known.

    Attributes:
        alone: True for one outside of a block.
    """

    kind: str
    name: str
    dimension: str
    index: int
    alone: bool

    def declare(self, how: str) -> str:
        """Return its declaration as `in` or `out`."""
        return f"flat {how} {self.kind} carried_{self.name}{self.dimension};"


class CarriedUniforms(PixelInputs):
    """Carries the uniforms that `carry_uniforms` finds."""

    def rewrite(self, vertex: ShaderSource, fragment: ShaderSource) -> bool:
        return carry_uniforms(vertex, fragment)


def carry_uniforms(vertex: ShaderSource, fragment: ShaderSource) -> bool:
    """Let a fragment shader read the uniforms of both shaders' blocks, and those of its own, from flat inputs.

    Args:
        vertex: Shader of the vertices, which is extended.
        fragment: Shader of the pixels; names of uniforms become those of inputs.

    Returns:
        Whether there are any.
    """
    carried = _find_carried(fragment, {match[1] for line in vertex.lines if (match := _BLOCK.match(line.text))})
    if not carried:
        return False
    for each in reversed(carried):
        place = fragment.lines[each.index].place
        added = (each.declare("in"), f"#define {each.name} carried_{each.name}")
        fragment.lines[each.index + 1 : each.index + 1] = [ShaderLine(text, place) for text in added]
    first, last = vertex.lines[0].place, vertex.lines[-1].place
    known = {match[3] for line in vertex.lines if (match := _MEMBER.match(line.text)) and match[1]}
    missing = [f"uniform {each.kind} {each.name};" for each in carried if each.alone and each.name not in known]
    sent = [f"    carried_{each.name} = {each.name};" for each in carried]
    outputs = [each.declare("out") for each in carried]
    ending = [*missing, *outputs, "#undef main", "void main() {", "    place_vertex();", *sent, "}"]
    # The extension of a shader has to stand before everything else that is compiled; a define need not.
    vertex.lines.insert(1, ShaderLine("#define main place_vertex", first))
    vertex.lines += [ShaderLine(text, last) for text in ending]
    return True


def _find_carried(fragment: ShaderSource, shared: set[str]) -> list[_Carried]:
    """Return the uniforms that a fragment shader reads, in order: those of shared blocks, and those in none."""
    words = Counter(word for line in fragment.lines for word in re.findall(r"\w+", line.text.partition("//")[0]))
    found: list[_Carried] = []
    block, members = "", list[re.Match[str]]()
    for index, line in enumerate(fragment.lines):
        if opened := _BLOCK.match(line.text):
            block, members = opened[1], []
        elif line.text == _BLOCK_END and block:
            read = [each for each in members if block in shared and words[each[3]] > 1]
            found += [_Carried(each[2], each[3], each[4] or "", index, alone=False) for each in read]
            block = ""
        elif member := _MEMBER.match(line.text):
            if block:
                members.append(member)
            elif member[1] and words[member[3]] > 1:
                found.append(_Carried(member[2], member[3], member[4] or "", index, alone=True))
    return found
