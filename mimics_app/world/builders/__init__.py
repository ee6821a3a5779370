"""Builders of the models that are shipped: exact functions of a seed, numpy and our own GLB writer alone."""

__all__: list[str] = []
