"""Rigid objects in combined control: the leg of the admittance on an object's surface, equations (4) to (7) of D2.1.

On the surface the follower's shaft is eta_2 = f(eta_1) (`foot_constraint`) and the leader moves by

    (m_1 + m_2 f'^2) eta_1'' = F_1 + f' F_2 - m_2 f' f'' eta_1'^2 + F_fr          N = (m_2 eta_2'' - F_2) / h_2

with the virtual masses of (3), forces F that include friction along the surface, and the normal force N > 0 away from
the object. The foot leaves the surface where N would pull. At first touch the velocities are projected onto the surface
without loss beyond that of an inelastic impact.

As printed: the knee's force is "calculated to a torque acting on the knee joint and shifted to the hip joint", which
assumes dt2/dt1 = 1, and the moved mass of the knee is omitted; the hip's speed at first touch is kept, which may add
energy; nothing releases the leg; friction is -mu eta_1' (6) or -mu F_N eta_1' (7).
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.control.lokomat.foot_constraint import (
    FOOT_SURFACE,
    find_surface,
    follow_surface,
    leader_of,
)
from mimics_app.rendering.haptic.control.lokomat.shaft_admittance import move_shaft
from mimics_app.rendering.haptic.kernels.contact_records import FRICTION
from mimics_app.rendering.haptic.kernels.friction import forget_friction, hayward_armstrong
from mimics_app.rendering.haptic.kernels.lokomat.linkage import angle_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        FootSurfaceRecord,
        LegFrameRecord,
        OutlineRecord,
        ShaftSettingsRecord,
        ShaftsRecord,
        SurfaceSettingsRecord,
    )

__all__ = ["SHAFTS", "SURFACE_SETTINGS", "SurfaceFriction", "place_shafts", "step_shafts"]


class SurfaceFriction(IntEnum):
    """Friction of a rigid object's surface."""

    VISCOUS = 0  # (6), acting on the speed of the foot along the surface
    COULOMB = 1  # (7), with an anchor that holds at rest


SURFACE_SETTINGS = np.dtype(
    [
        ("friction", np.int64),  # SurfaceFriction
        ("mu", np.float64),  # [N s/m] or [-]; as printed on eta_1': [N s/m] or [s/m]
        ("anchor", np.float64),  # stiffness of the friction's anchor [N/m]
        ("hold", np.float64),  # pull at which the foot leaves the surface [N] >= 0
    ],
    align=True,
)

SHAFTS = np.dtype(
    [
        ("eta", np.float64, 2),  # shaft lengths of the virtual leg, hip and knee [m]
        ("rate", np.float64, 2),  # [m/s]
        ("theta", np.float64, 2),  # joint angles [rad]
        ("touching", np.int64),
        ("leader", np.int64),  # shaft that moves freely on the surface
        ("normal_force", np.float64),  # of the surface on the foot [N] >= 0
        ("drag", np.float64, (1,)),  # friction along the surface [N]
        ("way", np.float64, (1,)),  # path of the foot along it [m]
        ("anchor", FRICTION),
        ("surface", FOOT_SURFACE),
        ("work_eta", np.float64, 2),  # scratch
        ("work_theta", np.float64, 2),
    ],
    align=True,
)
"""Virtual leg of the admittance."""

_SIXTH = 1.0 / 6.0
"""Weight of the first stage of the classical Runge-Kutta method."""


@kernel
def place_shafts(shafts: ShaftsRecord, leg: LegFrameRecord, eta: Vec) -> None:
    """Set the virtual leg at rest at shaft lengths [m], shape [2], in free space."""
    for i in range(2):
        shafts.eta[i] = eta[i]
        shafts.rate[i] = 0.0
        shafts.theta[i] = angle_of(leg.links[i], eta[i])
    _leave(shafts)


@kernel
def _leave(shafts: ShaftsRecord) -> None:
    shafts.touching = 0
    shafts.normal_force = 0.0
    shafts.drag[0] = 0.0
    forget_friction(shafts.anchor)


