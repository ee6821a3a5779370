"""Close a run that nobody closed: cut what is torn, seal what is good, say what is missing."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.environment import clock_pair
from mimics_app.contracts.errors import UsageError
from mimics_app.recording.append_file import AppendFile
from mimics_app.recording.arrow_format import (
    END_OF_STREAM,
    INDEX_ROW,
    decode_parameters,
    decode_samples,
    parameters_schema,
    samples_schema,
    schema_bytes,
)
from mimics_app.recording.arrow_scan import Damage, Found, read_index, read_schema, scan_stream
from mimics_app.recording.event_log import whole_length
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.recorder_process import RESERVE
from mimics_app.recording.run import Run, find_gaps
from mimics_app.recording.run_folder import FILES, write_atomically
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.trip_log import complete_trips

__all__ = ["recover"]


def recover(folder: Path) -> Manifest:
    """Make every file of a run readable to its last good part, and write a manifest marked "recovered".

    Damaged blocks in the middle are taken out of haptic.arrows, so that any Arrow reader gets through; the bytes as
    they were found stay beside it as haptic.arrows.damaged. A run that was closed is left as it is.

    Raises:
        UsageError: It is no run folder, or it was closed and has nothing to recover.
    """
    run = Run.open(folder)
    if run.manifest is not None and not run.damages:
        raise UsageError(f"{folder} was closed ({run.status}) and is whole", "there is nothing to recover")
    mended = _mend_haptic(folder)
    _mend_parameters(folder)
    _cut_lines(folder)
    (folder / RESERVE).unlink(missing_ok=True)
    run = Run(folder)
    complete_trips(run)
    mended.state.add_events(run.events)
    for row in run.trials:
        mended.state.add_trial(row)
    gaps = find_gaps(np.concatenate(mended.ticks), np.concatenate(mended.numbers), run.known_gaps())
    manifest = Manifest(
        status="recovered",
        state_hash=mended.state.hexdigest(),
        rows=mended.state.rows,
        events=len(run.events),
        trials=len(run.trials),
        parameters=len(run.parameters),
        gaps=[{"after_tick": gap.after_tick, "rows": gap.ticks, "reason": gap.why} for gap in gaps]
        + [{"reason": f"{d.length} damaged bytes at {d.offset}: {d.why}", "rows": 0} for d in mended.damages],
        clock=clock_pair(),
        files=hash_files(folder),
    )
    write_manifest(folder, manifest)
    return manifest


@dataclass
class _Mended:
    """What went through while haptic.arrows was written anew."""

    state: StateHash = field(default_factory=StateHash)
    ticks: list[NDArray[np.float64]] = field(default_factory=lambda: [np.empty(0)])
    numbers: list[NDArray[np.int64]] = field(default_factory=lambda: [np.empty(0, np.int64)])
    damages: list[Damage] = field(default_factory=list)
    index: list[tuple[int, int, int]] = field(default_factory=list)


def _mend_haptic(folder: Path) -> _Mended:
    """Write haptic.arrows and its sidecar anew in one pass; an hour of it never is in memory at once."""
    path = folder / FILES["haptic"]
    scratch = path.with_suffix(".part")
    scratch.unlink(missing_ok=True)
    mended, file = _Mended(), AppendFile(scratch)
    file.append(schema_bytes(samples_schema()))
    source = os.open(path, os.O_RDONLY | os.O_CREAT, 0o644)
    for piece in scan_stream(path, decode_samples, samples_schema(), read_index(folder / FILES["index"])):
        if isinstance(piece, Damage):
            mended.damages.append(piece)
            continue
        block = piece.block
        mended.index.append((block.seq, file.length, piece.length))
        mended.state.add_samples(block.records)
        mended.ticks.append(block.records["tick"].copy())
        mended.numbers.append(block.first + np.arange(len(block.records)))
        file.append(os.pread(source, piece.length, piece.offset))
    os.close(source)
    file.append(END_OF_STREAM)
    file.close()
    if mended.damages:
        path.replace(path.with_name(path.name + ".damaged"))
    scratch.replace(path)
    write_atomically(folder / FILES["index"], np.array(mended.index, INDEX_ROW).tobytes())
    return mended


def _mend_parameters(folder: Path) -> None:
    path = folder / FILES["parameters"]
    if not path.exists():
        return
    schema = read_schema(path) or parameters_schema()
    data = path.read_bytes()
    good = [
        data[piece.offset : piece.offset + piece.length]
        for piece in scan_stream(path, lambda part: decode_parameters(part, schema), schema)
        if isinstance(piece, Found)
    ]
    write_atomically(path, b"".join([schema_bytes(schema), *good, END_OF_STREAM]))


def _cut_lines(folder: Path) -> None:
    path = folder / FILES["events"]
    if path.exists() and whole_length(path) != path.stat().st_size:
        AppendFile(path, resume_at=whole_length(path)).close()
