"""Stability in the report: margins of the contacts, and their energy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic import EventKind, point_of_body
from mimics_app.contracts.loop.loop_fields import contacts_in, point_rows
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.attempts import Attempt
from mimics_app.recording.columns import row_norms
from mimics_app.recording.report_tables import Table
from mimics_app.recording.report_values import Seconds, mapping
from mimics_app.recording.run import Run

__all__ = ["smallest_margin", "stability_lines", "stability_tables"]

_MOST_SHOWN = 10.0
_MOST_LOSSES = 20


def _touching(samples: NDArray[Any]) -> NDArray[np.bool_]:
    """Return the ticks with a contact force of the tunnel's wall or a shape."""
    pressed = (samples["penetration"] > 0.0) | (samples["touching"] > 0.0)
    return np.asarray(pressed & samples["f_user_world"].any(axis=1))


def _points_of(samples: NDArray[Any]) -> list[NDArray[Any]]:
    """Return the rows of each point of contact of the device, shape [n] each."""
    return [point_rows(samples, point) for point in range(contacts_in(samples))]


def smallest_margin(samples: NDArray[Any]) -> float | None:
    """Return the smallest stability margin of the contacts of all points [-], None without a contact."""
    margins = [point["margin"][_touching(point)] for point in _points_of(samples)]
    return min((float(each.min()) for each in margins if len(each)), default=None)


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
        phrase("stability margin [%]"): {
            "margin": (phrase("stiffness reserve"), 100.0 * np.minimum(samples["margin"], _MOST_SHOWN)),
        },
        phrase("energy [mJ]"): {
            "energy": (phrase("taken by the wall since the contact began"), 1000.0 * samples["energy"]),
        },
    }


def stability_tables(run: Run) -> dict[str, Table]:
    """Return the tables on stability by heading; {} without recorded ticks."""
    samples = run.haptic
    if len(samples) == 0:
        return {}
    points = _points_of(samples)
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
        ("ticks in which the passivity controller acted", int(np.any([p["passivity"] > 0.0 for p in points], 0).sum())),
        ("smallest level of the energy tank [J]", _least("tank", points)),
        ("smallest share of active forces it allowed [%]", 100.0 * _least("tank_share", points)),
    ]
    if touching := [pressed for point in points if len(pressed := point[_touching(point)])]:
        rows = [
            ("smallest margin while touching [%]", 100.0 * _least("margin", touching)),
            ("smallest stable stiffness then [N/m]", _least("stiffness_limit", touching)),
            ("largest energy returned by one contact [mJ]", 1e3 * max(0.0, -_least("energy", touching))),
            ("smallest share of the authored stiffness [%]", 100.0 * _least("stiffness_share", touching)),
            *rows,
        ]
    tables = {"Stability": Table(["", "value"], rows)}
    if len(points) > 1:
        tables["Points of contact"] = _table_of_points(run, points)
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


def _least(name: str, points: list[NDArray[Any]]) -> float:
    return min(float(point[name].min()) for point in points)


def _table_of_points(run: Run, points: list[NDArray[Any]]) -> Table:
    """Return what each point of contact did: its force, its contacts, its worst margin, the energy of its contacts."""
    names = mapping(run.session.get("names")).get("points")
    known = names if isinstance(names, list) and len(names) == len(points) else range(1, len(points) + 1)
    begun = run.events[run.events["kind"] == EventKind.CONTACT_BEGIN]["body_a"]
    rows: list[tuple[Any, ...]] = []
    for number, (name, point) in enumerate(zip(known, points, strict=True)):
        pressed = point[_touching(point)]
        rows.append(
            (
                str(name),
                float(row_norms(point["f_user_world"]).max()),
                sum(1 for body in begun if body <= 0 and point_of_body(int(body)) == number),
                1e-3 * len(pressed),
                100.0 * float(pressed["margin"].min()) if len(pressed) else None,
                1e3 * float(point["energy"].min()),
            )
        )
    heads = ["", "largest force [N]", "contacts", "in contact [s]", "smallest margin [%]", "lowest energy [mJ]"]
    return Table(heads, rows)


def _percentages(run: Run, events: NDArray[Any]) -> list[tuple[float, float]]:
    return [(Seconds(run.seconds(event["tick"])), 100.0 * float(event["force"])) for event in events[:_MOST_LOSSES]]
