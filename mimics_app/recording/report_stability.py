"""Stability in the report: margins of the contacts, and their energy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.recording.attempts import Attempt
from mimics_app.recording.report_tables import Table
from mimics_app.recording.report_values import Seconds
from mimics_app.recording.run import Run

__all__ = ["smallest_margin", "stability_lines", "stability_tables"]

_MOST_SHOWN = 10.0
_MOST_LOSSES = 20


def _touching(samples: NDArray[Any]) -> NDArray[np.bool_]:
    """Return the ticks with a contact force of the tunnel's wall or a shape."""
    pressed = (samples["penetration"] > 0.0) | (samples["touching"] > 0.0)
    return np.asarray(pressed & samples["f_user_world"].any(axis=1))


def smallest_margin(samples: NDArray[Any]) -> float | None:
    """Return the smallest stability margin of the contacts [-], None without a contact."""
    margins = samples["margin"][_touching(samples)]
    return float(margins.min()) if len(margins) else None


def _contacts(run: Run) -> list[tuple[str, float]]:
    """Return the smallest margin of each object touched [%], in ascending order."""
    stability = run.manifest.summary.get("stability") if run.manifest else None
    contacts = stability.get("contacts") if isinstance(stability, Mapping) else None
    if not isinstance(contacts, Mapping):
        return []
    known = [(str(name), 100.0 * margin) for name, margin in contacts.items() if isinstance(margin, float)]
    return sorted(known, key=lambda item: item[1])


def stability_lines(attempt: Attempt) -> dict[str, dict[str, tuple[str, F8]]]:
    """Return traces of an attempt by label of the axis and class of the line: name and values, shape [n].

    {} without contact, as margin and energy are those of a contact.
    """
    samples = attempt.samples
    if not _touching(samples).any():
        return {}
    return {
        "stability margin [%]": {
            "margin": ("stiffness reserve", 100.0 * np.minimum(samples["margin"], _MOST_SHOWN)),
        },
        "energy [mJ]": {
            "energy": ("taken by the wall since the contact began", 1000.0 * samples["energy"]),
        },
    }


def stability_tables(run: Run) -> dict[str, Table]:
    """Return the tables on stability by heading; {} without recorded ticks."""
    samples = run.haptic
    if len(samples) == 0:
        return {}
    touching = samples[_touching(samples)]
    lost = run.events[run.events["kind"] == EventKind.MARGIN]
    capped = run.events[run.events["kind"] == EventKind.CAP]
    shaken = run.events[run.events["kind"] == EventKind.OSCILLATION]
    rows: list[tuple[str, Any]] = [
        ("mean period, weighted by length [ms]", 1e3 * float(samples["period_s"].mean())),
        ("longest it was [ms]", 1e3 * float(samples["period_s"].max())),
        ("times the margin was lost", len(lost)),
        ("contacts with reduced stiffness", len(capped)),
        ("oscillations that were calmed", len(shaken)),
        ("times a force was cut at its limit", int((run.events["kind"] == EventKind.FORCE_LIMIT).sum())),
        ("ticks in which the passivity controller acted", int((samples["passivity"] > 0.0).sum())),
        ("smallest level of the energy tank [J]", float(samples["tank"].min())),
        ("smallest share of active forces it allowed [%]", 100.0 * float(samples["tank_share"].min())),
    ]
    if len(touching):
        limit, margin = float(touching["stiffness_limit"].min()), 100.0 * float(touching["margin"].min())
        given = 1e3 * max(0.0, -float(touching["energy"].min()))
        rows = [
            ("smallest margin while touching [%]", margin),
            ("smallest stable stiffness then [N/m]", limit),
            ("largest energy returned by one contact [mJ]", given),
            ("smallest share of the authored stiffness [%]", 100.0 * float(touching["stiffness_share"].min())),
            *rows,
        ]
    tables = {"Stability": Table(["", "value"], rows)}
    if contacts := _contacts(run):
        tables["Smallest margins"] = Table(["touched", "along its normal [%]"], contacts)
    if len(lost):
        tables["Margin lost"] = Table(["at [s]", "margin [%]"], _percentages(run, lost))
    if len(shaken):
        at = [Seconds(run.seconds(event["tick"])) for event in shaken[:_MOST_LOSSES]]
        sizes = [float(event["force"]) for event in shaken[:_MOST_LOSSES]]
        tables["Oscillations"] = Table(["from [s]", "root mean square [N]"], list(zip(at, sizes, strict=True)))
    if len(capped):
        tables["Softened by the cap"] = Table(["from [s]", "to [%]"], _percentages(run, capped))
    return tables


def _percentages(run: Run, events: NDArray[Any]) -> list[tuple[float, float]]:
    return [(Seconds(run.seconds(event["tick"])), 100.0 * float(event["force"])) for event in events[:_MOST_LOSSES]]
