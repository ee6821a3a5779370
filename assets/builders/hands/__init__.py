"""The arms of participants: skinned, with a clip that opens the hand."""

__all__: list[str] = []
