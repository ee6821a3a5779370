"""Kinds of task: what there is to do in a scene, one module each, behind the protocol of `kind`."""

__all__: list[str] = []
