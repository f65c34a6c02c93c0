"""Tessera compresses 4D textures: arrays of u, v, s, t and channels.

    import tessera

    with tessera.open("scene.tess") as texture:  # a path, a URL, bytes or a file object
        part = texture[0:64, 0:64, 3, 4]         # reads only the tiles that it touches
    tessera.encode(array, "out.tess", psnr=40)

u and v are the places of a surface or the columns and rows of a picture; s and t are directions, or
the columns and rows of a grid of cameras. All functions may be called from several threads at once.
"""
from . import _library
from ._array import TexelArray
from ._description import Description
from ._encode import EncodeReport, encode, encode_bytes
from ._texture import Level, Texture, open

__version__: str = _library.version().decode()
__all__ = ["Description", "EncodeReport", "Level", "TexelArray", "Texture", "encode",
           "encode_bytes", "open"]
