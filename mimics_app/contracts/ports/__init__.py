"""What a stage or a plug-in must offer, and how built-in and installed ones are found."""

__all__: list[str] = []
