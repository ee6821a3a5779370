"""What is drawn: chosen, sorted, and sent to the driver."""

__all__: list[str] = []
