"""Stiffness share and stability margin of all contacts of a tick, from their list.

One contact has a closed form (`stability`); several, or a shape and the tunnel's wall at once, are limited direction by
direction (`directions`). Sticking friction is stiff along the surface too. Effects and held bodies are isotropic.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.compiled.kernel import kernel
from mimics_app.rendering.haptic.kernels.closed_region import (
    contact_share,
    region_margin,
    stiffness_limit,
)
from mimics_app.rendering.haptic.kernels.directions import (
    add_contact,
    along,
    begin_span,
    span_share,
    worst_direction,
)

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import SceneRecord, StateRecord, Table, TotalsRecord, TouchedRecord

__all__ = ["common_share", "is_pressed", "touched_margin"]


@kernel
def is_pressed(state: StateRecord) -> bool:
    """Whether the tunnel's wall pushes."""
    return state.tunnel.wall_force > 0.0


@kernel
def _is_alone(state: StateRecord, totals: TotalsRecord) -> bool:
    return totals.touching == 1 and not is_pressed(state)


@kernel
def _gather(
    state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord], share: float, wall_share: float
) -> None:
    """Sum all contacts of the tick into state.span: shapes scaled by `share`, the wall's spring by `wall_share`."""
    span, even = state.span, state.acting.effect_share
    begin_span(span, even * totals.even_stiffness, even * totals.even_damping)
    for i in range(totals.listed):
        c = touched[i]
        k, b, hold, hold_b = c.stiffness, c.damping, c.hold_stiffness, c.hold_damping
        add_contact(span, c.normal, share * k, share * b, share * hold, share * hold_b)
    if is_pressed(state):
        k = wall_share * state.tunnel.stiffness + state.tunnel.centring
        add_contact(span, state.tunnel.normal_world, k, state.tunnel.damping, 0.0, 0.0)


@kernel
def common_share(scene: SceneRecord, state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord]) -> float:
    """Share 0-1 of all contacts, springs and dampers alike, that keeps SCENE.cap_margin in every direction.

    Args:
        scene: SCENE record.
        state: STATE record.
        totals: TOTALS record with a contact.
        touched: TOUCHED records.
    """
    region, margin = state.region, scene.cap_margin
    if not _is_alone(state, totals):
        _gather(state, totals, touched, 1.0, 1.0)
        return span_share(state.span, region, margin)
    even = state.acting.effect_share
    c, k, b = touched[0], even * totals.even_stiffness, even * totals.even_damping
    share = contact_share(region, c.stiffness + k, c.damping + b, margin)
    if c.hold_stiffness > c.stiffness:
        share = min(share, contact_share(region, c.hold_stiffness + k, c.hold_damping + b, margin))
    return share


@kernel
def _margin_alone(state: StateRecord, totals: TotalsRecord, contact: TouchedRecord) -> None:
    """Set state.span.limit and margin of a single contact."""
    span, region, share, even = state.span, state.region, state.acting.shape_share, state.acting.effect_share
    k, b = even * totals.even_stiffness, even * totals.even_damping
    damping = share * contact.damping + b
    span.limit = stiffness_limit(region, damping)
    span.margin = region_margin(region, share * contact.stiffness + k, damping)
    if contact.hold_stiffness > contact.stiffness:
        damping = share * contact.hold_damping + b
        margin = region_margin(region, share * contact.hold_stiffness + k, damping)
        if margin < span.margin:
            span.limit = stiffness_limit(region, damping)
            span.margin = margin
    contact.margin = span.margin


@kernel
def touched_margin(state: StateRecord, totals: TotalsRecord, touched: Table[TouchedRecord]) -> None:
    """Set limit and margin of the worst direction, as rendered, in state.span, and the margin of each contact's normal.

    The margin of the worst direction is the smallest of all. Arguments as of `common_share`.
    """
    if _is_alone(state, totals):
        _margin_alone(state, totals, touched[0])
        return
    span, region = state.span, state.region
    _gather(state, totals, touched, state.acting.shape_share, state.acting.wall_share)
    for i in range(totals.listed):
        n = touched[i].normal
        touched[i].margin = region_margin(region, along(span.stiffness, n), along(span.damping, n))
    if is_pressed(state):
        n = state.tunnel.normal_world
        state.wall_margin = region_margin(region, along(span.stiffness, n), along(span.damping, n))
    worst_direction(span, region)