@kernel
def _slopes(surface: FootSurfaceRecord, leader: int) -> tuple[float, float, float, float]:
    """f', f'', the follower's h, and the way along the surface per motion of the leader."""
    follower = 1 - leader
    h = surface.slope[follower]
    first = -surface.slope[leader] / h
    second = -(surface.bend[2 * leader] + 2.0 * surface.bend[1] * first + surface.bend[2 * follower] * first**2) / h
    return first, second, h, surface.path[leader] + first * surface.path[follower]


@kernel
def _acceleration(shafts: ShaftsRecord, settings: ShaftSettingsRecord, force: Vec, rate: float) -> tuple[float, float]:
    """Acceleration of the leader [m/s^2] and normal force [N] at a speed of the leader, equation (5)."""
    leader, surface = shafts.leader, shafts.surface
    follower = 1 - leader
    first, second, h, path = _slopes(surface, leader)
    if settings.as_printed == 1:
        shifted = force[follower] * surface.lever[follower] / surface.lever[leader]
        a = (force[leader] + shifted + shafts.drag[0] - settings.damping[leader] * rate) / settings.mass[leader]
        moved = settings.mass[follower] * (first * a + second * rate * rate)
        return a, (moved - force[follower]) / h
    f_leader = force[leader] - settings.damping[leader] * rate
    f_follower = force[follower] - settings.damping[follower] * first * rate
    mass = settings.mass[leader] + settings.mass[follower] * first * first
    turned = settings.mass[follower] * first * second * rate * rate
    a = (f_leader + first * f_follower + shafts.drag[0] * path - turned) / mass
    moved = settings.mass[follower] * (first * a + second * rate * rate)
    return a, (moved - f_follower - shafts.drag[0] * surface.path[follower]) / h


@kernel
def _drag(shafts: ShaftsRecord, settings: ShaftSettingsRecord, rule: SurfaceSettingsRecord, dt: float) -> None:
    """Set the friction for this tick: along the surface [N], or as printed along the leader's shaft."""
    rate = shafts.rate[shafts.leader]
    speed = _slopes(shafts.surface, shafts.leader)[3] * rate
    shafts.way[0] += speed * dt
    if settings.as_printed == 1:
        load = shafts.normal_force if rule.friction == SurfaceFriction.COULOMB else 1.0
        shafts.drag[0] = -rule.mu * load * rate
    elif rule.friction == SurfaceFriction.VISCOUS:
        shafts.drag[0] = -rule.mu * speed
    else:
        hayward_armstrong(shafts.way, shafts.normal_force, rule.mu, rule.anchor, shafts.anchor, shafts.drag)


@kernel
def _at(
    shafts: ShaftsRecord,
    leg: LegFrameRecord,
    outline: OutlineRecord,
    settings: ShaftSettingsRecord,
    force: Vec,
    eta: float,
    rate: float,
) -> tuple[float, float, bool]:
    """Acceleration and normal force of equation (5) with the leader at eta, and whether the follower reaches it."""
    shafts.work_eta[shafts.leader] = eta
    reached = follow_surface(leg, outline, shafts.leader, shafts.work_eta, shafts.work_theta, shafts.surface)
    a, normal_force = _acceleration(shafts, settings, force, rate)
    return a, normal_force, reached


@kernel
def _slide(
    shafts: ShaftsRecord,
    leg: LegFrameRecord,
    outline: OutlineRecord,
    settings: ShaftSettingsRecord,
    force: Vec,
    dt: float,
) -> bool:
    """Move the leg along the surface by a tick, Runge-Kutta; False where it slid off what the follower reaches."""
    leader = shafts.leader
    eta, rate = shafts.eta[leader], shafts.rate[leader]
    for i in range(2):
        shafts.work_theta[i] = shafts.theta[i]
    a1, _, on1 = _at(shafts, leg, outline, settings, force, eta, rate)
    r2 = rate + 0.5 * dt * a1
    a2, _, on2 = _at(shafts, leg, outline, settings, force, eta + 0.5 * dt * rate, r2)
    r3 = rate + 0.5 * dt * a2
    a3, _, on3 = _at(shafts, leg, outline, settings, force, eta + 0.5 * dt * r2, r3)
    r4 = rate + dt * a3
    a4, _, on4 = _at(shafts, leg, outline, settings, force, eta + dt * r3, r4)
    eta += dt * _SIXTH * (rate + 2.0 * r2 + 2.0 * r3 + r4)
    rate += dt * _SIXTH * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
    _, normal_force, on5 = _at(shafts, leg, outline, settings, force, eta, rate)
    if not (on1 and on2 and on3 and on4 and on5):
        return False
    shafts.normal_force = normal_force
    for i in range(2):
        shafts.eta[i], shafts.theta[i] = shafts.work_eta[i], shafts.work_theta[i]
    first = _slopes(shafts.surface, leader)[0]
    limit = settings.speed_limit[leader]
    if first != 0.0:
        limit = min(limit, settings.speed_limit[1 - leader] / abs(first))
    shafts.rate[leader] = min(limit, max(-limit, rate))
    shafts.rate[1 - leader] = first * shafts.rate[leader]
    return True


