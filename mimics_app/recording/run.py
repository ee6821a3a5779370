"""Read a run folder back, whole or damaged: what is good comes out, what is missing is named."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import PartialDataError, UsageError
from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.object_rows import Rows
from mimics_app.recording.arrow_format import (
    Block,
    decode_parameters,
    decode_samples,
    parameters_schema,
    samples_schema,
)
from mimics_app.recording.arrow_scan import Damage, Found, read_index, read_schema, scan_stream
from mimics_app.recording.event_log import events_of, read_lines
from mimics_app.recording.manifest import Manifest, hash_files, read_manifest
from mimics_app.recording.run_folder import FILES
from mimics_app.recording.state_hash import StateHash
from mimics_app.recording.trial_table import read_trials

__all__ = ["Gap", "Run", "find_gaps"]

_UNKNOWN = "rows are missing"
_NOMINAL_PERIOD_S = 1e-3


@dataclass(frozen=True, slots=True)
class Gap:
    """Rows of the haptic stream that are missing.

    Attributes:
        after_tick: Last tick before the gap, -1 at the start.
        ticks: How many are missing.
        why: Cause where it is known, else "rows are missing".
    """

    after_tick: int
    ticks: int
    why: str


class Run:
    """One run folder.

    Attributes:
        folder: Where it is.
        session: Content of session.json, {} where it is damaged.
        manifest: How the run ended, None where it was never closed.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.session = _read_session(folder / FILES["session"])
        self.manifest: Manifest | None = read_manifest(folder)

    @classmethod
    def open(cls, folder: Path) -> Run:
        """Open a run folder, also one that was never closed.

        Raises:
            UsageError: It is no run folder.
            PartialDataError: It was written by a version with other columns.
        """
        if not (folder / FILES["session"]).exists() and not (folder / FILES["haptic"]).exists():
            raise UsageError(f"{folder} is no run folder", "give a folder that holds session.json and haptic.arrows")
        schema = read_schema(folder / FILES["haptic"])
        if schema is not None and not schema.equals(samples_schema(), check_metadata=True):
            raise PartialDataError(
                f"{folder / FILES['haptic']} has other columns than this version records",
                "read it with the version named in its session.json, or with pyarrow.ipc.open_stream",
            )
        return cls(folder)

    @property
    def status(self) -> str:
        """How the run ended, as its manifest says, or "open": it was never closed, or is still being recorded."""
        return self.manifest.status if self.manifest else "open"

    @property
    def summary(self) -> dict[str, Any]:
        """What the app said at the end, {} where the run was never closed."""
        return self.manifest.summary if self.manifest else {}

    def seconds(self, tick: float) -> float:
        """Session time of a tick [s]; every tick is as long as those that were recorded."""
        period = float(self.haptic["t"][-1] / self.haptic["tick"][-1]) if len(self.haptic) > 1 else _NOMINAL_PERIOD_S
        return float(tick) * period

    @cached_property
    def _scan(self) -> tuple[list[Block], list[Damage]]:
        path = self.folder / FILES["haptic"]
        blocks: list[Block] = []
        damages: list[Damage] = []
        for piece in scan_stream(path, decode_samples, samples_schema(), read_index(self.folder / FILES["index"])):
            if isinstance(piece, Found):
                blocks.append(piece.block)
            else:
                damages.append(piece)
        return blocks, damages

    @cached_property
    def haptic(self) -> NDArray[Any]:
        """Every good row of haptic.arrows as SAMPLE records, shape [n], in order."""
        blocks = self._scan[0]
        return np.concatenate([block.records for block in blocks]) if blocks else np.empty(0, SAMPLE)

    @property
    def damages(self) -> list[Damage]:
        """Bytes of haptic.arrows that are no good block."""
        return self._scan[1]

    @cached_property
    def gaps(self) -> list[Gap]:
        """Where ticks are missing, in order; a cut end cannot be seen from the ticks and stands in `damages`."""
        numbers = [block.first + np.arange(len(block.records)) for block in self._scan[0]]
        return find_gaps(self.haptic["tick"], np.concatenate(numbers) if numbers else np.empty(0), self.known_gaps())

    def known_gaps(self) -> dict[int, str]:
        """Why rows are missing, by the number of the first row after them, as the recorder wrote it down."""
        return {int(line["after_row"]): str(line["reason"]) for line in self.lines_of("recorder", "gap")}

    @cached_property
    def _lines(self) -> tuple[list[dict[str, Any]], int]:
        return read_lines(self.folder / FILES["events"])

    @property
    def lines(self) -> list[dict[str, Any]]:
        """Every good line of events.jsonl, in order."""
        return self._lines[0]

    def lines_of(self, source: str, kind: str) -> list[dict[str, Any]]:
        """Lines of one source and kind, in order."""
        return [line for line in self.lines if line["source"] == source and line["kind"] == kind]

    @cached_property
    def events(self) -> NDArray[Any]:
        """The loop's EVENT records, shape [n], in order."""
        return events_of(self.lines)

    @cached_property
    def trials(self) -> list[dict[str, Any]]:
        """Rows of trials.csv, one per finished trial."""
        return read_trials(self.folder / FILES["trials"])

    @cached_property
    def _parameter_blocks(self) -> dict[int, Block]:
        path = self.folder / FILES["parameters"]
        schema = read_schema(path) or parameters_schema()
        found = scan_stream(path, lambda data: decode_parameters(data, schema), schema)
        blocks = [piece.block for piece in found if isinstance(piece, Found)]
        return {int(block.records["sequence"][0]): block for block in blocks}

    @cached_property
    def parameters(self) -> dict[int, NDArray[Any]]:
        """Parameter blocks by sequence, each a record of the dtype it was recorded with, shape [1]."""
        return {number: block.records for number, block in self._parameter_blocks.items()}

    @cached_property
    def rows(self) -> dict[int, Rows]:
        """The tables of haptic objects beside those parameter blocks that count any, by sequence, rows in use only."""
        return {
            number: block.rows
            for number, block in self._parameter_blocks.items()
            if block.rows and any(map(len, block.rows))
        }

    def state_hash(self) -> str:
        """The state hash of what the files hold, computed anew."""
        state = StateHash()
        state.add_samples(self.haptic)
        state.add_events(self.events)
        for row in self.trials:
            state.add_trial(row)
        return state.hexdigest()

    @property
    def lost_at_end(self) -> int:
        """Ticks the recorder counted as lost and no gap shows: after the last row there is."""
        lost = self.manifest.dropped.get("samples", 0) if self.manifest else 0
        return max(0, lost - sum(gap.ticks for gap in self.gaps))

    def problems(self) -> list[str]:
        """Everything that is not as it should be, one sentence each; [] for a whole run."""
        found: list[str] = []
        if self.manifest is None:
            found.append("the run was never closed")
        elif self.manifest.status != "clean":
            found.append(f"the run is {self.manifest.status}")
        found += [f"{FILES['haptic']}: {d.length} bytes at {d.offset} are no good block: {d.why}" for d in self.damages]
        found += [f"{gap.ticks} ticks are missing after tick {gap.after_tick}: {gap.why}" for gap in self.gaps]
        if self.lost_at_end:
            why = f": {self.manifest.problem}" if self.manifest and self.manifest.problem else ""
            found.append(f"the last {self.lost_at_end} ticks are missing{why}")
        if self._lines[1]:
            found.append(f"{FILES['events']}: {self._lines[1]} lines cannot be read")
        return found

    def disagreements(self) -> list[str]:
        """What differs between the files and the manifest that seals them; [] when it agrees, or there is none."""
        if self.manifest is None:
            return []
        now = hash_files(self.folder)
        found = [
            f"{name} {'is missing' if name not in now else 'was changed after the run was closed'}"
            for name, sealed in self.manifest.files.items()
            if now.get(name) != sealed
        ]
        if self.state_hash() != self.manifest.state_hash:
            found.append("the state hash of the files is not that of the manifest")
        return found


def find_gaps(ticks: NDArray[np.float64], numbers: NDArray[Any], known: Mapping[int, str]) -> list[Gap]:
    """Where ticks are missing.

    Args:
        ticks: Of the rows that are there, shape [n].
        numbers: Places of these rows since the session's start, shape [n].
        known: See `Run.known_gaps`.
    """
    gaps: list[Gap] = []
    if len(ticks) and ticks[0] > 0:
        gaps.append(Gap(-1, int(ticks[0]), known.get(0, _UNKNOWN)))
    for i in np.flatnonzero(np.diff(ticks) != 1.0):
        why = known.get(int(numbers[i]) + 1, _UNKNOWN)
        gaps.append(Gap(int(ticks[i]), int(ticks[i + 1] - ticks[i]) - 1, why))
    return gaps


def _read_session(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_bytes())
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
