"""Files of MATLAB (version 5): one for each series, one for events, attempts and gaps."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._spool import spooled
from mimics_app.recording.line_tables import (
    Rows,
    attempts_table,
    columns_of,
    event_kinds,
    event_rows,
    gaps_table,
)
from mimics_app.recording.run import Run
from mimics_app.recording.series import Series, series_of

__all__ = ["EXPORTER"]

_HEADER = b"MATLAB 5.0 MAT-file, recording of mimics_app"
_HEADER_LENGTH = 116
"""Bytes of text at the beginning of a file, where the writer states the time of writing."""
_LONGEST_NAME = 63
_NO_LETTER = re.compile(r"[^A-Za-z0-9_]")


class _Mat(Exporter):
    """A variable for each field, of shape [rows, components]; `units` is a struct of their units."""

    about = "MATLAB: haptic.mat, signal_NAME.mat, and tables.mat with events, attempts and gaps"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        series = series_of(run)
        for each in series:
            yield _write_series(folder / f"{'' if each.name == 'haptic' else 'signal_'}{each.name}.mat", each)
        path = folder / "tables.mat"
        events = {_name("_".join(kind)): _struct(event_rows(run, *kind)) for kind in event_kinds(run)}
        tables = {"events": events, "attempts": _struct(attempts_table(run)), "gaps": _struct(gaps_table(series))}
        with path.open("x+b") as file:
            for name, table in tables.items():
                _put(file, name, table)
            _set_header(file)
        yield path


def _write_series(path: Path, series: Series) -> Path:
    with path.open("x+b") as file, spooled(series, path.parent) as spool:
        units = {"t_s": "s", "source_s": "s"} | {field.name: " ".join(field.units) for field in series.fields}
        _put(file, "units", {_name(name): unit for name, unit in units.items()})
        _put(file, "rate_hz", series.rate)
        for name in ("t_s", "source_s"):
            _put(file, name, spool.times(name))
        for name, _, values in spool.fields():
            _put(file, _name(name), values)
        _set_header(file)
    return path


def _put(file: BinaryIO, name: str, value: object) -> None:
    """Append a variable; the library writes the header at the beginning of a file only."""
    from scipy.io import savemat

    savemat(file, {name: value}, oned_as="column", long_field_names=True)


def _set_header(file: BinaryIO) -> None:
    """Replace the header's text, so that the same recording gives the same bytes."""
    file.seek(0)
    file.write(_HEADER.ljust(_HEADER_LENGTH))


def _struct(rows: Rows) -> dict[str, Any]:
    return {
        _name(name): column if isinstance(column, np.ndarray) else np.array(column, object)[:, None]
        for name, column in columns_of(rows)
    }


def _name(name: str) -> str:
    """Return a name that MATLAB takes for a variable."""
    plain = _NO_LETTER.sub("_", name)[:_LONGEST_NAME]
    return plain if plain[:1].isalpha() else f"x{plain}"[:_LONGEST_NAME]


EXPORTER = _Mat()
