"""Control of one leg of the orthosis in a tick: pure impedance (D2.1 4.3.2), or admittance and impedance combined.

Both take the same inputs, and command joint torques:

    impedance   tau = load compensation + guidance + J^T F of a hard object; the loop adds that of soft ones
    combined    rod force -> virtual masses (3), on a hard object's surface by (4) and (5) -> q_d -> position control

The guidance enters the combined control as a force F_imp on the shafts (1), as do the forces of soft objects; a hard
object is rigid there, and a spring in the impedance control.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import Vec
from mimics_app.rendering.haptic.control.lokomat.constrained_shafts import (
    SHAFTS,
    SURFACE_SETTINGS,
    place_shafts,
    step_shafts,
)
from mimics_app.rendering.haptic.control.lokomat.contact_impulse import effective_mass
from mimics_app.rendering.haptic.control.lokomat.encoder_speed import ENCODER_SPEED, encoder_speed
from mimics_app.rendering.haptic.control.lokomat.foot_constraint import FOOT_SURFACE, LEG_FRAME, find_surface
from mimics_app.rendering.haptic.control.lokomat.foot_contact import FOOT_CONTACT, FOOT_SETTINGS, push_foot
from mimics_app.rendering.haptic.control.lokomat.guidance_force import GUIDANCE_SETTINGS, guide_joints
from mimics_app.rendering.haptic.control.lokomat.position_control import (
    POSITION_SETTINGS,
    driven_mass,
    foot_stiffness,
    position_torques,
)
from mimics_app.rendering.haptic.control.lokomat.sagittal_outline import OUTLINE
from mimics_app.rendering.haptic.control.lokomat.shaft_admittance import SHAFT_SETTINGS, measured_force
from mimics_app.rendering.haptic.kernels.leg_kinematics import leg_jacobian, place_foot
from mimics_app.rendering.haptic.kernels.lokomat.linkage import eta_of, lever
from mimics_app.rendering.haptic.kernels.two_link import LINKS, weight

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import (
        LegFrameRecord,
        LegInputRecord,
        LegSettingsRecord,
        LegStateRecord,
        LoadSettingsRecord,
    )

__all__ = ["LEG_INPUT", "LEG_SETTINGS", "LEG_STATE", "control_combined", "control_impedance", "force_in_play"]


# Compensation of weight and friction of the orthosis: the zero impedance mode of D2.1 4.3.1.
#
# A drive holds the weight of the leg's part of the orthosis, and pushes along with the motion by a share of its own
# friction. Coulomb friction grows linearly up to a speed: a step at standstill would chatter on the encoder's steps. A
# share below 1 keeps the leg from running away by itself.

LOAD_SETTINGS = np.dtype(
    [
        ("links", np.float64, LINKS),  # the orthosis alone (`two_link`)
        ("weight", np.float64),  # share of its weight that the drives carry, 0-1
        ("friction", np.float64),  # share of their friction that they compensate, 0-1
        ("coulomb", np.float64, 2),  # friction of motion of hip and knee drive along the shaft [N]
        ("viscous", np.float64, 2),  # [N s/m]
        ("slow", np.float64),  # shaft speed up to which the Coulomb part grows [m/s] > 0
    ],
    align=True,
)


@kernel
def load_torques(settings: LoadSettingsRecord, leg: LegFrameRecord, q: Vec, dq: Vec, tau: Vec) -> None:
    """Set the torques [N m] that carry weight and friction.

    Args:
        settings: LOAD_SETTINGS record.
        leg: LEG_FRAME record.
        q: Joint angles [rad], shape [2].
        dq: Their velocities [rad/s].
        tau: Out: torques, shape [2].
    """
    tau[0], tau[1] = weight(settings.links, q[0], q[1])
    for i in range(2):
        arm = lever(leg.links[i], q[i])
        speed = arm * dq[i]
        push = settings.coulomb[i] * min(1.0, max(-1.0, speed / settings.slow)) + settings.viscous[i] * speed
        tau[i] = settings.weight * tau[i] + settings.friction * arm * push


LEG_SETTINGS = np.dtype(
    [
        ("frame", LEG_FRAME),
        ("outline", OUTLINE),  # of the hard object; without edges there is none
        ("foot", FOOT_SETTINGS),  # of impedance control
        ("shafts", SHAFT_SETTINGS),  # of combined control, like the four below
        ("surface", SURFACE_SETTINGS),
        ("play", np.float64, 2),  # backlash of hip and knee drive along the shaft [m]
        ("encoder", np.float64),  # step of the encoders [rad]; 0: the speed is that of the device
        ("position", POSITION_SETTINGS),
        ("load", LOAD_SETTINGS),
        ("guidance", GUIDANCE_SETTINGS),
        ("wall_force", np.float64),  # largest force of a hard object on the foot [N]
    ],
    align=True,
)
"""Numbers of one leg that do not change from tick to tick."""

LEG_INPUT = np.dtype(
    [
        ("q", np.float64, 2),  # hip and knee angle [rad]
        ("dq", np.float64, 2),  # [rad/s]
        ("torque", np.float64, 2),  # of the leg on its drives, rod force times lever [N m]
        ("q_ref", np.float64, 2),  # reference [rad]
        ("dq_ref", np.float64, 2),  # [rad/s]
        ("ddq_ref", np.float64, 2),  # [rad/s^2]
        ("guidance", np.float64, 2),  # share 0-1 of each joint
        ("force", np.float64, 2),  # of soft objects on the foot (x, z) [N]
        ("hard", np.int64),  # 1: the hard object acts
        ("dt", np.float64),  # [s]
    ],
    align=True,
)

LEG_STATE = np.dtype(
    [
        ("started", np.int64),  # 1: combined control acts
        ("shafts", SHAFTS),
        ("encoders", ENCODER_SPEED, 2),  # of hip and knee, for the position control
        ("contact", FOOT_CONTACT),
        ("surface", FOOT_SURFACE),  # at the measured foot
        ("motor", np.float64, 2),  # force of the motors on the shafts in the last tick [N]
        ("tau", np.float64, 2),  # commanded torques [N m]
        ("x_real", np.float64, 2),  # measured foot (x, z) [m]
        ("x_des", np.float64, 2),  # foot of the admittance, or measured foot outside of the object (x, z) [m]
        ("f_x", np.float64, 2),  # force of the hard object on the foot (x, z) [N]
        ("guided", np.float64, 2),  # torques of the guidance [N m]
        ("speed", np.float64, 2),  # scratch, like all below
        ("force", np.float64, 2),
        ("more", np.float64, 2),
        ("wish_rate", np.float64, 2),
        ("rate", np.float64, 2),
        ("place", np.float64, 3),
    ],
    align=True,
)
"""State and outputs of the control of one leg; zeros are the initial state."""


_LEASH = 0.1
"""Distance of the virtual leg from the leg at each joint that no tracking reaches [rad]: beyond, limits or an empty
energy tank keep the drives from following, and a virtual leg that ran away would pull at the person when they can."""


@kernel
def _find_foot(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set place and speed of the measured foot, and the object's surface at it."""
    place_foot(settings.frame.geometry, 0, now.q, state.place)
    state.x_real[0], state.x_real[1] = state.place[0], state.place[2]
    x1, x2, z1, z2 = leg_jacobian(settings.frame.geometry, now.q)
    state.speed[0] = x1 * now.dq[0] + x2 * now.dq[1]
    state.speed[1] = z1 * now.dq[0] + z2 * now.dq[1]
    for i in range(2):
        state.x_des[i] = state.x_real[i]
        state.f_x[i] = 0.0
    if settings.outline.count > 0:
        find_surface(settings.frame, settings.outline, now.q, state.surface)


