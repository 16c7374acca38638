"""Progressive codec for triangle meshes."""

from ._lwc import (
    DecodeError,
    Decoder,
    EncodeError,
    Update,
    __version__,
    decode,
    decode_scene,
    descriptors,
    encode,
    info,
)
from ._types import Attribute, Instance, Loss, Mesh, Scene, Stream

__all__ = [
    "Attribute",
    "DecodeError",
    "Decoder",
    "EncodeError",
    "Instance",
    "Loss",
    "Mesh",
    "Scene",
    "Stream",
    "Update",
    "__version__",
    "decode",
    "decode_scene",
    "descriptors",
    "encode",
    "info",
]
