"""The laboratory: speed charted against accuracy, and stability where methods fail."""

__all__: list[str] = []
