"""Sprites of a frame: billboards and particles, sorted into runs together with the blended surfaces."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from mimics_app.contracts.arrays import B1, F8, I4
from mimics_app.contracts.errors import Issue
from mimics_app.contracts.system.language import translated
from mimics_app.rendering.visual.drawing.frame_buffers import DrawRun
from mimics_app.rendering.visual.effects.captions import caption_key, caption_picture
from mimics_app.rendering.visual.effects.emitters import Emitter, SpriteRows
from mimics_app.rendering.visual.effects.far_sprites import FarSprites
from mimics_app.rendering.visual.kernels.particles import SPRITE
from mimics_app.rendering.visual.kernels.sprites import (
    LEVEL,
    MAX_PIECES,
    MIN_OUTLINED,
    SPRITE_VERTEX,
    Picked,
    SortScratch,
    cut_order,
    cut_sprites,
    pick_sprites,
    write_sprites,
)
from mimics_app.rendering.visual.materials.picture_arrays import PictureArray, PictureArrays
from mimics_app.rendering.visual.view import View
from mimics_app.world.components.effects import Billboard, Particles, SpriteShape
from mimics_app.world.content.materials.material import TextureData
from mimics_app.world.content.materials.sprite_pictures import sprite_picture
from mimics_app.world.content.world import World
from mimics_app.world.graph.entity_ids import grown

__all__ = ["SpriteField", "SpriteRun", "SpriteState", "outline_of"]


_FACINGS = ("free", "upright")
"""Facings in the order of their numbers in kernels/sprites.py."""
_DOT = "#dot"
"""Name of the texture for which the shader has a formula."""


_MARGIN = 1.0 / 32.0
"""Margin around the shape, as a share of the texture. Texels of the mipmaps of a sprite of `MIN_OUTLINED` pixels or
more mix in transparent ones of twice 1/128 around it."""

_WORTH = 0.9
"""Share of the texture within the outline from which all of it is drawn."""


@dataclass(frozen=True)
class SpriteState:
    """Render state of sprites: texture array and shader variant.

    Attributes:
        pictures: Texture array; each sprite selects a layer.
        masked: True for alpha test instead of blending.
        lit: True for sprites lit by sun, lights and sky.
        flat: True for lit sprites without roundness: their light may be computed at their vertices.
        dots: True where all of them show the dot, for which the shader has a formula.
    """

    pictures: PictureArray
    masked: bool
    lit: bool
    flat: bool = False
    dots: bool = False


@dataclass(frozen=True, slots=True)
class SpriteRun:
    """Sprites of one draw call: their state, the number of their first piece, and how many pieces they have."""

    state: SpriteState
    first: int
    count: int

    @property
    def triangles(self) -> int:
        """Triangles of the run, two per piece."""
        return 2 * self.count


def _whole_outline() -> F8:
    """Return the outline of a texture that is drawn as one piece."""
    return np.tile([-1.0, 1.0], (MAX_PIECES + 1, 1))


def outline_of(picture: TextureData) -> F8 | None:
    """Return left and right of everything visible at equal heights from bottom to top, each -1 to 1.

    Straight lines between them stay outside of the shape.

    Args:
        picture: The texture.

    Returns:
        float64 [MAX_PIECES + 1, 2]; None where cutting saves little, or the texture repeats across its border.
    """
    if picture.pixels.shape[2] < 4 or tuple(picture.wrap) != ("clamp", "clamp"):
        return None
    visible = picture.pixels[::-1, :, 3] > 0
    height, width = visible.shape
    # Per piece: the outermost visible columns, as shares of the width.
    bounds = np.tile([1.0, 0.0], (MAX_PIECES, 1))
    for piece in range(MAX_PIECES):
        low, high = (piece / MAX_PIECES - _MARGIN) * height, ((piece + 1) / MAX_PIECES + _MARGIN) * height
        columns = np.flatnonzero(visible[max(0, int(np.floor(low))) : int(np.ceil(high))].any(axis=0))
        if len(columns):
            bounds[piece] = columns[0] / width - _MARGIN, (columns[-1] + 1) / width + _MARGIN
    padded = np.concatenate([bounds[:1], bounds, bounds[-1:]])
    left, right = np.minimum(padded[:-1, 0], padded[1:, 0]), np.maximum(padded[:-1, 1], padded[1:, 1])
    empty = left > right
    left[empty] = right[empty] = 0.5
    outline = np.clip(np.stack([left, right], axis=1), 0.0, 1.0)
    mean = np.ptp(outline, axis=1)
    return None if 0.5 * float((mean[:-1] + mean[1:]).mean()) > _WORTH else np.asarray(2.0 * outline - 1.0)


class SpriteField:
    """All sprites of a world.

    Attributes:
        vertices: Vertices of all views, SPRITE_VERTEX [>= count, 4].
        count: Pieces of sprites written to it since the last update.
        cuts: Whether large sprites are cut along their outline, which changes pixels at its edge by two levels of 255.
        behind: The SPRITE records that the last batch left out, for comparison with those of another frame.
        issues: Missing textures, each reported once; the caller removes what it reports.

    Args:
        arrays: Textures of the sprites.
        far: Counts the sprites that are behind everything that changes.
    """

    def __init__(self, arrays: PictureArrays, far: FarSprites) -> None:
        self._arrays = arrays
        self.cuts = True
        self.behind = b""
        self._far = far
        self._made_for: tuple[int, int, int] | None = None
        self._pictures: dict[str, TextureData | None] = {}
        self._states: list[SpriteState] = []
        self._shown: dict[SpriteState, set[str]] = {}
        self._cut: dict[tuple[int, int], F8 | None] = {}
        self._rows = SpriteRows()
        self._billboards, self._carried = np.zeros(0, SPRITE), b""
        self._emitters: dict[int, Emitter] = {}
        self._reported: set[Issue] = set()
        self._scratch(0)
        self._axes = np.zeros((3, 3))
        self._state_of: I4 = np.zeros(0, np.int32)
        self._changes: list[int] = []
        self._take_outlines()
        self.vertices = np.zeros((256, 4), SPRITE_VERTEX)
        self.count = 0
        self.issues: list[Issue] = []

    def update(self, world: World) -> None:
        """Update the sprites from the world, at its time."""
        effects = world.effects
        self.count = self._rows.count = 0
        wanted = (id(world), effects.revision, effects.seed)
        changed = any(world.textures.get(key) is not picture for key, picture in self._pictures.items())
        if wanted != self._made_for or changed:
            self._take_structure(world)
            self._made_for = wanted
        self._place_billboards(world)
        for index, emitter in self._emitters.items():
            row = world.transforms.row(index)
            if world.transforms.shown[row]:
                own = [burst for burst in effects.bursts if burst.emitter == index]
                emitter.fill(effects.time, world.transforms.world[row], own, self._rows)
        if len(self._order) < self._rows.count:
            self._scratch(2 * self._rows.count)

    @property
    def figures(self) -> F8:
        """All sprites as of the last update, float64 [n, m]: bounding sphere [m], then all other fields."""
        rows = self._rows.rows[: self._rows.count]
        if not len(rows):
            return np.zeros((0, 4))
        # Twice the half diagonal, which a sprite with its pivot at the bottom reaches.
        reach = 2.0 * np.linalg.norm(rows["half"], axis=1)
        every = [np.asarray(rows[name], np.float64).reshape(len(rows), -1) for name in rows.dtype.names or ()]
        return np.concatenate([rows["place"], reach[:, None], *every], axis=1)

    @property
    def lit(self) -> B1:
        """Which of these are lit, [n]."""
        of_state = np.array([state.lit for state in self._states], np.bool_)
        return of_state[self._rows.rows["state"][: self._rows.count]]

    def batch(
        self, view: View, height: int, surfaces: Sequence[DrawRun], away: F8, *, split: bool = False
    ) -> tuple[list[DrawRun | SpriteRun], list[SpriteRun] | None]:
        """Queue the sprites in a view.

        Args:
            view: The view.
            height: Height of its picture as drawn [px].
            surfaces: Blended runs of this view, one item each, far to near.
            away: Their distances [m], [surfaces].
            split: True leaves out the sprites that are behind everything that changes.

        Returns:
            Masked sprites, then blended sprites and surfaces together, far to near; and the sprites left out, None
            without `split`.
        """
        eye = np.ascontiguousarray(view.eye_world)
        solid, blended = self._pick(view, eye)
        if not (solid or blended):
            self.behind = b""
            return [*surfaces], ([] if split else None)
        self._write(view, eye, height, solid + blended)
        self._note_changes(solid + blended)
        done, picked, self.behind, behind = solid, self._order[: solid + blended], b"", list[SpriteRun]()
        if split:
            done += self._far.count(self._rows.rows[: self._rows.count], picked, solid, eye, away)
            self.behind, behind = self._rows.rows[self._order[solid:done]].tobytes(), [*self._runs(solid, done)]
        runs: list[DrawRun | SpriteRun] = [*self._runs(0, solid)]
        cuts = np.empty(len(away), np.int32)
        cut_order(self._keys, blended, away, solid, cuts)
        for surface, cut in zip(surfaces, cuts.tolist(), strict=True):
            runs += [*self._runs(done, cut), surface]
            done = cut
        return [*runs, *self._runs(done, solid + blended)], (behind if split else None)

    def _write(self, view: View, eye: F8, height: int, count: int) -> None:
        """Write the vertices of the sprites in `_order`, and the first row of each into `_places`."""
        sprites = self._rows.rows
        min_size = MIN_OUTLINED * (view.tangents[3] - view.tangents[2]) / height if self.cuts else math.inf
        end = cut_sprites(sprites, self._order, count, self.count, eye, min_size, self._outlined, self._places)
        self.vertices = grown(self.vertices, end)
        right = np.ascontiguousarray(view.world_from_eye[:3, 0])
        write_sprites(sprites, self._order, count, self._places, eye, right, self._axes, self._outlines, self.vertices)
        self.count = end

    def _pick(self, view: View, eye: F8) -> tuple[int, int]:
        """Fill `_order` with masked sprites by state, then blended ones far to near, with their `_keys`."""
        rows, planes = self._rows, view.frustum_planes
        picked = Picked(self._order, self._blended, self._away, self._keys)
        scratch = SortScratch(self._spare_keys, self._spare, self._digits)
        return pick_sprites(rows.rows, rows.count, planes, eye, self._masked, picked, scratch)

    def _note_changes(self, count: int) -> None:
        """Note the state of each sprite in `_order`, and where another state begins."""
        self._state_of = states = self._rows.rows["state"][self._order[:count]]
        self._changes = (1 + np.flatnonzero(states[1:] != states[:-1])).tolist() if len(self._states) > 1 else []

    def _runs(self, begin: int, end: int) -> Iterator[SpriteRun]:
        """Yield the runs of equal state in `_order[begin:end]`."""
        if begin >= end:
            return
        between = self._changes[bisect_right(self._changes, begin) : bisect_left(self._changes, end)]
        for start, stop in pairwise([begin, *between, end]):
            first, last = int(self._places[start]), int(self._places[stop])
            yield SpriteRun(self._states[self._state_of[start]], first, last - first)

    def _scratch(self, size: int) -> None:
        self._order, self._blended, self._spare = (np.zeros(size, np.int32) for _ in range(3))
        self._places = np.zeros(size + 1, np.int32)
        self._keys, self._spare_keys = np.zeros(size, np.uint64), np.zeros(size, np.uint64)
        self._away, self._digits = np.zeros(size), np.zeros((8, 256), np.int32)

    def _take_structure(self, world: World) -> None:
        effects, self._carried = world.effects, b""
        self._shown, self._pictures, self._cut = dict[SpriteState, set[str]](), {}, {}
        self._billboards = np.zeros(len(effects.billboards), SPRITE)
        for row, spec in zip(self._billboards, effects.billboards.values(), strict=True):
            state, layer = self._state(world, spec, spec.text)
            row["turn"], row["tint"], row["half"] = (1.0, 0.0, 0.0, 0.0), spec.colour, 0.5 * np.asarray(spec.size)
            row["style"] = (layer, spec.blend != "add", 1.0, spec.cutoff)
            row["lift"], row["facing"], row["state"] = spec.pivot == "bottom", _facing(spec), state
        self._carriers = np.array(list(effects.billboards), np.int32)
        self._emitters = {}
        for index, emitter in effects.emitters.items():
            state, layer = self._state(world, emitter)
            self._emitters[index] = Emitter(emitter, effects.seed_of(index), state, layer)
        self._states = [replace(state, dots=shown == {_DOT}) for state, shown in self._shown.items()]
        self._masked = np.array([state.masked for state in self._states], np.uint8)
        self._take_outlines()

    def _take_outlines(self) -> None:
        layers = 1 + max((layer for _, layer in self._cut), default=0)
        self._outlined = np.zeros((len(self._states), layers), np.uint8)
        self._outlines = np.tile(_whole_outline(), (len(self._states), layers, 1, 1))
        for place, outline in self._cut.items():
            if outline is not None:
                self._outlined[place], self._outlines[place] = 1, outline

    def _place_billboards(self, world: World) -> None:
        count = len(self._billboards)
        if not count:
            return
        self._rows.reserve(count)
        self._rows.count += count
        rows = world.transforms.rows(self._carriers)
        matrices, shown = world.transforms.world[rows], world.transforms.shown[rows]
        carried = matrices.tobytes() + shown.tobytes()
        if carried == self._carried:  # the first rows are those of the last frame
            self._far.rest()
            return
        self._carried, seen = carried, self._rows.rows[:count]
        seen[:] = self._billboards
        seen["place"] = matrices[:, :3, 3]
        seen["half"] *= np.linalg.norm(matrices[:, :3, :2], axis=1)
        seen["tint"][shown == 0, 3] = 0.0
        self._far.follow(seen)

    def _state(self, world: World, spec: Billboard | Particles, text: str = "") -> tuple[int, int]:
        """Return the number of a state, and the layer of the texture."""
        if text:
            shown = translated(text)
            key, picture = caption_key(shown, spec.size), caption_picture(shown, spec.size)
        else:
            key, picture = self._picture(world, spec.texture, spec.shape)
        array, layer = self._arrays.place(key, picture)
        state = SpriteState(array, spec.blend == "mask", spec.lit, spec.lit and isinstance(spec, Particles))
        self._shown.setdefault(state, set()).add(key)
        number = list(self._shown).index(state)
        if (number, layer) not in self._cut:
            self._cut[number, layer] = None if key == _DOT else outline_of(picture)
        return number, layer

    def _picture(self, world: World, texture: str | None, shape: SpriteShape) -> tuple[str, TextureData]:
        if texture is None:
            return f"#{shape}", sprite_picture(shape)
        picture = self._pictures[texture] = world.textures.get(texture)
        if picture is not None:
            return texture, picture
        issue = Issue("", "", f'sprite: no texture "{texture}"; drawn as a {shape}')
        if issue not in self._reported:
            self._reported.add(issue)
            self.issues.append(issue)
        return f"#{shape}", sprite_picture(shape)


def _facing(spec: Billboard) -> int:
    """Return the number of a billboard's facing."""
    return LEVEL if spec.text else _FACINGS.index(spec.facing)
