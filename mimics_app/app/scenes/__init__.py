"""Reading and checking of scenes, and the choice of their scenarios."""

__all__: list[str] = []
