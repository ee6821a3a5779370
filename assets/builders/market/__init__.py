"""The toy market of the pick and place scene, as large as the HapticMaster's workspace."""

__all__: list[str] = []
