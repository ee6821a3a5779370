"""events.jsonl: one JSON object a line, in the order things reached the recorder.

Every line has `source` and `kind`:

    loop      EVENT records of the 1 kHz loop, `n` counting from 0, kinds as in contracts.haptic.EventKind
    app       what the main thread journals; the kinds that the report reads are listed in `recorder.Recorder.journal`
    recorder  start, gap, clock (pairs of wall and monotonic time), problem, restart, end

Both stand first in it, so that lines of a kind are found without reading the others.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.haptic import EVENT, EventKind

__all__ = ["encode_event", "encode_line", "events_of", "find_lines", "read_lines", "to_json", "whole_length"]

_SCALARS = ("t_ns", "tick", "body_a", "body_b", "material_a", "material_b", "speed", "force", "value")
_VECTORS = ("position_world", "normal_world")


def _plain(value: Any) -> Any:
    """What JSON can hold for numpy arrays and scalars, and anything else that is not plain."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    return str(value)


_encoder = msgspec.json.Encoder(enc_hook=_plain)


def to_json(value: object) -> bytes:
    """JSON text of plain values, numpy arrays and scalars; not-a-number and infinity become null."""
    try:
        return _encoder.encode(value)
    except UnicodeEncodeError:  # names of files that are no text: bytes that are not UTF-8, or another encoding's
        return _encoder.encode(_printable(value))


def _printable(value: Any) -> Any:
    if isinstance(value, str):
        return value.encode("utf-8", "backslashreplace").decode()
    if isinstance(value, Mapping):
        return {_printable(name): _printable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_printable(item) for item in value]
    return _printable(str(value)) if isinstance(value, Path) else value


def encode_line(source: str, kind: str, data: Mapping[str, object]) -> bytes:
    """One line without its end; not-a-number and infinity become null."""
    rest = {name: value for name, value in data.items() if name not in ("source", "kind")}
    return to_json({"source": source, "kind": kind, **rest})


def encode_event(event: NDArray[Any], n: int) -> bytes:
    """One EVENT record [shape ()] as a line; float32 values are printed so that they read back exactly."""
    try:
        kind = EventKind(int(event["kind"])).name.lower()
    except ValueError:
        kind = f"kind_{int(event['kind'])}"
    fields = {name: event[name].item() for name in _SCALARS} | {name: event[name].tolist() for name in _VECTORS}
    return encode_line("loop", kind, {"n": n, **fields})


def events_of(lines: list[dict[str, Any]]) -> NDArray[Any]:
    """The EVENT records [n] among lines that were read, in their order."""
    loop = [line for line in lines if line.get("source") == "loop"]
    events = np.zeros(len(loop), EVENT)
    for event, line in zip(events, loop, strict=True):
        name = str(line["kind"])
        event["kind"] = int(name[5:]) if name.startswith("kind_") else EventKind[name.upper()]
        for field in (*_SCALARS, *_VECTORS):
            value = line[field]
            event[field] = value if isinstance(value, int) else np.array(value, np.float64)  # None becomes NaN
    return events


def read_lines(path: Path) -> tuple[list[dict[str, Any]], int]:
    """Every line that is a JSON object, and how many are not; a torn last line counts as one of those."""
    lines: list[dict[str, Any]] = []
    bad = 0
    for text in _raw_lines(path):
        try:
            line = json.loads(text)
        except ValueError:
            bad += 1
            continue
        if isinstance(line, dict) and "source" in line and "kind" in line:
            lines.append(line)
        else:
            bad += 1
    return lines, bad


def whole_length(path: Path) -> int:
    """Bytes up to and with the last end of line."""
    return path.read_bytes().rfind(b"\n") + 1


def find_lines(data: bytes, source: str, kind: str = "") -> list[bytes]:
    """Whole lines of one source, and of one kind where one is given, of the bytes of an events.jsonl."""
    head = f'{{"source":"{source}",' + (f'"kind":"{kind}",' if kind else "")
    return [line for line in data.split(b"\n")[:-1] if line.startswith(head.encode())]


def _raw_lines(path: Path) -> Iterator[bytes]:
    if not path.exists():
        return
    with path.open("rb") as file:
        for text in file:
            if text.strip():
                yield text
