"""Canyon: rim, layered walls, talus, river, parapet, the beam over it, and a bird."""

__all__: list[str] = []
