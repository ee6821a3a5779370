"""glTF 2.0 files: read, placed in a world, written."""

__all__: list[str] = []
