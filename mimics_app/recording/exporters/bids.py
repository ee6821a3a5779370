"""A data set of the Brain Imaging Data Structure: motion of touch, physiological recordings, events.

Tables are plain text by the rules of BIDS: `n/a` where a value is missing, `motion.tsv` and `physio.tsv.gz` without a
header row, all columns described. Times count from the first sample of the motion.
"""

from __future__ import annotations

import gzip
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from mimics_app.contracts.version import __version__
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.exporters._arrow import arrow_numbers
from mimics_app.recording.exporters._spool import gridded
from mimics_app.recording.line_tables import attempts_table, gaps_table, text_of, timed_events
from mimics_app.recording.report_values import mapping
from mimics_app.recording.run import Run
from mimics_app.recording.series import Batch, Series, series_of

__all__ = ["EXPORTER"]

_VERSION = "1.10.0"
"""Version of BIDS that the data set follows."""
_MISSING = "n/a"
_NO_LABEL = re.compile(r"[^A-Za-z0-9]")
_TYPES = {"hip_world": "POS", "v_world": "VEL", "q": "JNTANG"}
"""Types of channels of motion by field; all others are miscellaneous."""
_AXES = ("x", "y", "z")

_COLUMNS = {
    "onset": {"Description": "Time since the first sample of the motion", "Units": "s"},
    "duration": {"Description": "Duration of an attempt or a gap, 0 for an event", "Units": "s"},
    "trial_type": {"Description": "Source and kind of the event, or attempt, or gap"},
    "details": {"Description": "All values of the event as a JSON object"},
}


class _Bids(Exporter):
    """One participant with one task: the folders motion and beh."""

    about = "BIDS: a data set with motion, physiological recordings and events"

    def open(self, run: Run, folder: Path) -> Iterator[Path]:
        """See `Exporter.open`."""
        code = str(mapping(run.session.get("settings")).get("participant") or "")
        scene = str(mapping(run.session.get("scene")).get("name") or "")
        subject, task = f"sub-{_label(code) or 'unknown'}", _label(scene) or "scene"
        yield from _write_description(folder, subject, code)
        motion, beh = folder / subject / "motion", folder / subject / "beh"
        motion.mkdir(parents=True)
        series = series_of(run)
        stem = f"{subject}_task-{task}"
        yield _write_motion(motion / f"{stem}_tracksys-haptic_motion.tsv", series[0])
        yield _write_channels(motion / f"{stem}_tracksys-haptic_channels.tsv", series[0])
        yield _write_json(motion / f"{stem}_tracksys-haptic_motion.json", _about_motion(series[0], scene))
        begin_s = _begin(series[0])
        yield _write_events(motion / f"{stem}_events.tsv", run, series, begin_s)
        yield _write_json(motion / f"{stem}_events.json", _COLUMNS)
        for each in series[1:]:
            beh.mkdir(exist_ok=True)
            name = f"{stem}_recording-{_label(each.name)}_physio"
            yield _write_physio(beh / f"{name}.tsv.gz", each)
            yield _write_json(beh / f"{name}.json", _about_physio(each, begin_s))


def _label(text: str) -> str:
    """Return letters and digits of a text: BIDS allows no others in names."""
    return _NO_LABEL.sub("", text)


def _write_description(folder: Path, subject: str, code: str) -> Iterator[Path]:
    about = {
        "Name": "Recording of mimics_app",
        "BIDSVersion": _VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "mimics_app", "Version": __version__}],
        "Authors": ["unknown"],
        "License": "n/a",
    }
    yield _write_json(folder / "dataset_description.json", about)
    yield _write_text(
        folder / "README.md",
        "# Recording of mimics_app\n\nTouch at 1 kHz in `motion`, body signals in `beh`, events and attempts in\n"
        "`events.tsv`. Channels and columns are described in the files beside them.\n",
    )
    yield _write_text(folder / "participants.tsv", f"participant_id\tcode\n{subject}\t{_cell(code)}\n")
    yield _write_json(folder / "participants.json", {"code": {"Description": "Pseudonym, as it was entered"}})


def _write_motion(path: Path, series: Series) -> Path:
    with path.open("xb") as file:
        for batch in gridded(series):
            _write_batch(file, [batch.t_s, batch.source_s, *batch.values.T])
    return path


def _write_batch(file: BinaryIO, columns: Sequence[np.ndarray]) -> None:
    """Write rows of numbers, parted by tabs, without a header row."""
    import pyarrow as pa
    from pyarrow import compute
    from pyarrow.csv import WriteOptions, write_csv

    arrays = []
    for column in columns:
        array, missing = arrow_numbers(column), ~np.isfinite(column)
        if missing.any():
            array = compute.if_else(pa.array(missing.tolist()), _MISSING, array.cast(pa.string()))
        arrays.append(array)
    text = io.BytesIO()
    options = WriteOptions(include_header=False, delimiter="\t", quoting_style="none")
    write_csv(pa.table(arrays, [str(i) for i in range(len(arrays))]), text, options)
    file.write(text.getbuffer())


