"""The visual renderer: contexts, views, passes, heads-up display, headless pictures."""

__all__: list[str] = []
