"""Force of a motor whose rod is unloaded: its spindle lies in the play between two flanks.

The position control scales its torques with the mass of the leg, but what moves in the play is the spindle alone: a
twentieth of it, which no sensor sees. One that breaks loose there is driven by what static friction exceeds sliding
friction, and hits the other flank with sqrt(2 (F_s - F_c) play k), k the stiffness of the rod: 210 N and 18 N m at the
hip of this machine, again and again. So the motor only carries the sliding friction of an unloaded drive, which stays
where it is, or slides on, until the leg itself comes to a flank; and more where the leg is farther from its place than
the play explains.
"""

from __future__ import annotations

from mimics_app.compiled.kernel import kernel

__all__ = ["force_in_play"]

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
