"""Reader of a run folder, whole or damaged: valid data, and a list of what is missing."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import TICK_NS, TICKS_PER_SECOND
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.recording.append_file import is_claimed
from mimics_app.recording.arrow_format import (
    Block,
    decode_parameters,
    decode_samples,
    parameters_schema,
)
from mimics_app.recording.arrow_scan import Damage, FoundBlock, read_index, read_schema, scan_stream, sorted_scan
from mimics_app.recording.column_layout import layout_of
from mimics_app.recording.columns import row_length, samples_of
from mimics_app.recording.event_log import events_of, missing_events, read_lines
from mimics_app.recording.manifest import hash_files, read_manifest
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.session_header import read_session
from mimics_app.recording.signal_rows import SignalRow
from mimics_app.recording.signals import read_signals
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.trial_table import read_table

__all__ = ["Gap", "Run", "ending"]

_UNKNOWN = "rows are missing"
_NOMINAL_PERIOD_S = 1e-3
_MARKS = ("session", "haptic", "events", "trials", "manifest")
"""Files of which at least one is in a run folder."""


@dataclass(frozen=True, slots=True)
class Gap:
    """A gap in the haptic stream.

    Attributes:
        after_tick: Last tick before the gap, -1 at the start.
        ticks: Number of missing ticks.
        why: Cause, "rows are missing" where unknown.
    """

    after_tick: int
    ticks: int
    why: str


class _Survey:
    """What is known of haptic.arrows after its blocks were read in order.

    Attributes:
        damages: Parts that are not valid blocks.
        gaps: Gaps between its rows.
        rows: Number of valid rows.
        end_of_ticks: Largest tick plus 1, 0 without rows.

    Args:
        known: See `Run.known_gaps`.
    """

    def __init__(self, known: Mapping[int, str]) -> None:
        self.damages: list[Damage] = []
        self.gaps: list[Gap] = []
        self.rows = self.end_of_ticks = 0
        self._known = known
        self._last_tick = -1.0
        self._next_number = 0

    def add(self, piece: FoundBlock | Damage) -> None:
        """Add the next part of the file."""
        if isinstance(piece, Damage):
            self.damages.append(piece)
            return
        block = piece.block
        ticks = np.concatenate(([self._last_tick], block.records["tick"]))
        for i in np.flatnonzero(np.diff(ticks) != 1.0):
            if self.rows or ticks[1] > 0 or i > 0:  # a first row of a tick below 0 follows no other
                number = block.first + int(i) if i else self._next_number
                why = self._known.get(number, _UNKNOWN)
                self.gaps.append(Gap(int(ticks[i]), int(ticks[i + 1] - ticks[i]) - 1, why))
        self.rows += len(block.records)
        self._next_number = block.first + len(block.records)
        if len(ticks) > 1:
            self._last_tick = float(ticks[-1])
            self.end_of_ticks = max(self.end_of_ticks, int(ticks[1:].max()) + 1)


class Run:
    """One run folder.

    Attributes:
        folder: The folder.
        session: Content of session.json without damaged parts.
        manifest: The manifest, None where the run was never closed or the file is damaged.
        layout: Layout of haptic.arrows.
        reading: Called with the share of haptic.arrows that was read, 0 to 1, while its blocks are read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.reading: Callable[[float], None] = _report_nothing
        self.session, self._session_problems = read_session(folder)
        self.manifest, self._manifest_problem = read_manifest(folder)
        self.layout, self._layout_problem = layout_of(read_schema(folder / FILES["haptic"]))

    @classmethod
    def open(cls, folder: Path | str) -> Run:
        """Open a run folder, also one that was never closed, is damaged, or is of another version.

        Raises:
            SceneError: It is not a run folder.
        """
        folder = Path(folder)
        if not any(os.path.lexists(folder / FILES[key]) for key in _MARKS):
            fix = "give a folder that holds session.json and haptic.arrows"
            raise SceneError(Issue(str(folder), "", "this is not a run folder", fix))
        return cls(folder)

    @property
    def status(self) -> str:
        """Status of the manifest, or "open": the run was never closed, or is being recorded."""
        return self.manifest.status if self.manifest else "open"

    @property
    def being_recorded(self) -> bool:
        """Whether its session is under way: it is not closed, and its recorder is running."""
        return self.manifest is None and is_claimed(self.folder / FILES["haptic"])

    @property
    def summary(self) -> dict[str, Any]:
        """The application's summary, {} where the run was never closed."""
        return self.manifest.summary if self.manifest else {}

    def seconds(self, tick: float) -> float:
        """Return the session time of a tick [s], from the mean period of the recorded ones."""
        period = float(self.haptic["t"][-1] / self.haptic["tick"][-1]) if len(self.haptic) > 1 else _NOMINAL_PERIOD_S
        return float(tick) * period

    def blocks(self) -> Iterator[NDArray[Any]]:
        """Yield the valid rows of haptic.arrows block by block, as SAMPLE records of shape [n].

        One block at a time is in memory: an hour of rows takes gigabytes. `reading` is called in between.
        """
        survey = _Survey(self.known_gaps())
        layout, index = self.layout, read_index(self.folder / FILES["index"])
        path = self.folder / FILES["haptic"]
        size = max(1, path.stat().st_size) if path.is_file() else 1
        for each in scan_stream(path, lambda data: decode_samples(data, layout), layout.schema, index):
            survey.add(each)
            if isinstance(each, FoundBlock):
                yield each.block.records
            self.reading(min(1.0, (each.offset + each.length) / size))
        self.__dict__["_survey"] = survey

    @cached_property
    def _survey(self) -> _Survey:
        for _ in self.blocks():
            pass
        return self.__dict__["_survey"]

    @cached_property
    def haptic(self) -> NDArray[Any]:
        """The valid rows of haptic.arrows as samples of the device (`sample_dtype`), shape [n], in order."""
        blocks = list(self.blocks())
        return np.concatenate(blocks) if blocks else samples_of(np.empty((0, row_length(self.layout.extent.contacts))))

    @property
    def damages(self) -> list[Damage]:
        """Parts of haptic.arrows that are not valid blocks."""
        return self._survey.damages

    @property
    def gaps(self) -> list[Gap]:
        """Gaps in order; a cut-off end cannot be seen from the ticks and is in `damages`."""
        return self._survey.gaps

    def known_gaps(self) -> dict[int, str]:
        """Return the reason of each gap that the recorder noted, by the number of the first row after it."""
        return {int(line["after_row"]): str(line["reason"]) for line in self.lines_of("recorder", "gap")}

    @cached_property
    def _lines(self) -> tuple[list[dict[str, Any]], int, str]:
        return _read_or_say(self.folder / FILES["events"], read_lines)

    @property
    def lines(self) -> list[dict[str, Any]]:
        """The valid lines of events.jsonl, in order."""
        return self._lines[0]

    def lines_of(self, source: str, kind: str) -> list[dict[str, Any]]:
        """Return the lines of one source and kind, in order."""
        return [line for line in self.lines if line["source"] == source and line["kind"] == kind]

    @cached_property
    def events(self) -> NDArray[Any]:
        """The loop's EVENT records, shape [n], in order."""
        return events_of(self.lines)

    @property
    def start_ns(self) -> int:
        """Release time of tick 0 on the clock of every `t_ns` [ns], 0 where no event of the loop is left."""
        first = self.events[:1]
        return int(first["t_ns"][0] - first["tick"][0] * TICK_NS) if len(first) else 0

    @property
    def last_event_tick(self) -> int:
        """Tick of the last event of the loop, 0 where there is none."""
        return int(self.events["tick"].max()) if len(self.events) else 0

    @property
    def comparable_end(self) -> int:
        """Tick before which events and rows are complete: a run that was cut off may lack some of the last ones."""
        return self.end_of_ticks if self.status == "clean" else min(self.end_of_ticks, self.last_event_tick)

    @cached_property
    def _trials(self) -> tuple[list[dict[str, Any]], int, str]:
        return _read_or_say(self.folder / FILES["trials"], read_table)

    @property
    def trials(self) -> list[dict[str, Any]]:
        """Rows of trials.csv, one per finished trial."""
        return self._trials[0]

    @cached_property
    def _parameter_scan(self) -> tuple[dict[int, Block], list[Damage]]:
        path = self.folder / FILES["parameters"]
        schema = read_schema(path) or parameters_schema()
        found, damages = sorted_scan(path, lambda data: decode_parameters(data, schema), schema)
        return {int(each.block.records["sequence"][0]): each.block for each in found}, damages

    @cached_property
    def parameters(self) -> dict[int, NDArray[Any]]:
        """Parameter blocks by sequence, each a record of the dtype it was recorded with, shape [1]."""
        return {number: block.records for number, block in self._parameter_scan[0].items()}

    @cached_property
    def rows(self) -> dict[int, Rows]:
        """Tables of haptic objects by sequence of their parameter block, rows in use only; empty ones are left out."""
        return {
            number: block.rows
            for number, block in self._parameter_scan[0].items()
            if block.rows and any(map(len, block.rows))
        }

    @cached_property
    def _signal_scan(self) -> tuple[list[SignalRow], list[str]]:
        return read_signals(self.folder)

    @property
    def signals(self) -> list[SignalRow]:
        """Blocks of body signals in order; [] for none."""
        return self._signal_scan[0]

    def state_hash(self) -> str:
        """Return the state hash computed from the files."""
        state = StateHash(self.layout.extent)
        state.add_samples(self.haptic)
        state.add_events(self.events)
        for row in self.trials:
            state.add_trial(row)
        return state.hexdigest()

    @property
    def end_of_ticks(self) -> int:
        """Number of the last recorded tick plus 1."""
        return self._survey.end_of_ticks

    @property
    def lost_at_end(self) -> int:
        """Number of ticks missing after the last row, as noted by the manifest or the recorder."""
        there = self.end_of_ticks
        if self.manifest:
            return max(0, self.manifest.rows + self.manifest.dropped.get("samples", 0) - there)
        return sum(line.get("rows", 0) for line in self.lines_of("recorder", "gap") if line["after_row"] >= there)

    def _seen_after_end(self) -> int:
        """Return the number of ticks after the last row by the events, for a run without a manifest.

        0 unless it is larger than `lost_at_end`.
        """
        if self.manifest:
            return 0
        latest = max((tick for line in self.lines if isinstance(tick := line.get("tick"), int)), default=-1)
        seen = latest + 1 - self.end_of_ticks
        return seen if seen > self.lost_at_end else 0

    @property
    def needs_repair(self) -> bool:
        """Whether `mimics record recover` has something to do: it was not closed, or parts of it cannot be read."""
        return self.manifest is None or bool(
            self.damages
            or self._parameter_scan[1]
            or self._lines[1]
            or self._trials[1]
            or any(_trouble_of(self.folder / FILES[key]) for key in ("haptic", "parameters", "events", "trials"))
        )

    def problems(self) -> list[str]:
        """Return all problems, one sentence each; [] for a whole run."""
        if self.manifest is None:
            reason = self._manifest_problem
            open_end = "the run is being recorded" if self.being_recorded else "the run was never closed"
            ended = [f"{FILES['manifest']} cannot be read: {reason}" if reason else open_end]
        else:
            ended = [] if self.manifest.status == "clean" else [ending(self.manifest.status)]
        return list(dict.fromkeys([*ended, *self.losses()]))

    def notes(self) -> list[str]:
        """Return remarks on a whole run, one sentence each."""
        newer = [name for name in self.layout.absent if name not in self.layout.missing]
        if not newer or not self._survey.rows:
            return []
        return [f"{FILES['haptic']} is of another version: {', '.join(newer)} were not recorded yet"]

    def losses(self) -> list[str]:
        """Return what is missing or damaged, one sentence each, with the findings of `mimics record recover`."""
        found = [*self.manifest.lost] if self.manifest else []
        found += self._session_problems
        found += self._haptic_losses()
        found += self._parameter_losses()
        found += self._signal_scan[1]
        found += self._event_losses()
        found += _table_losses(FILES["trials"], "rows", *self._trials[1:])
        if self.manifest and self.manifest.trials > len(self.trials):
            found.append(f"{FILES['trials']}: {self.manifest.trials - len(self.trials)} trials are missing")
        return list(dict.fromkeys(found))

    def _haptic_losses(self) -> list[str]:
        name = FILES["haptic"]
        found = _trouble_of(self.folder / name)
        if self._layout_problem and not found:
            found.append(f"{name}: {self._layout_problem}; it is read as this version writes it")
        if self.layout.missing and self._survey.rows:
            found.append(f"{name}: recorded without {', '.join(self.layout.missing)}")
        found += [damage.sentence(name) for damage in self.damages]
        found += [f"{gap.ticks} ticks are missing after tick {gap.after_tick}: {gap.why}" for gap in self.gaps]
        if ticks := self._seen_after_end():
            seconds = ticks / TICKS_PER_SECOND
            found.append(f"at least {ticks} ticks ({seconds:.3f} s) after tick {self.end_of_ticks - 1} are missing")
        elif self.lost_at_end:
            why = f": {self.manifest.problem}" if self.manifest and self.manifest.problem else ""
            found.append(f"the last {self.lost_at_end} ticks are missing{why}")
        return found

    def _parameter_losses(self) -> list[str]:
        name = FILES["parameters"]
        blocks, damages = self._parameter_scan
        found = _trouble_of(self.folder / name)
        found += [damage.sentence(name) for damage in damages]
        if self.manifest and self.manifest.parameters > len(blocks):
            found.append(f"{name}: {self.manifest.parameters - len(blocks)} parameter blocks are missing")
        return found

    def _event_losses(self) -> list[str]:
        name = FILES["events"]
        found = _table_losses(name, "lines", *self._lines[1:])
        missing = missing_events(self.lines)
        if self.manifest:
            missing = max(missing, self.manifest.events - len(self.events))
            dropped = self.manifest.dropped
            found += [f"{dropped[what]} {what} were dropped" for what in ("events", "lines") if dropped.get(what)]
        if missing:
            found.append(f"{name}: {missing} events of the loop are missing")
        return found

    def disagreements(self) -> list[str]:
        """Return the differences between the files and their seals; [] for none, or without a manifest."""
        if self.manifest is None:
            return []
        now = hash_files(self.folder)
        found: list[str] = []
        for name in (name for name, sealed in self.manifest.files.items() if now.get(name) != sealed):
            if name in now:
                found.append(f"{name} was changed after the run was closed")
            elif os.path.lexists(self.folder / name):  # a pipe, a folder: it is not missing
                found += _trouble_of(self.folder / name) or [f"{name} cannot be read"]
            else:
                found.append(f"{name} is missing")
        if self.layout.current and self.state_hash() != self.manifest.state_hash:
            found.append("the state hash of the files is not that of the manifest")
        return found


def _report_nothing(_: float) -> None:
    """Discard a share."""


def ending(status: str) -> str:
    """Return the sentence on the end of a run that was not closed in order."""
    return f"the run is {status}"


def _read_or_say(
    path: Path, read: Callable[[Path], tuple[list[dict[str, Any]], int]]
) -> tuple[list[dict[str, Any]], int, str]:
    """Return the result of `read`, the number of invalid parts, and why the file cannot be read, "" where it can."""
    try:
        return *read(path), ""
    except OSError as error:
        return [], 0, error.strerror or str(error)


def _table_losses(name: str, parts: str, bad: int, why: str) -> list[str]:
    found = [f"{name} cannot be read: {why}"] if why else []
    return found + ([f"{name}: {bad} {parts} cannot be read"] if bad else [])


def _trouble_of(path: Path) -> list[str]:
    try:
        open_regular(path).close()
    except OSError as error:
        return [f"{path.name} cannot be read: {error.strerror or error}"]
    return []
