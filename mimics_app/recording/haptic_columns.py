"""Columns of the haptic stream of a run, each read when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.recording.arrow_format import decode_samples, schema_bytes
from mimics_app.recording.arrow_scan import Found, read_index, scan_stream
from mimics_app.recording.column_file import read_columns
from mimics_app.recording.columns import present_columns, rows_of
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import FILES

__all__ = ["HapticColumns"]


class HapticColumns:
    """The valid rows of haptic.arrows, from haptic_columns.arrows as far as that goes.

    Where haptic.arrows misses blocks or is of an earlier version, it is read as a whole; blocks whose rows are in the
    columns are not verified again. All columns have the rows that there were when the first was read.

    Args:
        run: The run.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._rows: int | None = None
        self._rest: dict[int, F8] = {}

    def read(self, chosen: Sequence[int]) -> F8:
        """Return recorded columns.

        Args:
            chosen: Their indices in the order of the recording, ascending.

        Returns:
            Their values, shape [rows, len(chosen)].
        """
        extent, blocks = self._run.layout.extent, 0
        parts: list[list[NDArray[np.float64]]] = []
        for batch in read_columns(self._run.folder, extent, chosen) if len(self._index) else ():
            if batch.blocks > len(self._index):
                break
            parts.append(batch.values)
            blocks = batch.blocks
        rest = self._after(blocks)[:, list(chosen)]
        parts.append(list(rest.T))
        found = np.empty((sum(len(part[0]) for part in parts), len(chosen)))
        row = 0
        for part in parts:
            for i, values in enumerate(part):
                found[row : row + len(values), i] = values
            row += len(part[0])
        self._rows = len(found) if self._rows is None else self._rows
        return found[: self._rows]

    @cached_property
    def _index(self) -> NDArray[np.void]:
        """The sidecar of a haptic.arrows that has every block of the session in order; empty for any other."""
        path, layout = self._run.folder / FILES["haptic"], self._run.layout
        index = read_index(path.with_name(FILES["index"]))
        ends = np.concatenate(([len(schema_bytes(layout.schema))], index["offset"] + index["length"]))
        whole = (
            layout.current
            and path.is_file()
            and np.array_equal(index["seq"], np.arange(len(index)))
            and np.array_equal(index["offset"], ends[:-1])
            and ends[-1] <= path.stat().st_size
        )
        return index if whole else index[:0]

    def _after(self, blocks: int) -> F8:
        """Return the rows after so many blocks, shape [rows, recorded columns]."""
        if blocks not in self._rest:
            run, layout = self._run, self._run.layout
            records = [run.haptic] if blocks == 0 else []
            if blocks > 0:
                _, offset, length = self._index[blocks - 1].tolist()
                path, index = run.folder / FILES["haptic"], self._index[blocks:]
                pieces = scan_stream(
                    path, lambda data: decode_samples(data, layout), layout.schema, index, offset + length
                )
                records = [each.block.records for each in pieces if isinstance(each, Found)]
            chosen = present_columns(layout.extent)
            rows = [rows_of(each)[:, chosen] for each in records]
            self._rest[blocks] = np.concatenate([np.empty((0, len(chosen))), *rows])
        return self._rest[blocks]
