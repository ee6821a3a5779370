"""Where pictures appear: windows and offscreen contexts, what their drivers can do, and pictures read back."""

__all__: list[str] = []
