"""Drawing a scene for a person: picture, figures over it, overlay, quality held in time, stills and films."""

__all__: list[str] = []
