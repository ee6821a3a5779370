"""Soccer in the street, as a kind of task."""

__all__: list[str] = []
