"""Rendering for the eye, the hand and the ear; the three know nothing of each other."""

__all__: list[str] = []
