"""Repair of a run: damaged parts are removed, the rest is sealed, losses are listed. It never fails.

What cannot be repaired, because the disk is full or the folder is read-only, is listed with the losses.
"""

from __future__ import annotations

import filecmp
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import open_regular, read_or_nothing
from mimics_app.contracts.system.run_environment import clock_pair
from mimics_app.contracts.system.whole_file import whole_file
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import (
    END_OF_STREAM,
    INDEX_ROW,
    Block,
    decode_parameters,
    decode_samples,
    parameters_schema,
    schema_bytes,
)
from mimics_app.recording.arrow_scan import Damage, read_index, read_schema, scan_stream, sorted_scan
from mimics_app.recording.column_file import end_of_columns
from mimics_app.recording.column_layout import SampleLayout, layout_of
from mimics_app.recording.event_log import split_lines
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.recorder_process import RESERVE
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES, write_atomically
from mimics_app.recording.signals import decode_signals, signals_schema
from mimics_app.recording.trial_table import read_table, table_text
from mimics_app.recording.trip_log import complete_trips
from mimics_app.recording.verdict import Verdict, evaluate

__all__ = ["Recovery", "recover"]


@dataclass(frozen=True, slots=True)
class Recovery:
    """Result of `recover`.

    Attributes:
        repaired: Names of the files whose content changed; () for none.
        verdict: Verdict on the run after the repair, with what could not be written.
    """

    repaired: tuple[str, ...]
    verdict: Verdict


def recover(folder: Path) -> Recovery:
    """Make every file of a run readable to its last valid part, and write a manifest marked "recovered".

    Damaged blocks and lines are removed, so that any reader can read the files; the original is kept under its name
    with `.damaged`. A run that was closed and needs no repair is not changed.

    Raises:
        SceneError: It is not a run folder, or its session is active: the recorder would write to files that are gone.
    """
    before = Run.open(folder)
    if before.being_recorded:
        raise SceneError(Issue(str(folder), "", "this run is being recorded", "end its session first"))
    repaired: list[str] = []
    unwritten: list[str] = []
    if before.needs_repair:
        losses = [*before.losses(), *before.disagreements(), *_lost_manifest(before)]
        for key, repair in _REPAIRS.items():
            _attempt(FILES[key], repair, folder, repaired, unwritten)
        _attempt(
            FILES["manifest"], lambda where: _seal(where, before, [*losses, *unwritten]), folder, repaired, unwritten
        )
    verdict = evaluate(Run.open(folder))
    verdict = replace(
        verdict,
        problems=tuple(dict.fromkeys([*verdict.problems, *unwritten])),
        fresh=tuple(dict.fromkeys([*verdict.fresh, *unwritten])),
    )
    return Recovery(tuple(repaired), verdict)


def _attempt(
    name: str, repair: Callable[[Path], list[str]], folder: Path, repaired: list[str], unwritten: list[str]
) -> None:
    """Repair one file; note the files written, or why it cannot be repaired."""
    try:
        repaired += repair(folder)
    except OSError as error:
        unwritten.append(f"{name} cannot be repaired: {error.strerror or error}")


def _lost_manifest(run: Run) -> list[str]:
    damaged = run.manifest is None and os.path.lexists(run.folder / FILES["manifest"])
    return ["what the application said at the end of the run cannot be read"] if damaged else []


def _seal(folder: Path, before: Run, losses: list[str]) -> list[str]:
    """Write the manifest of the present files; the former one's summary of the run is kept."""
    run = Run(folder)
    complete_trips(run)
    (folder / RESERVE).unlink(missing_ok=True)
    known = before.manifest or Manifest("recovered", "", 0, 0, 0, 0)
    at_end = max(before.lost_at_end, before.end_of_ticks - run.end_of_ticks)
    manifest = replace(
        known,
        status="recovered",
        state_hash=run.state_hash(),
        rows=len(run.haptic),
        events=len(run.events),
        trials=len(run.trials),
        parameters=len(run.parameters),
        dropped={**known.dropped, "samples": run.end_of_ticks - len(run.haptic) + at_end},
        gaps=[{"after_tick": gap.after_tick, "rows": gap.ticks, "reason": gap.why} for gap in run.gaps],
        lost=list(dict.fromkeys(losses)),
        clock=clock_pair(),
        files=hash_files(folder),
    )
    path = folder / FILES["manifest"]
    if before.manifest is None and os.path.lexists(path):
        _put_aside(path)
    write_manifest(folder, manifest)
    return [FILES["manifest"]]


def _put_aside(path: Path) -> None:
    """Rename a file to a free name with `.damaged`; nothing is overwritten."""
    place = path.with_name(path.name + ".damaged")
    number = 1
    while os.path.lexists(place):
        number += 1
        place = path.with_name(f"{path.name}.damaged{number}")
    path.rename(place)