@kernel
def _guide(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set the torques of the guidance."""
    guide_joints(settings.guidance, now.guidance, now.q, now.dq, now.q_ref, now.dq_ref, now.ddq_ref, state.guided)


@kernel
def _limit_wall(settings: LegSettingsRecord, state: LegStateRecord) -> None:
    """Limit the force of the hard object, keeping its direction."""
    square = state.f_x[0] * state.f_x[0] + state.f_x[1] * state.f_x[1]
    if square > settings.wall_force * settings.wall_force:
        share = settings.wall_force / square**0.5
        state.f_x[0] *= share
        state.f_x[1] *= share


@kernel
def control_impedance(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set state.tau by pure impedance control.

    Args:
        settings: LEG_SETTINGS record.
        now: LEG_INPUT record of this tick.
        state: LEG_STATE record, advanced.
    """
    state.started = 0  # combined control that follows begins where the leg is then
    _find_foot(settings, now, state)
    load_torques(settings.load, settings.frame, now.q, now.dq, state.tau)
    if now.hard == 1 and settings.outline.count > 0:
        m11, m12, m22 = driven_mass(settings.position, settings.frame, now.q)
        n_x, n_z = state.surface.normal[0], state.surface.normal[1]
        x1, x2, z1, z2 = leg_jacobian(settings.frame.geometry, now.q)
        mass = effective_mass(n_x * x1 + n_z * z1, n_x * x2 + n_z * z2, m11, m12, m22)
        depth = -state.surface.distance
        push_foot(state.contact, settings.foot, depth, state.surface.normal, state.speed, mass, now.dt, state.f_x)
        _limit_wall(settings, state)
        inside = max(0.0, depth)
        state.x_des[0] += inside * n_x
        state.x_des[1] += inside * n_z
        state.tau[0] += x1 * state.f_x[0] + z1 * state.f_x[1]
        state.tau[1] += x2 * state.f_x[0] + z2 * state.f_x[1]
    _guide(settings, now, state)
    for joint in range(2):
        state.tau[joint] += state.guided[joint]


@kernel
def _start(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Begin where the leg is, at rest: no jump of the torque."""
    for joint in range(2):
        state.more[joint] = eta_of(settings.frame.links[joint], now.q[joint])
        state.encoders[joint].count = 0
        state.motor[joint] = 0.0
    place_shafts(state.shafts, settings.frame, state.more)
    state.started = 1


@kernel
def _shaft_forces(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set state.force to F + F_add of both shafts [N]: rod force without known weight, guidance, soft objects."""
    x1, x2, z1, z2 = leg_jacobian(settings.frame.geometry, now.q)
    state.more[0] = x1 * now.force[0] + z1 * now.force[1]
    state.more[1] = x2 * now.force[0] + z2 * now.force[1]
    g1, g2 = weight(settings.load.links, now.q[0], now.q[1])
    _guide(settings, now, state)
    for joint in range(2):
        arm = lever(settings.frame.links[joint], now.q[joint])
        known = -settings.load.weight * (g1 if joint == 0 else g2) / arm
        sensor = -settings.shafts.sensor_sign * now.torque[joint] / arm
        added = (state.guided[joint] + state.more[joint]) / arm
        state.force[joint] = measured_force(settings.shafts, joint, sensor, state.motor[joint], known) + added


@kernel
def _keep_near(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Let the virtual leg go no farther from the leg than drives at their limits could ever draw it back from."""
    far = False
    for joint in range(2):
        away = state.shafts.theta[joint] - now.q[joint]
        far = far or abs(away) > _LEASH
        state.more[joint] = eta_of(settings.frame.links[joint], now.q[joint] + min(_LEASH, max(-_LEASH, away)))
    if far:
        place_shafts(state.shafts, settings.frame, state.more)


# Force of a motor whose rod is unloaded: its spindle lies in the play between two flanks.
#
# The position control scales its torques with the mass of the leg, but what moves in the play is the spindle alone: a
# twentieth of it, which no sensor sees. One that breaks loose there is driven by what static friction exceeds sliding
# friction, and hits the other flank with up to sqrt(2 (F_s - F_c) play k), k the stiffness of the rod: 210 N; 130 N
# and 11 N m at the hip with the Stribeck curve of this machine, again and again. So the motor only carries the sliding
# friction of an unloaded drive, which stays where it is, or slides on, until the leg itself comes to a flank; and more
# where the leg is farther from its place than the play explains.

_UNLOADED = 6.0
"""Force of a rod without load, beyond the noise of its sensor [N]."""

_RETURN = 4e4
"""Force per distance of the shaft from its place beyond the play [N/m]: it breaks loose at less than a millimetre."""


@kernel
def force_in_play(motor: float, rod: float, away: float, play: float, friction: float) -> float:
    """Force of a motor on its shaft [N]: the wanted one, bounded while the rod is unloaded.

    Args:
        motor: Wanted force [N].
        rod: Measured force in the rod [N].
        away: Distance of the shaft from its place [m].
        play: Backlash along the shaft [m]; 0: the rod is always loaded.
        friction: Sliding friction that is carried [N].
    """
    if play == 0.0 or abs(rod) > _UNLOADED:
        return motor
    most = friction + _RETURN * max(0.0, abs(away) - play)
    return min(most, max(-most, motor))


@kernel
def _follow(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set the torques by which the leg follows the virtual one."""
    for joint in range(2):
        arm = lever(settings.frame.links[joint], state.shafts.theta[joint])
        state.wish_rate[joint] = state.shafts.rate[joint] / arm
        state.rate[joint] = now.dq[joint]
        if settings.encoder > 0.0:
            state.rate[joint] = encoder_speed(state.encoders[joint], now.q[joint], settings.encoder, now.dt)
        state.more[joint] = 0.0  # q_d'' would close a loop over the rod sensor, of the gain M_leg / m_V
    position_torques(
        settings.position,
        settings.frame,
        now.q,
        state.rate,
        state.shafts.theta,
        state.wish_rate,
        state.more,
        state.tau,
    )
    for joint in range(2):
        arm = lever(settings.frame.links[joint], now.q[joint])
        away = arm * (state.shafts.theta[joint] - now.q[joint])
        friction = settings.load.friction * settings.load.coulomb[joint]
        wish, rod = state.tau[joint] / arm, now.torque[joint] / arm
        state.motor[joint] = force_in_play(wish, rod, away, settings.play[joint], friction)
        state.tau[joint] = arm * state.motor[joint]


@kernel
def control_combined(settings: LegSettingsRecord, now: LegInputRecord, state: LegStateRecord) -> None:
    """Set state.tau by combined admittance and impedance control; arguments as `control_impedance`."""
    _find_foot(settings, now, state)
    if state.started == 0:
        _start(settings, now, state)
    _shaft_forces(settings, now, state)
    step_shafts(
        state.shafts,
        settings.frame,
        settings.outline,
        settings.shafts,
        settings.surface,
        now.hard == 1 and settings.outline.count > 0,
        state.force,
        now.dt,
    )
    _keep_near(settings, now, state)
    _follow(settings, now, state)
    place_foot(settings.frame.geometry, 0, state.shafts.theta, state.place)
    state.x_des[0], state.x_des[1] = state.place[0], state.place[2]
    if state.shafts.touching == 1:
        n_x, n_z = state.shafts.surface.normal[0], state.shafts.surface.normal[1]
        gap = n_x * (state.x_des[0] - state.x_real[0]) + n_z * (state.x_des[1] - state.x_real[1])
        push = foot_stiffness(settings.position, settings.frame, now.q, n_x, n_z) * gap
        state.f_x[0], state.f_x[1] = push * n_x, push * n_z
