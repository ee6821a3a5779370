"""GLSL source of one shader: its file with the includes expanded, and where each line is from."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError

__all__ = ["PixelInputs", "ShaderFile", "ShaderLine", "ShaderSource", "read_shader_file", "stamp_of"]

_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
_VERSION = "#version 430 core"


class ShaderLine:
    """A line of a shader file: its text, file and number, and the name of the file that it includes, or ""."""

    __slots__ = ("included", "place", "text")

    def __init__(self, text: str, place: tuple[Path, int]) -> None:
        match = _INCLUDE.match(text)
        self.text, self.place, self.included = text, place, match[1] if match else ""


@dataclass(frozen=True, eq=False)
class ShaderFile:
    """A shader file: its path, modification time before it was read, and lines."""

    path: Path
    stamp: int
    lines: list[ShaderLine]


class ShaderSource:
    """A shader's source with its includes expanded, and the origin of each line.

    `#line` would not do: Mesa reports the line but not the file.

    Attributes:
        files: Every file read by name, the shader's own first.
        lines: Its lines, that of the version first.
    """

    def __init__(self, read: Callable[[str, str], ShaderFile], name: str, defines: tuple[str, ...]) -> None:
        self._read = read
        self.files: dict[str, ShaderFile] = {}
        own = read(name, name).path
        self.lines = [ShaderLine(text, (own, 1)) for text in (_VERSION, *map(_define, defines))]
        self._paste(name, name)

    @property
    def text(self) -> str:
        """Source for the driver."""
        return "\n".join([line.text for line in self.lines]) + "\n"

    def place(self, line: int) -> tuple[Path, int]:
        """Return file and line of a line of the text, counted from 1."""
        return self.lines[min(max(line, 1), len(self.lines)) - 1].place

    def _paste(self, name: str, included_by: str) -> None:
        if name in self.files:
            return
        file = self.files[name] = self._read(name, included_by)
        for line in file.lines:
            if line.included:
                self._paste(line.included, name)
            else:
                self.lines.append(line)


class PixelInputs:
    """How pixels get what is the same for all of them; on a graphics card: from uniforms, as the shaders say."""

    def rewrite(self, vertex: ShaderSource, fragment: ShaderSource) -> bool:
        """Rewrite a pair of shaders; return whether one of them changed.

        Args:
            vertex: Shader of the vertices.
            fragment: Shader of the pixels.
        """
        return False


def read_shader_file(path: Path, included_by: str) -> ShaderFile:
    """Read a shader file.

    Args:
        path: The file.
        included_by: Name of the shader that needs it, for the message.

    Raises:
        SceneError: the file cannot be read.
    """
    stamp = stamp_of(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be read for {included_by}: {error.strerror}")) from error
    return ShaderFile(path, stamp, [ShaderLine(line, (path, k)) for k, line in enumerate(lines, start=1)])


def stamp_of(path: Path) -> int:
    """Return the modification time of a file [ns]; 0 for one that is missing."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _define(feature: str) -> str:
    name, _, value = feature.partition("=")
    return f"#define {name} {value or 1}"
