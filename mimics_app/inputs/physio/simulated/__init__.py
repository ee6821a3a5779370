"""A simulated person's body: what is latent in one module, the raw signals in another. Import submodules by name."""

__all__: list[str] = []
