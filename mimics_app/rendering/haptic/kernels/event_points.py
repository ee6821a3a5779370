"""Points of contact as bodies of events, for compiled code."""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.loop.haptic import body_of_point, point_of_body

__all__ = ["event_body", "event_point"]

event_body = kernel(body_of_point)
"""`body_of_point` compiled."""

event_point = kernel(point_of_body)
"""`point_of_body` compiled."""
