"""Devices of the haptic loop behind `contracts.loop.loop_ports.DevicePlugin`."""

__all__: list[str] = []
