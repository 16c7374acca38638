from typing import TypedDict

from numpy.typing import ArrayLike

from ._types import (
    Attribute as Attribute,
    Instance as Instance,
    Loss as Loss,
    Mesh as Mesh,
    Scene as Scene,
    Stream as Stream,
)

__version__: str

class DecodeError(ValueError):
    """Why a stream does not decode. ``kind`` is the name of the error in Rust."""

    kind: str

class EncodeError(ValueError):
    """Why a mesh cannot be encoded. ``kind`` is the name of the error in Rust."""

    kind: str

class Pass(TypedDict):
    kind: str
    level: int
    quantization_bits: int
    vertices: int
    faces: int
    bytes: int
    end: int

class AttributeInfo(TypedDict):
    name: str
    semantic: str
    set_index: int
    domain: str
    components: int
    bits: int

class Info(TypedDict):
    quantization_bits: int
    origin: tuple[float, float, float]
    side: float
    step: tuple[float, float, float]
    lattice_origin: tuple[float, float, float] | None
    levels: int
    total_bytes: int
    profile: str
    passes: list[Pass]
    attributes: list[AttributeInfo]
    metadata: dict[str, str]

def descriptors() -> list[str]: ...
def encode(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    attributes: dict[str, Attribute | ArrayLike] | None = None,
    descriptor: str | None = None,
    quantization_bits: int | None = None,
    step: float | tuple[float, float, float] | None = None,
    grid_origin: tuple[float, float, float] | None = None,
    cubic_grid: bool = False,
    levels: int | None = None,
    rings: int | None = None,
    radius: float | None = None,
    growth: float | None = None,
    partition: str | None = None,
    optimize: str | None = None,
    steps_per_edge: float | None = None,
    normal_bits: int | None = None,
    texcoord_bits: int | None = None,
    color_bits: int | None = None,
    generic_bits: int | None = None,
    profile: str | None = None,
    effort: int | None = None,
    lossless: bool = False,
    keep_order: bool = False,
    keep_isolated: bool = False,
    keep_degenerate: bool = False,
    strict: bool = False,
) -> Stream: ...
def decode(
    stream: bytes,
    *,
    level: int | None = None,
    shrinkage_compensation: bool = True,
    max_memory: int | None = None,
    max_vertices: int | None = None,
    max_levels: int | None = None,
    max_work: int | None = None,
) -> Mesh: ...
def decode_scene(
    stream: bytes,
    *,
    level: int | None = None,
    shrinkage_compensation: bool = True,
    max_memory: int | None = None,
    max_vertices: int | None = None,
    max_levels: int | None = None,
    max_work: int | None = None,
) -> Scene: ...
def info(stream: bytes) -> Info | None: ...

class Update:
    kind: str
    level: int
    quantization_bits: int
    vertices: int
    faces: int
    end: int
    changed_vertices: tuple[int, int]
    new_faces: tuple[int, int]
    rewritten_faces: list[tuple[int, int]]

class Decoder:
    def __init__(
        self,
        *,
        level: int | None = None,
        shrinkage_compensation: bool = True,
        max_memory: int | None = None,
        max_vertices: int | None = None,
        max_levels: int | None = None,
        max_work: int | None = None,
    ) -> None: ...
    def push(self, piece: bytes) -> list[Update]: ...
    def mesh(self, *, attributes: bool = True) -> Mesh | None: ...
    def info(self) -> Info | None: ...
    @property
    def losses(self) -> list[Loss]: ...
    def checksum(self) -> int | None: ...
    def attribute_checksum(self) -> int: ...
    @property
    def is_complete(self) -> bool: ...
    @property
    def passes_done(self) -> int: ...
