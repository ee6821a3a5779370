"""`mimics view`: inspect a model or a scene from all sides, move its entities, and save it."""

__all__: list[str] = []
