"""Devices that can be plugged into the loop, all behind `contracts.loop_ports.DevicePlugin`."""

__all__: list[str] = []
