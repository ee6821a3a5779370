"""Builder of the alley of the guided walk."""

__all__: list[str] = []