def _write_channels(path: Path, series: Series) -> Path:
    rows = [("t_s", _MISSING, "LATENCY", _MISSING, "s"), ("source_s", _MISSING, "MISC", _MISSING, "s")]
    for field in series.fields:
        for i, (name, unit) in enumerate(zip(field.columns, field.units, strict=True)):
            kind = _kind(field.name, unit)
            axis, point = (_AXES[i], "hip") if kind in ("POS", "VEL") else (_MISSING, _MISSING)
            rows.append((name, axis, kind, point, _unit(unit)))
    lines = ["\t".join(("name", "component", "type", "tracked_point", "units")), *("\t".join(row) for row in rows)]
    return _write_text(path, "\n".join(lines) + "\n")


def _kind(name: str, unit: str) -> str:
    """Return the type of a channel; a joint in metres is no angle."""
    return "MISC" if name == "q" and unit != "rad" else _TYPES.get(name, "MISC")


def _unit(unit: str) -> str:
    return {"1": "arbitrary", "": "arbitrary"}.get(unit, unit)


def _about_motion(series: Series, scene: str) -> dict[str, Any]:
    kinds = [_kind(field.name, unit) for field in series.fields for unit in field.units]
    return {
        "TaskName": scene or "scene",
        "TaskDescription": "Task of a scene that is rendered as touch, picture and sound",
        "SamplingFrequency": series.rate,
        "SamplingFrequencyEffective": series.rate,
        "TrackingSystemName": "haptic",
        "TrackedPointsCount": 1,
        "MotionChannelCount": len(kinds) + 2,
        "POSChannelCount": kinds.count("POS"),
        "VELChannelCount": kinds.count("VEL"),
        "JNTANGChannelCount": kinds.count("JNTANG"),
        "MISCChannelCount": kinds.count("MISC") + 1,
        "LATENCYChannelCount": 1,
        "MissingValues": _MISSING,
        "RecordingType": "continuous",
    }


def _begin(series: Series) -> float:
    """Return the corrected time of the first row of a series [s]."""
    first: Batch | None = next(series.batches(), None)
    return float(first.t_s[0]) if first is not None else 0.0


def _write_physio(path: Path, series: Series) -> Path:
    with path.open("xb") as file, gzip.GzipFile("", "wb", 1, file, mtime=0) as packed:
        for batch in gridded(series):
            _write_batch(packed, [batch.t_s, batch.source_s, *batch.values.T])  # type: ignore[arg-type]
    return path


def _about_physio(series: Series, begin_s: float) -> dict[str, Any]:
    units = dict(zip(series.columns, series.units, strict=True))
    return {
        "SamplingFrequency": series.rate,
        "StartTime": _begin(series) - begin_s,
        "Columns": ["t_s", "source_s", *series.columns],
        "PhysioType": "generic",
        "t_s": {"Description": "Corrected time since tick 0", "Units": "s"},
        "source_s": {"Description": "Time stamp as the source gave it", "Units": "s"},
        **{name: {"Description": f"Samples of {name}", "Units": _unit(unit)} for name, unit in units.items()},
    }


def _write_events(path: Path, run: Run, series: Sequence[Series], begin_s: float) -> Path:
    """Write every event with a time, but for the frames; attempts and gaps have a duration."""
    spans = [("attempt", row) for row in attempts_table(run) if "begin_s" in row and "end_s" in row]
    spans += [("gap", row) for row in gaps_table(series)]
    rows = [(row["t_s"], 0.0, f"{row['source']}/{row['kind']}", row) for row in timed_events(run, frames=False)]
    rows += [(row["begin_s"], max(0.0, row["end_s"] - row["begin_s"]), kind, row) for kind, row in spans]
    rows.sort(key=lambda row: row[0])
    lines = ["\t".join(_COLUMNS)]
    for t_s, duration, kind, row in rows:
        lines.append(f"{t_s - begin_s!r}\t{duration!r}\t{_cell(kind)}\t{_cell(json.dumps(row, ensure_ascii=False))}")
    return _write_text(path, "\n".join(lines) + "\n")


def _cell(value: object) -> str:
    text = text_of(value)
    return re.sub(r"[\t\r\n]", " ", text) or _MISSING


def _write_json(path: Path, content: Mapping[str, Any]) -> Path:
    return _write_text(path, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def _write_text(path: Path, text: str) -> Path:
    with path.open("x", encoding="utf-8", newline="") as file:
        file.write(text)
    return path


EXPORTER = _Bids()
