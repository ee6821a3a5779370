"""Image files of scenes and textures of glTF files: PNG and JPEG, size checked before decoding."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.world.content.materials.material import Filter, TextureData, Wrap
from mimics_app.world.files.gltf.buffers import GltfBuffers, data_uri
from mimics_app.world.files.gltf.gltf_document import GltfSource

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["GltfImages", "PictureFault", "read_picture"]

_MAX_SIDE = 8192
"""Maximum width and height of an image [px]."""

_FORMATS = ("PNG", "JPEG")
_WRAPS: dict[int, Wrap] = {33071: "clamp", 33648: "mirror", 10497: "repeat"}
_NEAREST, _LINEAR = (9728, 9984, 9986), 9729


class PictureFault(ValueError):
    """Fault of an image or sound file, in words."""


def read_picture(stream: IO[bytes]) -> NDArray[np.uint8]:
    """Decode a PNG or JPEG to RGBA, uint8 [height, width, 4].

    Raises:
        PictureFault: it is another format, larger than 8192 x 8192, or damaged.
    """
    from PIL import Image, UnidentifiedImageError

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)
        try:
            with Image.open(stream, formats=_FORMATS) as picture:
                return _decoded(picture)
        except PictureFault:
            raise
        except Image.DecompressionBombError:
            raise PictureFault(f"has far more pixels than {_MAX_SIDE} x {_MAX_SIDE}") from None
        except (OSError, ValueError, SyntaxError) as error:
            text = "is neither PNG nor JPEG" if isinstance(error, UnidentifiedImageError) else f"is damaged: {error}"
            raise PictureFault(text) from None


def _decoded(picture: Image.Image) -> NDArray[np.uint8]:
    width, height = picture.size
    if max(width, height) > _MAX_SIDE:
        raise PictureFault(f"{width} x {height} pixels are more than {_MAX_SIDE} x {_MAX_SIDE}")
    if picture.mode.startswith("I"):  # 16 bits a channel; convert() would clip instead of scale
        grey = (np.asarray(picture) >> 8).astype(np.uint8)
        return np.dstack([grey, grey, grey, np.full_like(grey, 255)])
    return np.array(picture.convert("RGBA"), np.uint8)


class GltfImages:
    """Reader of textures by index, decoded on demand."""

    def __init__(self, source: GltfSource, buffers: GltfBuffers) -> None:
        self._source = source
        self._buffers = buffers
        self._pictures: dict[int, NDArray[np.uint8]] = {}
        self.textures: dict[str, TextureData] = {}

    def texture(self, index: object, pointer: str) -> str:
        """Decode a texture and return its key in `textures`; with `without_pictures` a broken one is only noted."""
        source = self._source
        texture = source.item("textures", index, pointer)
        key = f"texture{index}"
        if key not in self.textures:
            place = f"/textures/{index}"
            if "source" not in texture:
                source.fail(place, "has no PNG or JPEG image")
            try:
                pixels = self._picture(texture["source"], f"{place}/source")
            except SceneError as error:
                if not source.without_pictures:
                    raise
                for issue in error.issues:
                    source.note(str(issue))
                return key
            wrap, kind = self._sampler(texture, place)
            self.textures[key] = TextureData(pixels, True, wrap, kind)
        return key

    def check_files(self) -> None:
        """Report every missing image file, used or not, unless `without_pictures` is set."""
        if self._source.without_pictures:
            return
        for i, image in enumerate(self._source.table("images")):
            uri = image.get("uri")
            if isinstance(uri, str) and uri[:5].lower() != "data:":
                with self._source.collecting():
                    self._source.external(uri, f"/images/{i}/uri")

    def _picture(self, index: object, pointer: str) -> NDArray[np.uint8]:
        source = self._source
        image = source.item("images", index, pointer)
        place = f"/images/{index}"
        number = cast(int, index)
        if number not in self._pictures:
            try:
                with self._open(image, place) as stream:
                    pixels = read_picture(stream)
            except PictureFault as fault:
                source.fail(place, str(fault))
            except OSError as error:
                source.fail(place, f"cannot be read: {error.strerror}")
            source.take(pixels.size, place)
            self._pictures[number] = pixels
        return self._pictures[number]

    def _open(self, image: dict[str, Any], place: str) -> IO[bytes]:
        source = self._source
        if "bufferView" in image:
            return io.BytesIO(self._buffers.view(image["bufferView"], f"{place}/bufferView")[0])
        if "uri" not in image:
            source.fail(place, "has neither a uri nor a bufferView")
        uri = source.text(image, "uri", place)
        if uri[:5].lower() == "data:":
            return io.BytesIO(data_uri(source, uri, f"{place}/uri"))
        path: Path = source.external(uri, f"{place}/uri")
        return open_regular(path)

    def _sampler(self, texture: dict[str, Any], place: str) -> tuple[tuple[Wrap, Wrap], Filter]:
        source = self._source
        if "sampler" not in texture:
            return ("repeat", "repeat"), "trilinear"
        sampler = source.item("samplers", texture["sampler"], f"{place}/sampler")
        where = f"/samplers/{texture['sampler']}"
        wraps = []
        for key in ("wrapS", "wrapT"):
            code = source.whole(sampler, key, where, 10497)
            if code not in _WRAPS:
                source.fail(f"{where}/{key}", f"{code} is not a wrap mode")
            wraps.append(_WRAPS[code])
        minify = source.whole(sampler, "minFilter", where, 9987)
        kind: Filter = "nearest" if minify in _NEAREST else "linear" if minify == _LINEAR else "trilinear"
        return (wraps[0], wraps[1]), kind
