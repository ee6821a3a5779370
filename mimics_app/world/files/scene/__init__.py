"""Scene files: versioned JSON from text to a running world, checked, reloaded and written back."""

__all__: list[str] = []
