"""A travelled tunnel in the report: Figure 48 of D2.1, and the forces and distances of the tunnel over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.report_section import (
    PlottedCurve,
    ReportedAttempt,
    ReportSection,
    Traces,
    TunnelShape,
    Word,
)
from mimics_app.contracts.system.phrases import phrase

__all__ = ["TunnelSection"]


class TunnelSection(ReportSection):
    """Handle path blue, bisector red, walls green."""

    heading = phrase("Movement through the tunnel")
    colours = phrase(
        "The handle path is blue, the centre line of the tunnel red, its walls green. "
        "A contact at the near or the far side of the tunnel is drawn between its walls."
    )
    touching = phrase("ball in the wall")
    contact = phrase("wall contact begins")
    contacts = phrase("wall contacts")

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return any(attempt.tunnel is not None for attempt in attempts)

    def behind(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[PlottedCurve]:
        if attempt.tunnel is None:
            return ()
        first, second = _walls(attempt.tunnel)
        bisector = attempt.tunnel.bisector_world[:, :2]
        walls = [PlottedCurve(first, "wall", phrase("walls of the tunnel")), PlottedCurve(second, "wall")]
        return [*walls, PlottedCurve(bisector, "bisector", phrase("centre line of the tunnel"))]

    def words(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Word]:
        """Return the captions of both ends, outside the walls and the path."""
        if attempt.tunnel is None:
            return ()
        bisector = attempt.tunnel.bisector_world[:, :2]
        ends = ((phrase("tunnel start"), 0, 1), (phrase("goal"), -1, -2))
        return [Word(name, bisector[end], bisector[end] - bisector[inner]) for name, end, inner in ends]

    def traces(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Traces:
        samples = attempt.samples
        room = np.maximum(samples["tunnel_radius"] - samples["ball_radius"], 0.0)
        return {
            phrase("tunnel force [N]"): {
                "tangent": (phrase("along the tunnel (t)"), samples["f_tunnel"][:, 0]),
                "normal": (phrase("normal (n)"), samples["f_tunnel"][:, 1]),
                "binormal": (phrase("binormal (b)"), samples["f_tunnel"][:, 2]),
            },
            phrase("off the line [mm]"): {
                "robot": (phrase("distance of the ball from the centre line"), 1000.0 * samples["distance"]),
                "wall": (phrase("where the ball meets the wall"), 1000.0 * room),
            },
        }


def _walls(tunnel: TunnelShape) -> tuple[F8, F8]:
    """Return both outlines of a tube in the frontal plane: the projected bisector offset by the radius."""
    centre = tunnel.bisector_world[:, :2]
    along = np.gradient(centre, axis=0)
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-12)[:, None]
    side = np.column_stack([-along[:, 1], along[:, 0]]) / length * tunnel.radius[:, None]
    return centre + side, centre - side
