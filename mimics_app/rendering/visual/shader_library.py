"""GLSL programs from the shaders folder: includes, variants, and reload while the application runs."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import resources
from mimics_app.contracts.errors import Issue, SceneError

if TYPE_CHECKING:
    import moderngl

__all__ = ["ShaderLibrary", "ShaderProgram"]

_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
_DRIVER_LINES = (
    re.compile(r"^(\d+):(\d+)\((\d+)\): (error|warning): (.*)$"),  # Mesa
    re.compile(r"^(?:ERROR: )?(\d+):(\d+): ()(error: |)(.*)$"),  # Apple, ANGLE
    re.compile(r"^(\d+)\((\d+)\) : ()(error|warning) (.*)$"),  # NVIDIA
)
_HEADER = "#version 430 core\n"


@dataclass(eq=False)
class ShaderProgram:
    """A compiled program that a reload may replace.

    Attributes:
        program: The newest program that compiled.
        revision: Counts replacements; vertex arrays made for an older revision are to be made anew.
        files: Every file read for it.
    """

    vertex: str
    fragment: str
    defines: tuple[str, ...]
    program: moderngl.Program
    revision: int = 0
    files: dict[Path, int] = field(default_factory=dict)

    def set_matrix(self, name: str, matrix: NDArray[np.float64]) -> None:
        """Give a mat4 uniform its value (column vectors, float64 [4, 4]); uploaded as float32."""
        uniform: Any = self.program[name]
        uniform.write(np.ascontiguousarray(matrix.T, np.float32))

    def set_number(self, name: str, value: float) -> None:
        """Give a float uniform its value."""
        uniform: Any = self.program[name]
        uniform.value = value


class ShaderLibrary:
    """Compiles programs on first use and keeps them.

    Shaders have no `#version` line of their own. `#include "common/sky.glsl"` takes paths from the shaders folder,
    each file at most once per shader. Errors name the file and the line a person edits, not the assembled text.
    """

    def __init__(self, ctx: moderngl.Context, folder: Path | None = None) -> None:
        self._ctx = ctx
        self.folder = folder or resources.root() / "shaders"
        self._programs: dict[tuple[str, str, tuple[str, ...]], ShaderProgram] = {}

    def program(self, vertex: str, fragment: str, defines: tuple[str, ...] = ()) -> ShaderProgram:
        """The program of two shader files.

        Args:
            vertex: Path below the shaders folder, e.g. "lit/lit.vert".
            fragment: The same for the fragment shader.
            defines: Names that are `#define`d, e.g. ("TEXTURED",).

        Raises:
            SceneError: a file is missing or does not compile.
        """
        key = (vertex, fragment, defines)
        if key not in self._programs:
            program, files = self._compile(*key)
            self._programs[key] = ShaderProgram(*key, program, files=files)
        return self._programs[key]

    def reload(self) -> list[Issue]:
        """Compile anew what changed on disk; a program that does not compile keeps its old form.

        Returns:
            The faults found, each with the file and the line as its pointer; [] when all is well.
        """
        issues: list[Issue] = []
        for key, shader in self._programs.items():
            if all(_stamp(path) == stamp for path, stamp in shader.files.items()):
                continue
            shader.files = {path: _stamp(path) for path in shader.files}
            try:
                program, shader.files = self._compile(*key)
            except SceneError as error:
                issues += error.issues
                continue
            # Vertex arrays still hold the old program; the driver frees it with the last of them.
            shader.program = program
            shader.revision += 1
        return issues

    def _compile(
        self, vertex: str, fragment: str, defines: tuple[str, ...]
    ) -> tuple[moderngl.Program, dict[Path, int]]:
        import moderngl

        sources = [_Source(self.folder, name, defines) for name in (vertex, fragment)]
        try:
            program = self._ctx.program(vertex_shader=sources[0].text, fragment_shader=sources[1].text)
        except moderngl.Error as error:
            raise SceneError(_read_driver_log(str(error), sources)) from error
        _ = self._ctx.error
        return program, {path: _stamp(path) for source in sources for path in source.files}


class _Source:
    """One shader's text with its includes pasted in and marked by `#line`."""

    def __init__(self, folder: Path, name: str, defines: tuple[str, ...]) -> None:
        self.folder = folder
        self.files: list[Path] = []
        self.text = _HEADER + "".join(f"#define {define} 1\n" for define in defines) + self._paste(name, name)

    def _paste(self, name: str, asked_by: str) -> str:
        path = self.folder / name
        if path in self.files:
            return ""
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except OSError as error:
            raise SceneError(Issue(str(path), "", f"cannot be read for {asked_by}: {error.strerror}")) from error
        number = len(self.files)
        self.files.append(path)
        out = [f"#line 1 {number}"]
        for index, line in enumerate(lines, start=1):
            match = _INCLUDE.match(line)
            out += [self._paste(match[1], name), f"#line {index + 1} {number}"] if match else [line]
        return "\n".join(out) + "\n"


def _stamp(path: Path) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _read_driver_log(log: str, sources: list[_Source]) -> list[Issue]:
    stage = sources[1] if "fragment_shader" in log else sources[0]
    issues = [issue for line in log.splitlines() if (issue := _read_driver_line(line.strip(), stage))]
    return issues or [Issue(str(stage.files[0]), "", "does not link: " + " ".join(log.split()))]


def _read_driver_line(line: str, source: _Source) -> Issue | None:
    for pattern in _DRIVER_LINES:
        match = pattern.match(line)
        if match and match[4].strip(": ") != "warning" and int(match[1]) < len(source.files):
            return Issue(str(source.files[int(match[1])]), f"line {match[2]}", match[5])
    return None
