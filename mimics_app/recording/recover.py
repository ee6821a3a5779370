"""Close a run that nobody closed: cut what is torn, seal what is good, say what is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np

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
from mimics_app.recording.arrow_scan import Found, read_index, read_schema, scan_stream
from mimics_app.recording.environment import clock_pair
from mimics_app.recording.event_log import whole_length
from mimics_app.recording.manifest import Manifest, hash_files, write_manifest
from mimics_app.recording.recorder_process import RESERVE
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES, write_atomically

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
    _mend_haptic(folder, keep_original=bool(run.damages))
    _mend_parameters(folder)
    _cut_lines(folder)
    (folder / RESERVE).unlink(missing_ok=True)
    mended = Run.open(folder)
    manifest = Manifest(
        status="recovered",
        state_hash=mended.state_hash(),
        rows=len(mended.haptic),
        events=len(mended.events),
        trials=len(mended.trials),
        parameters=len(mended.parameters),
        gaps=[{"after_tick": gap.after_tick, "rows": gap.ticks, "reason": gap.why} for gap in mended.gaps]
        + [{"reason": f"{d.length} damaged bytes at {d.offset}: {d.why}", "rows": 0} for d in run.damages],
        clock=clock_pair(),
        files=hash_files(folder),
    )
    write_manifest(folder, manifest)
    return manifest


def _mend_haptic(folder: Path, *, keep_original: bool) -> None:
    path = folder / FILES["haptic"]
    scratch = path.with_suffix(".part")
    scratch.unlink(missing_ok=True)
    mended = AppendFile(scratch)
    mended.append(schema_bytes(samples_schema()))
    index: list[tuple[int, int, int]] = []
    data = path.read_bytes() if path.exists() else b""
    for piece in scan_stream(path, decode_samples, samples_schema(), read_index(folder / FILES["index"])):
        if isinstance(piece, Found):
            index.append((piece.block.seq, mended.length, piece.length))
            mended.append(data[piece.offset : piece.offset + piece.length])
    mended.append(END_OF_STREAM)
    mended.close()
    if keep_original:
        path.replace(path.with_name(path.name + ".damaged"))
    scratch.replace(path)
    write_atomically(folder / FILES["index"], np.array(index, INDEX_ROW).tobytes())


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
