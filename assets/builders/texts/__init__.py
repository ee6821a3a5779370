"""Catalogues of the texts that a person sees, in each language."""

__all__: list[str] = []