def _replace(path: Path, content: bytes, *, keep: bool) -> None:
    """Write a file; with `keep`, or if it is no regular file, the former one is renamed."""
    if os.path.lexists(path) and (keep or not path.is_file()):
        _put_aside(path)
    write_atomically(path, content)


def _repair_haptic(folder: Path) -> list[str]:
    """Rewrite haptic.arrows and its sidecar block by block: an hour of it does not fit in memory."""
    path = folder / FILES["haptic"]
    layout, _ = layout_of(read_schema(path))
    scratch = path.with_suffix(".part")
    scratch.unlink(missing_ok=True)
    file = AppendFile(scratch)
    with whole_file(scratch):
        try:
            index, damages = _copy_blocks(path, file, layout)
            file.append(END_OF_STREAM)
        finally:
            file.close()
    repaired = []
    if _is_own_file(path) and filecmp.cmp(scratch, path, shallow=False):
        scratch.unlink()
    else:
        if os.path.lexists(path) and (damages or not path.is_file()):
            _put_aside(path)
        scratch.replace(path)
        repaired.append(FILES["haptic"])
    return repaired + _write_if_other(folder / FILES["index"], np.array(index, INDEX_ROW).tobytes(), keep=False)


def _is_own_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def _write_if_other(path: Path, content: bytes, *, keep: bool) -> list[str]:
    """Write a file unless it has this content; return the name of the file if it was written."""
    if _is_own_file(path) and read_or_nothing(path) == content:
        return []
    _replace(path, content, keep=keep)
    return [path.name]


def _copy_blocks(path: Path, file: AppendFile, layout: SampleLayout) -> tuple[list[tuple[int, int, int]], list[Damage]]:
    """Append every valid block to `file`; return the rows of the sidecar, and the damaged parts."""
    file.append(schema_bytes(layout.schema))
    index: list[tuple[int, int, int]] = []
    damages: list[Damage] = []
    try:
        source = open_regular(path)
    except OSError:
        return index, damages
    with source:
        places = read_index(path.with_name(FILES["index"]))
        for piece in scan_stream(path, lambda data: decode_samples(data, layout), layout.schema, places):
            if isinstance(piece, Damage):
                damages.append(piece)
                continue
            index.append((piece.block.seq, file.length, piece.length))
            source.seek(piece.offset)
            file.append(source.read(piece.length))
    return index, damages


def _repair_columns(folder: Path) -> list[str]:
    """Cut the columns off after their last valid batch: all their rows are in haptic.arrows."""
    path = folder / FILES["columns"]
    if not _is_own_file(path):
        return []
    end = end_of_columns(folder, layout_of(read_schema(folder / FILES["haptic"]))[0].extent)
    if end == 0:
        _put_aside(path)
        return [path.name]
    if path.stat().st_size == end + len(END_OF_STREAM):
        return []
    file = AppendFile(path, resume_at=end)
    file.append(END_OF_STREAM)
    file.close()
    return [path.name]


def _repair_parameters(folder: Path) -> list[str]:
    path = folder / FILES["parameters"]
    schema = read_schema(path) or parameters_schema()
    return _repair_stream(path, schema, lambda part: decode_parameters(part, schema))


def _repair_signals(folder: Path) -> list[str]:
    path = folder / FILES["signals"]
    return _repair_stream(path, signals_schema(), decode_signals) if os.path.lexists(path) else []


def _repair_stream(path: Path, schema: pa.Schema, decode: Callable[[memoryview], Block]) -> list[str]:
    """Rewrite a stream that fits in memory with its valid blocks only."""
    data = read_or_nothing(path)
    found, damages = sorted_scan(path, decode, schema)
    good = [data[each.offset : each.offset + each.length] for each in found]
    return _write_if_other(path, b"".join([schema_bytes(schema), *good, END_OF_STREAM]), keep=bool(damages))


def _repair_events(folder: Path) -> list[str]:
    path = folder / FILES["events"]
    good, bad = split_lines(read_or_nothing(path))
    text = b"".join(line + b"\n" for line, _ in good)
    return _write_if_other(path, text, keep=bad > 0)


def _repair_trials(folder: Path) -> list[str]:
    path = folder / FILES["trials"]
    rows: list[dict[str, Any]] = []
    bad = 0
    if path.is_file():
        rows, bad = read_table(path)
        if not bad:
            return []
    _replace(path, table_text(rows), keep=bad > 0)
    return [path.name]


_REPAIRS: dict[str, Callable[[Path], list[str]]] = {
    "haptic": _repair_haptic,
    "columns": _repair_columns,
    "parameters": _repair_parameters,
    "signals": _repair_signals,
    "events": _repair_events,
    "trials": _repair_trials,
}
"""Repair of each file by its key; session.json and haptic_statics.npz cannot be repaired."""
