"""Tables as CSV: the ticks of the loop, the trials, the events of each kind, and each body signal."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, Replay
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.run import Run

__all__ = ["EXPORTER"]


class _Csv(Exporter):
    """One table a file; the first row names each column and its unit: "f_user_world[0] [N]"."""

    about = "CSV: haptic.csv, attempts.csv, events_SOURCE_KIND.csv, signal_NAME.csv"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        yield _write(folder / "haptic.csv", *_haptic(run))
        yield _write(folder / "attempts.csv", *_lines(run.trials))
        for kind in dict.fromkeys((line["source"], line["kind"]) for line in run.lines):
            lines = [_seconds(run, line) for line in run.lines_of(*kind)]
            yield _write(folder / f"events_{kind[0]}_{kind[1]}.csv", *_lines(lines))
        for name, rows in _signals(run).items():
            yield _write(folder / f"signal_{name}.csv", ["t_s [s]", name], rows)


def _haptic(run: Run) -> tuple[list[str], Iterable[Sequence[object]]]:
    samples, extent = run.haptic, run.layout.extent
    names, columns = list[str](), list[Any]()
    for field in LOOP_FIELDS:
        units = () if field.replay is Replay.ABSENT else field.present(extent)
        for i, unit in enumerate(units):
            values = samples[field.name]
            names.append(f"{field.name}[{i}] [{unit}]" if values.ndim > 1 else f"{field.name} [{unit}]")
            columns.append(values[:, i] if values.ndim > 1 else values)
    return names, (row.tolist() for row in np.column_stack(columns)) if columns else ()


def _lines(lines: Sequence[dict[str, Any]]) -> tuple[list[str], Iterable[Sequence[object]]]:
    names = list(dict.fromkeys(name for line in lines for name in line))
    return names, ([_cell(line.get(name)) for name in names] for line in lines)


def _cell(value: object) -> object:
    if value is None:
        return ""
    return value if isinstance(value, (str, int, float)) else json.dumps(value)


def _seconds(run: Run, line: dict[str, Any]) -> dict[str, Any]:
    """Return a line with its time since the first tick [s] in front."""
    t_ns = line.get("t_ns")
    return line if not isinstance(t_ns, int) else {"t_s": (t_ns - run.start_ns) * 1e-9, **line}


def _signals(run: Run) -> dict[str, list[Sequence[object]]]:
    """Return time since the first tick [s] and value of each sample, by signal."""
    found: dict[str, list[Sequence[object]]] = {}
    for row in run.signals:
        block = row.block
        begin = (block.t_ns - run.start_ns) * 1e-9
        rows = found.setdefault(block.name, [])
        rows += [(begin + i / block.rate, value) for i, value in enumerate(np.asarray(block.values).tolist())]
    return found


def _write(file: Path, names: Sequence[str], rows: Iterable[Sequence[object]]) -> Path:
    with file.open("x", newline="", encoding="utf-8") as out:
        writer = csv.writer(out)
        writer.writerow(names)
        writer.writerows(rows)
    return file


EXPORTER = _Csv()
