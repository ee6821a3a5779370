"""The gait orthosis Lokomat: simulated, a recording, on a serial line or by UDP."""

from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.devices.device_names import BuiltInDevice

__all__ = ["DEVICE"]

DEVICE = BuiltInDevice(
    __doc__,
    phrase("simulated patient in a gait orthosis"),
    "lokomat_port:build_lokomat",
    address="sim|log:RUN|serial:PORT|udp:HOST:PORT",
    descriptor="lokomat:LOKOMAT",
    optional=True,
    walks=True,
    dynamics="dynamics:lokomat_dynamics",
)
