"""The attempts of a run: their rows of the haptic stream, and their tunnels from the parameter blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.loop.controller_slots import Lead
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.messages.report_section import TunnelShape
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.columns import whole
from mimics_app.recording.older_blocks import OlderController
from mimics_app.recording.report_values import number
from mimics_app.recording.result_words import outcome_word, trial_names
from mimics_app.recording.run import Run

__all__ = ["Attempt", "find_attempts", "tunnel_shape"]

_STEPS_PER_PIECE = 24
"""Points of a tunnel drawn per spline segment."""
_TUNNEL = {"pieces", "centre", "radius", "radius_scale"}


@dataclass(frozen=True, slots=True)
class Attempt:
    """The rows of one attempt at a trial.

    Attributes:
        number: SCENE.trial while it lasted.
        samples: SAMPLE records, shape [n].
        free: Where the person moved the robot, shape [n]; elsewhere it was driven.
        tunnel: The task's tunnel, None where there is none.
        row: Its row of trials.csv, {} without one.
        name: Name of the trial, see `trial_names`; "" where unknown.
    """

    number: int
    samples: NDArray[Any]
    free: NDArray[np.bool_]
    tunnel: TunnelShape | None
    row: Mapping[str, Any]
    name: str = ""

    @property
    def anchor(self) -> str:
        """Name of its place in the report."""
        return f"attempt-{self.number}"

    @property
    def heading(self) -> str:
        """Its trial, and which attempt it is where it is not the first."""
        if not self.row:
            return phrase("Attempt {n:d} (not finished)", n=self.number) if self.number else phrase("Whole run")
        attempt = number(self.row.get("attempt"))
        which = self.name if self.row.get("practice") else phrase("Trial {name:s}", name=self.name)
        if attempt is None or attempt <= 1:
            return which
        return f"{which} · {phrase('attempt {n:d}', n=round(attempt))}"

    @property
    def title(self) -> str:
        """Title in the report."""
        if not self.row:
            return self.heading
        words, score = [self.heading], number(self.row.get("score"))
        if self.row.get("label"):
            words.append(str(self.row["label"]).replace("_", " "))
        words.append(outcome_word(self.row))
        if score is not None:
            words.append(phrase("score {score:.0f} of 100", score=score))
        return " · ".join(word for word in words if word)


def find_attempts(run: Run) -> list[Attempt]:
    """Return the attempts of a run in order; a single one where no parameter block separates them."""
    samples = run.haptic
    if len(samples) == 0:
        return []
    blocks = run.parameters
    sequences = whole(samples["sequence"])
    numbers = _per_row(sequences, blocks, "trial", 0)
    known, which = np.unique(sequences, return_inverse=True)
    led = np.array([_person_leads(blocks.get(int(sequence))) for sequence in known])[which]
    names = trial_names(run.trials)
    begun = [int(n) for n in np.unique(numbers) if n > 0] or [0]
    attempts = []
    for i, count in enumerate(begun):
        mine = numbers == count
        tunnel = next(
            (tunnel_shape(blocks[s], run.rows.get(s)) for s in _in_order(sequences[mine]) if s in blocks), None
        )
        row, name = (run.trials[i], names[i]) if i < len(run.trials) else ({}, "")
        attempts.append(Attempt(count, samples[mine], led[mine], tunnel, row, name))
    return attempts


def _per_row(
    sequences: NDArray[np.int64], blocks: Mapping[int, NDArray[Any]], field: str, otherwise: int
) -> NDArray[np.int64]:
    """Return a SCENE field at each row; `otherwise` for rows whose block is lost."""
    known, which = np.unique(sequences, return_inverse=True)
    values = [_field(blocks.get(int(s)), field, otherwise) for s in known]
    return np.array(values, np.int64)[which]


def _person_leads(block: NDArray[Any] | None) -> bool:
    """Return whether the person moves the robot under the controller of a block; a lost one is taken for such."""
    if block is None or "controller" not in (block.dtype.names or ()):
        return True
    controller = int(block["controller"][0])
    if "leads" in (block.dtype.names or ()):
        return int(block["leads"][0][controller]) == Lead.PERSON
    return controller in (OlderController.ADMITTANCE, OlderController.IMPEDANCE)


def _field(block: NDArray[Any] | None, name: str, otherwise: int) -> int:
    """Return an integer of a parameter block, or `otherwise` where the block of an older version lacks it."""
    return otherwise if block is None or name not in (block.dtype.names or ()) else int(block[name][0])


def _in_order(sequences: NDArray[np.int64]) -> list[int]:
    """Return the sequence numbers in use, the one with the most rows first."""
    known, counts = np.unique(sequences, return_counts=True)
    return [int(s) for s in known[np.argsort(-counts, kind="stable")]]


def tunnel_shape(block: NDArray[Any], rows: Rows | None) -> TunnelShape | None:
    """Sample the task's own tunnel of a parameter block: a0 + a1 u + a2 u^2 + a3 u^3 per segment, u in [0, 1].

    Args:
        block: SCENE record, shape [1], as its version wrote it.
        rows: Its tables of objects.

    Returns:
        None without a tunnel, or where the version that recorded it described tunnels otherwise.
    """
    own = _field(block, "own_tunnel", 0)
    if rows is None or not 0 <= own < len(rows.tunnels) or not _TUNNEL <= {*(rows.tunnels.dtype.names or ())}:
        return None
    tunnel = rows.tunnels[own]
    pieces = min(int(tunnel["pieces"]), len(tunnel["centre"]))
    if pieces < 1:
        return None
    u = np.linspace(0.0, 1.0, _STEPS_PER_PIECE, endpoint=False)
    powers = u[:, None] ** np.arange(4)
    centre = np.einsum("uk,pak->pua", powers, tunnel["centre"][:pieces]).reshape(-1, 3)
    radius = np.einsum("uk,pk->pu", powers, tunnel["radius"][:pieces]).reshape(-1)
    end, end_radius = tunnel["centre"][pieces - 1].sum(axis=1), tunnel["radius"][pieces - 1].sum()
    return TunnelShape(np.vstack([centre, end]), np.append(radius, end_radius) * float(tunnel["radius_scale"]))
