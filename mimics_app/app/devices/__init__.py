"""`mimics devices`: the conformance kit on a device by name, emulated robots and trackers."""

__all__: list[str] = []
