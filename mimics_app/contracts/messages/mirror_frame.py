"""State of a session's scene for a mirror: what has moved since the scene was built, and what the task shows.

A frame is whole by itself: it has every row that differs from the scene as built, so that one that is lost, late or the
first makes no difference. Binary, little endian: number and length, the rows by column, then the rest as JSON.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.messages.board import Board

__all__ = ["BurstNote", "CordNote", "EffectsNote", "MirrorFrame", "SoundNote", "read_frame", "write_frame"]

_HEAD = np.dtype([("magic", "<u4"), ("rows", "<u4"), ("number", "<u8"), ("t_ns", "<i8"), ("json_bytes", "<u4")])
_MAGIC = 0x314D494D  # "MIM1"
_MOST_ROWS = 1 << 20


class SoundNote(msgspec.Struct, frozen=True):
    """A sound that began: its number in the session, time [ns] and name."""

    number: int
    t_ns: int
    name: str


class CordNote(msgspec.Struct, frozen=True):
    """What a session has made of a cord: see `world.content.cords.Cord`."""

    name: str
    ends: tuple[Vec3, Vec3]
    length: float
    radius: float
    colour: Vec3
    visible: bool
    swing: float
    ball: tuple[float, float, float, float]
    taps: list[tuple[float, float, float, float]]


class BurstNote(msgspec.Struct, frozen=True):
    """A burst of an emitter: row and pose of its node, row by row, at the time of the event; see `effects.Burst`."""

    emitter: int
    number: int
    born_s: float
    world_from_emitter: Annotated[list[float], Meta(min_length=16, max_length=16)]


class EffectsNote(msgspec.Struct, frozen=True):
    """Scene time of the effects [s], the seed of their random numbers, and the bursts that may still be visible."""

    time_s: float = 0.0
    seed: int = 0
    bursts: list[BurstNote] = []


_NO_EFFECTS = EffectsNote()


class _Rest(msgspec.Struct, frozen=True):
    state: str
    trial: int
    trials: int
    progress: float
    board: Board
    sounds: list[SoundNote]
    cords: list[CordNote] = []
    effects: EffectsNote = _NO_EFFECTS


@dataclass(frozen=True, slots=True, eq=False)
class MirrorFrame:
    """One frame.

    Attributes:
        number: Number of the session's frame.
        t_ns: Session time [ns].
        rows: Rows of the transform table that differ from the scene as built, uint32 [n].
        translations: Local translations [m], float32 [n, 3].
        rotations: Local rotations, unit xyzw, float32 [n, 4].
        scales: Local scales, float32 [n, 3].
        visible: Visibility flags, uint8 [n].
        state: State of the trial, as in `TrialState`.
        trial, trials, progress: As in `TaskView`.
        board: The person's board.
        sounds: The newest sounds that began, oldest first.
        cords: Every cord.
        effects: Particles and the time of all effects.
    """

    number: int
    t_ns: int
    rows: NDArray[np.uint32]
    translations: NDArray[np.float32]
    rotations: NDArray[np.float32]
    scales: NDArray[np.float32]
    visible: NDArray[np.uint8]
    state: str = ""
    trial: int = 0
    trials: int = 0
    progress: float = 0.0
    board: Board = field(default_factory=Board)
    sounds: tuple[SoundNote, ...] = ()
    cords: tuple[CordNote, ...] = ()
    effects: EffectsNote = _NO_EFFECTS


_COLUMNS: tuple[tuple[str, str, int], ...] = (
    ("rows", "<u4", 1),
    ("translations", "<f4", 3),
    ("rotations", "<f4", 4),
    ("scales", "<f4", 3),
    ("visible", "u1", 1),
)


def write_frame(frame: MirrorFrame) -> bytes:
    """Return a frame as bytes."""
    rest = _Rest(
        frame.state,
        frame.trial,
        frame.trials,
        frame.progress,
        frame.board,
        list(frame.sounds),
        list(frame.cords),
        frame.effects,
    )
    text = msgspec.json.encode(rest)
    head = np.array([(_MAGIC, len(frame.rows), frame.number, frame.t_ns, len(text))], _HEAD)
    columns = [np.ascontiguousarray(getattr(frame, name), dtype).tobytes() for name, dtype, _ in _COLUMNS]
    return b"".join([head.tobytes(), *columns, text])


def read_frame(content: bytes) -> MirrorFrame:
    """Return the frame of its bytes.

    Raises:
        ValueError: It is none, or not whole.
    """
    if len(content) < _HEAD.itemsize:
        raise ValueError("not a frame of a mirror")
    head = np.frombuffer(content, _HEAD, 1)[0]
    rows, at = int(head["rows"]), _HEAD.itemsize
    sizes = [rows * width * np.dtype(dtype).itemsize for _, dtype, width in _COLUMNS]
    if head["magic"] != _MAGIC or rows > _MOST_ROWS or len(content) != at + sum(sizes) + int(head["json_bytes"]):
        raise ValueError("not a whole frame of a mirror")
    columns = {}
    for (name, dtype, width), size in zip(_COLUMNS, sizes, strict=True):
        values = np.frombuffer(content, dtype, rows * width, at)
        columns[name] = values.reshape(rows, width) if width > 1 else values
        at += size
    if not all(np.isfinite(columns[name]).all() for name in ("translations", "rotations", "scales")):
        raise ValueError("a pose is not finite")
    try:
        rest = msgspec.json.decode(content[at:], type=_Rest)
    except (msgspec.DecodeError, msgspec.ValidationError) as error:
        raise ValueError(f"not a frame of a mirror: {error}") from error
    return MirrorFrame(
        number=int(head["number"]),
        t_ns=int(head["t_ns"]),
        rows=columns["rows"],
        translations=columns["translations"],
        rotations=columns["rotations"],
        scales=columns["scales"],
        visible=columns["visible"],
        state=rest.state,
        trial=rest.trial,
        trials=rest.trials,
        progress=rest.progress,
        board=rest.board,
        sounds=tuple(rest.sounds),
        cords=tuple(rest.cords),
        effects=rest.effects,
    )
