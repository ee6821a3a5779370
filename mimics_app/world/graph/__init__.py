"""Nodes of a scene: identities, transforms, tables of what they carry, and the handles on them."""

__all__: list[str] = []
