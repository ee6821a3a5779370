"""events.jsonl: one JSON object per line, in the order of arrival at the recorder.

Every line has `source` and `kind`:

    loop      EVENT records of the 1 kHz loop, `n` counting from 0, kinds as in contracts.loop.haptic.EventKind
    app       journal of the main thread; the kinds that the report reads are listed in `recorder.Recorder.journal`
    recorder  start, gap, clock (pairs of wall and monotonic time), problem, restart, end

Both come first in it, so that lines of a kind are found without parsing the others.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.gait_state import GaitState
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.json_text import parse_object

__all__ = [
    "encode_event",
    "encode_line",
    "events_of",
    "find_lines",
    "missing_events",
    "read_lines",
    "split_lines",
    "to_json",
]

_SCALARS = ("t_ns", "tick", "body_a", "body_b", "material_a", "material_b", "speed", "force", "value")
_VECTORS = ("position_world", "normal_world")
_VALUE_NAMES = {
    "state": "state",
    "trip": "cause",
    "parameters": "sequence",
    "margin": "margin",
    "cap": "stiffness_share",
    "stale": "age_s",
    "left_out": "pairs",
    "quarantine": "effect",
    "oscillation": "rms_n",
    "gait_state": "state",
}
"""Name of the value of an event in its line, by kind; `force` [N] for the other kinds. In memory, and in the lines of
older recordings, all kinds hold it in the field `force`."""


def _plain(value: object) -> object:
    """Return a value that JSON can hold for numpy arrays and scalars, and for any other object."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    return str(value)


_encoder = msgspec.json.Encoder(enc_hook=_plain)


def to_json(value: object) -> bytes:
    """Return the JSON text of plain values, numpy arrays and scalars; NaN and infinity become null."""
    try:
        return _encoder.encode(value)
    except UnicodeEncodeError:  # names of files whose bytes are not UTF-8
        return _encoder.encode(_printable(value))


def _printable(value: object) -> object:
    if isinstance(value, str):
        return value.encode("utf-8", "backslashreplace").decode()
    if isinstance(value, Mapping):
        return {_printable(name): _printable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_printable(item) for item in value]
    return _printable(str(value)) if isinstance(value, Path) else value


def encode_line(source: str, kind: str, data: Mapping[str, object]) -> bytes:
    """Return one line without its end; NaN and infinity become null."""
    rest = {name: value for name, value in data.items() if name not in ("source", "kind")}
    return to_json({"source": source, "kind": kind, **rest})


def encode_event(event: NDArray[Any], n: int) -> bytes:
    """Return one EVENT record [shape ()] as a line; float32 values are printed so that they are read back exactly."""
    try:
        kind = EventKind(int(event["kind"])).name.lower()
    except ValueError:
        kind = f"kind_{int(event['kind'])}"
    fields = {name: event[name].item() for name in _SCALARS} | {name: event[name].tolist() for name in _VECTORS}
    if event["kind"] == EventKind.GAIT_STATE:
        fields["name"] = GaitState(int(event["force"])).name.lower()
    return encode_line("loop", kind, {"n": n, **{_name(kind, field): value for field, value in fields.items()}})


def _name(kind: str, field: str) -> str:
    """Return the name of a field in the lines of a kind."""
    return _VALUE_NAMES.get(kind, field) if field == "force" else field


def events_of(lines: list[dict[str, Any]]) -> NDArray[Any]:
    """Return the EVENT records [n] among the lines of `read_lines`, in their order."""
    loop = [line for line in lines if line["source"] == "loop"]
    events = np.zeros(len(loop), EVENT)
    with np.errstate(over="ignore"):  # numbers beyond float32 become infinite
        for event, line in zip(events, loop, strict=True):
            event["kind"] = _kind_of(line["kind"])
            for field in (*_SCALARS, *_VECTORS):
                value = line[field] if field in line else line[_name(line["kind"], field)]
                event[field] = value if EVENT[field].kind == "i" else np.array(value, np.float64)  # None becomes NaN
    return events


