"""Built-in devices: a module each, named like the device, with `DEVICE`; what builds one is imported on request."""

__all__: list[str] = []
