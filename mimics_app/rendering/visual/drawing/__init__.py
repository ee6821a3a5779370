"""The draw list: culled, sorted, and submitted to the driver."""

__all__: list[str] = []