def _kind_of(name: str) -> int:
    """Return the number of a kind of event.

    Raises:
        ValueError: There is none of this name.
    """
    if name.startswith("kind_"):
        return int(name[5:])
    if name.upper() not in EventKind.__members__:
        raise ValueError(f"there is no event {name!r}")
    return EventKind[name.upper()]


def missing_events(lines: list[dict[str, Any]]) -> int:
    """Return the number of the loop's events that are missing before the last one, by their numbers."""
    numbers = [line["n"] for line in lines if line["source"] == "loop"]
    return max(0, max(numbers) + 1 - len(numbers)) if numbers else 0


_Int16 = Annotated[int, msgspec.Meta(ge=-(2**15), lt=2**15)]
_Int64 = Annotated[int, msgspec.Meta(ge=-(2**63), le=2**63 - 1)]
_Count = Annotated[int, msgspec.Meta(ge=0, le=2**62)]
_Vector = tuple[float | None, float | None, float | None]


class _Loop(msgspec.Struct):
    """Shape of a line of the loop. The kinds below state only fields that readers need; other kinds are free."""

    kind: str
    n: _Count
    t_ns: _Int64
    tick: _Int64
    body_a: _Int16
    body_b: _Int16
    material_a: _Int16
    material_b: _Int16
    speed: float | None
    value: float | None
    position_world: _Vector
    normal_world: _Vector


class _Gap(msgspec.Struct):
    reason: str
    after_row: _Count
    rows: _Count = 0


class _Frame(msgspec.Struct):
    tick: _Int64 | None = None
    frame: _Int64 | None = None


class _Sound(msgspec.Struct):
    tick: _Int64 | None = None
    sample: _Int64 | None = None
    latency_ms: float | None = None


_SHAPES: dict[tuple[str, str], type[msgspec.Struct]] = {
    ("recorder", "gap"): _Gap,
    ("app", "frame"): _Frame,
    ("app", "sound"): _Sound,
}


def read_lines(path: Path) -> tuple[list[dict[str, Any]], int]:
    """Return the valid lines, and the number of invalid ones, an incomplete last line included.

    Raises:
        OSError: The file is missing or cannot be read.
    """
    good, bad = split_lines(read_regular(path))
    return [line for _, line in good], bad


def split_lines(content: bytes) -> tuple[list[tuple[bytes, dict[str, Any]]], int]:
    """Return text without line end and object of every valid line, and the number of invalid ones."""
    good: list[tuple[bytes, dict[str, Any]]] = []
    bad = 0
    for text in content.split(b"\n"):
        if not text.strip():
            continue
        try:
            good.append((text, _parse_line(text)))
        except ValueError:
            bad += 1
    return good, bad


def _parse_line(text: bytes) -> dict[str, Any]:
    """Parse one line.

    Raises:
        ValueError: It is no object with a source and a kind, or not of the shape of its kind.
    """
    line = parse_object(text)
    source, kind = line.get("source"), line.get("kind")
    if not isinstance(source, str) or not isinstance(kind, str):
        raise ValueError("no source and kind")
    line["source"], line["kind"] = sys.intern(source), sys.intern(kind)  # of an hour's 216,000 frames, one each
    if source == "loop":
        msgspec.convert(line, _Loop)
        value = line["force"] if "force" in line else line.get(_name(kind, "force"), "")
        if value is not None and (isinstance(value, bool) or not isinstance(value, int | float)):
            raise ValueError("no number")
        if isinstance(value, int):
            _as_float(value)
        if abs(_kind_of(kind)) >= 2**31:
            raise ValueError("no kind of event")
    elif shape := _SHAPES.get((source, kind)):
        msgspec.convert(line, shape)
    return line


def _as_float(value: int) -> float:
    """Convert an integer of any size. ValueError: it is beyond the range of a float."""
    try:
        return float(value)
    except OverflowError as error:
        raise ValueError("no number of a float's range") from error


def find_lines(data: bytes, source: str, kind: str = "") -> list[bytes]:
    """Return the complete lines of one source, and of one kind if given, in the bytes of an events.jsonl."""
    head = f'{{"source":"{source}",' + (f'"kind":"{kind}",' if kind else "")
    return [line for line in data.split(b"\n")[:-1] if line.startswith(head.encode())]
