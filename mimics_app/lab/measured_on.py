"""The machine of a measurement of the laboratory, with the driver that drew where pictures were measured."""

from __future__ import annotations

import sys

from mimics_app.contracts.system.machine import Machine, describe_machine

__all__ = ["measured_on"]


def measured_on() -> Machine:
    """Return the machine of this process, with the version of Mesa if anything has been drawn in it."""
    if "moderngl" not in sys.modules:
        return describe_machine()
    from mimics_app.rendering.visual.surfaces.headless import mesa_version

    return describe_machine(mesa_version())
