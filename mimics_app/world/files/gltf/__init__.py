"""glTF 2.0 files: reader, instances in a world, writer."""

__all__: list[str] = []
