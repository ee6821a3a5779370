"""Walk over a canyon, as a kind of task."""

__all__: list[str] = []
