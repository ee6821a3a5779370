"""Pictures of billboards and decals."""

__all__: list[str] = []
