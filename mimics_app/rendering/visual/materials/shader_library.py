"""GLSL programs from the shaders folder: includes, variants, and reload while the application runs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from mimics_app.contracts.arrays import F4, F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system import resources
from mimics_app.rendering.visual.materials.shader_source import (
    PixelInputs,
    ShaderFile,
    ShaderSource,
    read_shader_file,
    stamp_of,
)
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of

if TYPE_CHECKING:
    import moderngl

__all__ = ["FEW_PIXELS", "ShaderLibrary", "ShaderProgram"]

FEW_PIXELS = "FEW_PIXELS"
"""Define of a program with few pixels per vertex: its shaders are not rewritten, see `PixelInputs`."""


_DRIVER_LINES = (
    re.compile(r"^\d+:(\d+)\(\d+\): (error|warning): (.*)$"),  # Mesa
    re.compile(r"^(?:ERROR: )?\d+:(\d+): ()(.*)$"),  # Apple, ANGLE
    re.compile(r"^\d+\((\d+)\) : (error|warning) (.*)$"),  # NVIDIA
)


_Key = tuple[str, str, tuple[str, ...], tuple[str, ...]]
"""Vertex shader, fragment shader or "", defines, varyings of transform feedback."""


@dataclass(eq=False)
class ShaderProgram:
    """A compiled program that a reload may replace; a uniform is sent where its value changes.

    Attributes:
        varyings: Outputs captured by transform feedback; () for a program that draws.
        program: The newest program that compiled.
        revision: Number of replacements; vertex arrays made for an older revision are invalid.
        files: Every file read for it.
    """

    vertex: str
    fragment: str
    defines: tuple[str, ...]
    varyings: tuple[str, ...]
    program: moderngl.Program
    revision: int = 0
    files: dict[Path, int] = field(default_factory=dict)
    _sent: dict[str, object] = field(default_factory=dict)

    def replace(self, program: moderngl.Program) -> None:
        """Use another program from now on, whose uniforms are zero."""
        self.program = program
        self.revision += 1
        self._sent.clear()

    def set_matrix(self, name: str, matrix: F8) -> None:
        """Set a mat4 uniform (for column vectors, float64 [4, 4]); uploaded as float32."""
        self.set_array(name, matrix.T)

    def set_number(self, name: str, value: float) -> None:
        """Set a scalar uniform."""
        self._set_value(name, value)

    def set_array(self, name: str, values: F4 | F8) -> None:
        """Set a uniform array, uploaded as float32."""
        written = values.astype(np.float32).tobytes()
        if self._sent.get(name) != written:
            cast("moderngl.Uniform", self.program[name]).write(written)
            self._sent[name] = written

    def set_numbers(self, name: str, values: Sequence[float]) -> None:
        """Set a vector uniform."""
        self._set_value(name, tuple(values))

    def _set_value(self, name: str, value: float | tuple[float, ...]) -> None:
        if self._sent.get(name) != value:
            cast("moderngl.Uniform", self.program[name]).value = value
            self._sent[name] = value


class ShaderLibrary:
    """Compiles programs on first use and keeps them.

    Shaders have no `#version` line of their own. `#include "common/sky.glsl"` is relative to the shaders folder; each
    file is included at most once per shader. Errors give the line of the source file, not of the assembled text.

    Attributes:
        folder: The shaders folder.
        replaced: Programs that reloads have replaced so far.
    """

    def __init__(self, ctx: moderngl.Context, folder: Path | None = None) -> None:
        self._ctx = ctx
        self._inputs = rasteriser_of(ctx).member(PixelInputs)()
        self.folder = folder or resources.root() / "shaders"
        self._programs: dict[_Key, ShaderProgram] = {}
        self._files: dict[str, ShaderFile] = {}
        self.replaced = 0
        self._variants: dict[tuple[ShaderProgram, tuple[str, ...]], ShaderProgram] = {}

    def program(self, vertex: str, fragment: str, defines: tuple[str, ...] = ()) -> ShaderProgram:
        """Return the program of two shader files.

        Args:
            vertex: Path below the shaders folder, e.g. "common/mesh.vert".
            fragment: Path of the fragment shader.
            defines: Names to `#define`, e.g. ("TEXTURED",), as 1 unless "NAME=VALUE".

        Raises:
            SceneError: a file is missing or does not compile.
        """
        return self._find((vertex, fragment, defines, ()))

    def also_with(self, shader: ShaderProgram, defines: tuple[str, ...]) -> ShaderProgram:
        """Return the variant of a program with further defines; the program itself where there are none."""
        if not defines:
            return shader
        known = self._variants.get((shader, defines))  # called for every run of every frame
        if known is None:
            known = self.program(shader.vertex, shader.fragment, (*shader.defines, *defines))
            self._variants[shader, defines] = known
        return known

    def feedback(self, vertex: str, varyings: tuple[str, ...], defines: tuple[str, ...] = ()) -> ShaderProgram:
        """Return the program of a vertex shader alone, for transform feedback.

        Args:
            vertex: Path below the shaders folder.
            varyings: Outputs in the order of the buffer.
            defines: Names to `#define`.

        Raises:
            SceneError: a file is missing or does not compile.
        """
        return self._find((vertex, "", defines, varyings))

    def _find(self, key: _Key) -> ShaderProgram:
        if key not in self._programs:
            program, files = self._compile(*key)
            self._programs[key] = ShaderProgram(*key, program, files=files)
        return self._programs[key]

    def reload(self) -> list[Issue]:
        """Recompile the programs whose files changed; one that fails to compile stays in use as it was.

        Returns:
            The errors, each with the file and the line as its pointer; [] without errors.
        """
        issues: list[Issue] = []
        self._files.clear()
        for key, shader in self._programs.items():
            if all(stamp_of(path) == stamp for path, stamp in shader.files.items()):
                continue
            shader.files = {path: stamp_of(path) for path in shader.files}
            try:
                program, shader.files = self._compile(*key)
            except SceneError as error:
                issues += error.issues
                continue
            # Vertex arrays still reference the old program; the driver frees it with the last of them.
            shader.replace(program)
            self.replaced += 1
        return issues

    def _compile(
        self, vertex: str, fragment: str, defines: tuple[str, ...], varyings: tuple[str, ...]
    ) -> tuple[moderngl.Program, dict[Path, int]]:
        sources = self._assemble(vertex, fragment, defines)
        if fragment and FEW_PIXELS not in defines and self._inputs.rewrite(*sources):
            # Not every valid pair of shaders can be rewritten, and messages are to be about what is in the files.
            with suppress(SceneError):
                return self._link(sources, varyings)
            sources = self._assemble(vertex, fragment, defines)
        return self._link(sources, varyings)

    def _assemble(self, vertex: str, fragment: str, defines: tuple[str, ...]) -> list[ShaderSource]:
        return [ShaderSource(self._read, name, defines) for name in (vertex, fragment) if name]

    def _link(self, sources: list[ShaderSource], varyings: tuple[str, ...]) -> tuple[moderngl.Program, dict[Path, int]]:
        import moderngl

        vertex, *pixels = (source.text for source in sources)
        try:
            program = self._ctx.program(
                vertex_shader=vertex, fragment_shader=pixels[0] if pixels else None, varyings=varyings
            )
        except moderngl.Error as error:
            raise SceneError(_read_driver_log(str(error), sources)) from error
        _ = self._ctx.error
        return program, {file.path: file.stamp for source in sources for file in source.files.values()}

    def _read(self, name: str, included_by: str) -> ShaderFile:
        """Return a file below the shaders folder, read once until the next reload: programs share most of theirs."""
        if name not in self._files:
            self._files[name] = read_shader_file(self.folder / name, included_by)
        return self._files[name]


def _read_driver_log(log: str, sources: list[ShaderSource]) -> list[Issue]:
    stage = sources[1] if "fragment_shader" in log else sources[0]
    issues = [issue for line in log.splitlines() if (issue := _read_driver_line(line.strip(), stage))]
    return issues or [Issue(str(stage.place(1)[0]), "", "does not link: " + " ".join(log.split()))]


def _read_driver_line(line: str, source: ShaderSource) -> Issue | None:
    for pattern in _DRIVER_LINES:
        match = pattern.match(line)
        if match and match[2].strip(": ") != "warning":
            path, number = source.place(int(match[1]))
            return Issue(str(path), f"line {number}", match[3])
    return None
