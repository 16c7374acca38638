"""Progressive codec for triangle meshes."""

from ._lwc import DecodeError, Decoder, EncodeError, Update, __version__, decode, descriptors, encode, info

__all__ = [
    "DecodeError",
    "Decoder",
    "EncodeError",
    "Update",
    "__version__",
    "decode",
    "descriptors",
    "encode",
    "info",
]