@kernel
def _move_free(shafts: ShaftsRecord, leg: LegFrameRecord, settings: ShaftSettingsRecord, force: Vec, dt: float) -> None:
    """Move both shafts through free space by a tick."""
    for i in range(2):
        mass, damping, friction = settings.mass[i], settings.damping[i], settings.friction[i]
        limit = settings.speed_limit[i]
        shafts.eta[i], shafts.rate[i] = move_shaft(
            shafts.eta[i], shafts.rate[i], force[i], mass, damping, friction, limit, dt
        )
        shafts.theta[i] = angle_of(leg.links[i], shafts.eta[i])


@kernel
def _land(shafts: ShaftsRecord, leg: LegFrameRecord, outline: OutlineRecord, settings: ShaftSettingsRecord) -> None:
    """Begin a contact: the foot on the surface, its velocity projected onto it."""
    leader = 0 if settings.as_printed == 1 else leader_of(shafts.surface)
    follower = 1 - leader
    shafts.leader = leader
    if not follow_surface(leg, outline, leader, shafts.eta, shafts.theta, shafts.surface):
        return
    shafts.touching = 1
    shafts.normal_force = 0.0
    first = _slopes(shafts.surface, leader)[0]
    if settings.as_printed == 0:
        m_1, m_2 = settings.mass[leader], settings.mass[follower]
        momentum = m_1 * shafts.rate[leader] + m_2 * first * shafts.rate[follower]
        shafts.rate[leader] = momentum / (m_1 + m_2 * first * first)
    shafts.rate[follower] = first * shafts.rate[leader]


@kernel
def step_shafts(
    shafts: ShaftsRecord,
    leg: LegFrameRecord,
    outline: OutlineRecord,
    settings: ShaftSettingsRecord,
    rule: SurfaceSettingsRecord,
    solid: bool,
    force: Vec,
    dt: float,
) -> None:
    """Advance the virtual leg by a tick: in free space, at first touch, on the surface, or leaving it.

    Args:
        shafts: SHAFTS record, advanced.
        leg: LEG_FRAME record.
        outline: OUTLINE record.
        settings: SHAFT_SETTINGS record.
        rule: SURFACE_SETTINGS record.
        solid: Whether the object acts; False where the outline has no edges.
        force: F + F_add of both shafts [N], shape [2].
        dt: Tick [s].
    """
    if not solid and shafts.touching == 1:
        _leave(shafts)
    if shafts.touching == 1:
        if settings.as_printed == 0:
            shafts.leader = leader_of(shafts.surface)
        _drag(shafts, settings, rule, dt)
        if _slide(shafts, leg, outline, settings, force, dt):
            if shafts.normal_force <= -rule.hold and settings.as_printed == 0:
                _leave(shafts)
            shafts.normal_force = max(0.0, shafts.normal_force)
            return
        _leave(shafts)
    _move_free(shafts, leg, settings, force, dt)
    if solid:
        find_surface(leg, outline, shafts.theta, shafts.surface)
        approach = shafts.surface.slope[0] * shafts.rate[0] + shafts.surface.slope[1] * shafts.rate[1]
        if shafts.surface.distance < 0.0 and approach < 0.0:
            _land(shafts, leg, outline, settings)
