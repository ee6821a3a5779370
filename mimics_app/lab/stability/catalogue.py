"""The experiments: a module `sNN_noun` holds one `EXPERIMENT` and is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.lab.experiment import Experiment

__all__ = ["NAMES", "load_experiment", "load_experiments"]


def _s1() -> Experiment:
    from mimics_app.lab.stability.s01_integrators import EXPERIMENT

    return EXPERIMENT


def _s2() -> Experiment:
    from mimics_app.lab.stability.s02_free_mass import EXPERIMENT

    return EXPERIMENT


def _s3() -> Experiment:
    from mimics_app.lab.stability.s03_stiffest_wall import EXPERIMENT

    return EXPERIMENT


def _s3r() -> Experiment:
    from mimics_app.lab.stability.s03_wall_rate import EXPERIMENT

    return EXPERIMENT


def _s4() -> Experiment:
    from mimics_app.lab.stability.s04_quantised_wall import EXPERIMENT

    return EXPERIMENT


def _s5() -> Experiment:
    from mimics_app.lab.stability.s05_energy_leak import EXPERIMENT

    return EXPERIMENT


def _s5b() -> Experiment:
    from mimics_app.lab.stability.s05b_energy_taken_back import EXPERIMENT

    return EXPERIMENT


def _s6() -> Experiment:
    from mimics_app.lab.stability.s06_virtual_mass import EXPERIMENT

    return EXPERIMENT


def _s6b() -> Experiment:
    from mimics_app.lab.stability.s06_virtual_damping import EXPERIMENT

    return EXPERIMENT


def _s7() -> Experiment:
    from mimics_app.lab.stability.s07_joint_pd import EXPERIMENT

    return EXPERIMENT


def _s8() -> Experiment:
    from mimics_app.lab.stability.s08_printed_equations import EXPERIMENT

    return EXPERIMENT


def _s9() -> Experiment:
    from mimics_app.lab.stability.s09_admittance_forms import EXPERIMENT

    return EXPERIMENT


def _s10() -> Experiment:
    from mimics_app.lab.stability.s10_corner_slide import EXPERIMENT

    return EXPERIMENT


def _s10b() -> Experiment:
    from mimics_app.lab.stability.s10b_rounded_edge import EXPERIMENT

    return EXPERIMENT


def _s11() -> Experiment:
    from mimics_app.lab.stability.s11_held_object import EXPERIMENT

    return EXPERIMENT


def _s11b() -> Experiment:
    from mimics_app.lab.stability.s11b_lugre_step import EXPERIMENT

    return EXPERIMENT


def _s12() -> Experiment:
    from mimics_app.lab.stability.s12_rotation_drift import EXPERIMENT

    return EXPERIMENT


def _s12b() -> Experiment:
    from mimics_app.lab.stability.s12b_free_top import EXPERIMENT

    return EXPERIMENT


def _s13() -> Experiment:
    from mimics_app.lab.stability.s13_mass_ratio import EXPERIMENT

    return EXPERIMENT


def _s13b() -> Experiment:
    from mimics_app.lab.stability.s13b_stack import EXPERIMENT

    return EXPERIMENT


def _s14() -> Experiment:
    from mimics_app.lab.stability.s14_tunnel_frame import EXPERIMENT

    return EXPERIMENT


def _s14b() -> Experiment:
    from mimics_app.lab.stability.s14b_closest_point import EXPERIMENT

    return EXPERIMENT


def _s15() -> Experiment:
    from mimics_app.lab.stability.s15_late_ticks import EXPERIMENT

    return EXPERIMENT


def _s15b() -> Experiment:
    from mimics_app.lab.stability.s15b_dropped_ticks import EXPERIMENT

    return EXPERIMENT


def _s16() -> Experiment:
    from mimics_app.lab.stability.s16_contact_directions import EXPERIMENT

    return EXPERIMENT


_EXPERIMENTS: dict[str, Callable[[], Experiment]] = {
    "S1": _s1,
    "S2": _s2,
    "S3": _s3,
    "S3R": _s3r,
    "S4": _s4,
    "S5": _s5,
    "S5B": _s5b,
    "S6": _s6,
    "S6B": _s6b,
    "S7": _s7,
    "S8": _s8,
    "S9": _s9,
    "S10": _s10,
    "S10B": _s10b,
    "S11": _s11,
    "S11B": _s11b,
    "S12": _s12,
    "S12B": _s12b,
    "S13": _s13,
    "S13B": _s13b,
    "S14": _s14,
    "S14B": _s14b,
    "S15": _s15,
    "S15B": _s15b,
    "S16": _s16,
}
"""By name, in the order of their numbers."""

NAMES = tuple(_EXPERIMENTS)


def load_experiment(name: str) -> Experiment:
    """The experiment of a name like "S3" (any case).

    Raises:
        UsageError: There is none.
    """
    key = name.upper()
    if key not in _EXPERIMENTS:
        raise UsageError(f'there is no experiment "{name}"', nearest(key, NAMES))
    return _EXPERIMENTS[key]()


def load_experiments(names: tuple[str, ...] = ()) -> list[Experiment]:
    """The experiments of these names, or all of them."""
    return [load_experiment(name) for name in names or NAMES]
