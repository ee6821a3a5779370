"""Descriptors of the devices that come with the product, and what a scene's robot makes of them."""

__all__: list[str] = []
