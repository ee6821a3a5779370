"""`mimics view`: a model or a scene to be looked at from all sides, put in its place, and saved."""

__all__: list[str] = []
