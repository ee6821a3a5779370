"""State of one point of contact from tick to tick, and the codes of its contact changes."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.controller_port import CONTROL_WORK
from mimics_app.contracts.loop.loop_fields import LOOP_FIELDS, MAX_CONTACTS, MAX_JOINTS, state_fields
from mimics_app.rendering.haptic.kernels.acting import ACTING
from mimics_app.rendering.haptic.kernels.closed_region import REGION
from mimics_app.rendering.haptic.kernels.controller_slot import CONTROL
from mimics_app.rendering.haptic.kernels.directions import SPAN
from mimics_app.rendering.haptic.kernels.oscillation import SWING
from mimics_app.rendering.haptic.kernels.passivity import OBSERVER
from mimics_app.rendering.haptic.kernels.tunnels import HOLDING, OWN_TUNNEL
from mimics_app.rendering.haptic.reference.generator import REFERENCE

__all__ = ["CONTACT_BEGAN", "CONTACT_ENDED", "CONTACT_UNCHANGED", "STATE", "new_states"]

CONTACT_UNCHANGED = 0
CONTACT_BEGAN = 1
CONTACT_ENDED = 2

STATE = np.dtype(
    [
        *state_fields(LOOP_FIELDS),  # outputs of the loop: motion, forces, command, margins
        # safety
        ("tick", "i8"),  # ticks done
        ("contacts", "i8"),  # SCENE.contacts as last seen
        ("safety", "i8"),  # SafetyState
        ("resets", "i8"),  # SCENE.resets as last seen
        ("sequence", "i8"),  # SCENE.sequence as last seen
        ("trial", "i8"),  # SCENE.trial as last seen
        ("obstacle_calls", "i8"),  # SCENE.obstacle_calls as last seen
        ("strained_ticks", "i8"),  # ticks in a row with a measured force beyond measured_force_limit
        ("lag", "f8", (3,)),  # way by which a driven device stayed behind its commands, robot frame [m]
        ("refused_ticks", "i8"),  # ticks in a row whose command the device did not take
        ("quiet_ticks", "i8"),  # ticks in a row with the virtual force below ramp_force
        ("answered", "i8"),  # 1 once the device has given data
        ("readable", "i8"),  # 1 while this tick's device data is finite
        ("objects_failed", "i8"),  # 1 where a force or motion of an object is not finite
        ("stale", "i8"),  # 1 while the data is older than stale_warn
        ("age", "f8"),  # of the device data [s]
        ("delay", "f8"),  # from a command to the data that shows it, as last measured [s]
        # what changed in this tick
        ("state_changed", "i8"),
        ("tripped", "i8"),
        ("jumped", "i8"),  # 1: the position moved farther than a hand can
        ("cap_began", "i8"),  # 1: the stiffness cap began to act
        ("limit_began", "i8"),  # 1: the force reached force_limit
        ("stale_began", "i8"),  # 1: the data became older than stale_warn
        ("parameters_taken", "i8"),
        ("gait_changed", "i8"),  # 1: the gait state of the controller is another
        ("contact_change", "i8"),  # CONTACT_... with the tunnel
        ("margin_lost", "i8"),  # 1: a margin fell below 0
        ("reported_margin", "f8"),  # that margin
        ("reported_share", "f8"),  # rendered share of the stiffness where cap_began
        ("reported_force", "f8"),  # wanted where limit_began [N]
        # motion, last good data
        ("dq", "f8", (MAX_JOINTS,)),
        ("f_meas", "f8", (3,)),  # frame of the sensor [N]
        ("buttons", "i8"),
        ("hip", "f8", (3,)),  # robot frame [m]
        ("v", "f8", (3,)),  # robot frame [m/s]
        ("placed", "i8"),  # 1 once last_hip is valid
        ("last_hip", "f8", (3,)),  # last reported position, robot frame [m]
        # forces
        ("f_contact", "f8", (3,)),  # contacts' part of the virtual force, world [N]
        ("f_active", "f8", (3,)),  # its part paid from the energy tank, world [N]
        ("f_rest", "f8", (3,)),  # what is neither: drag and viscosity, world [N]
        ("f_wanted", "f8", (3,)),  # their sum, input of the limiter, world [N]
        ("f_user", "f8", (3,)),  # robot frame [N]
        # contact
        ("in_contact", "i8"),
        ("clear_ticks", "i8"),  # ticks in a row without touching
        # stability
        ("period", "f8"),  # measured [s]
        ("in_touch", "i8"),  # 1 from the begin of a contact until acting.FREE_TIME without one
        ("capped", "i8"),  # 1 while a contact is rendered softer than authored
        ("observer", OBSERVER),  # of the contacts, since they began
        ("warned", "i8"),  # 1 from a lost margin until it is well above 0 again
        ("touched", "i8"),  # 1 once there was a contact: least_margin and least_limit are valid
        ("least_margin", "f8"),  # smallest so far, in the worst direction of all contacts [-]
        ("least_limit", "f8"),  # smallest stable stiffness so far [N/m]
        ("wall_margin", "f8"),  # of the wall of the tunnel that holds the ball, along its normal [-]
        ("wall_touched", "i8"),  # 1 once the wall pushed: least_wall_margin is valid
        ("least_wall_margin", "f8"),  # smallest so far [-]
        ("swing", SWING),  # of an oscillation that the force feeds
        ("swing_reported", "i8"),  # 1: the force began to fade at some point of contact
        ("reported_swing", "f8"),  # its root mean square there [N]
        ("region", REGION),  # of stable contacts, at present
        ("span", SPAN),  # sum of all contacts of this tick
        ("least_energy", "f8"),  # lowest observed energy so far [J]
        # controller
        ("dq_virtual", "f8", (MAX_JOINTS,)),
        ("reference", "f8", (3,)),  # virtual target that draws a force-driven device, robot frame [m]
        ("joint_reference", "f8", (MAX_JOINTS,)),  # the same for the joints of a torque-driven device
        ("reference_state", REFERENCE),  # of the joints: ramps
        ("arrived", "i8"),  # 1 while a controller that drives to a target is there
        ("acting", ACTING),
        ("joint_work", CONTROL_WORK),
        ("control", CONTROL),
        ("work_a", "f8", (3,)),
        ("work_b", "f8", (3,)),
        ("ball_radius_rate", "f8"),  # [m/s]
        ("tunnel", HOLDING),
        ("own_tunnel", OWN_TUNNEL),
    ],
    align=True,
)
"""State of one point of contact; the first also holds that of the device. Zeros are the initial state, OFF."""


def new_states() -> np.ndarray:
    """Initial states of all points of contact, shape [MAX_CONTACTS], dtype STATE."""
    return np.zeros(MAX_CONTACTS, STATE)
