from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    precision: int
    vertices: int
    faces: int
    bytes: int
    end: int

class Info(TypedDict):
    precision: int
    origin: tuple[float, float, float]
    side: float
    levels: int
    total_bytes: int
    passes: list[Pass]

def descriptors() -> list[str]: ...
def encode(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    descriptor: str | None = None,
    quantization: int | None = None,
    levels: int | None = None,
    rings: int | None = None,
    radius: float | None = None,
    growth: float | None = None,
    partition: str | None = None,
    optimize: str | None = None,
    steps_per_edge: float | None = None,
) -> bytes: ...
def decode(
    stream: bytes,
    *,
    level: int | None = None,
    max_memory: int | None = None,
    max_vertices: int | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...
def info(stream: bytes) -> Info | None: ...

class Update:
    kind: str
    level: int
    precision: int
    vertices: int
    faces: int
    end: int
    changed_vertices: tuple[int, int]
    new_faces: tuple[int, int]
    rewritten_faces: list[tuple[int, int]]

class Decoder:
    def __init__(
        self, *, level: int | None = None, max_memory: int | None = None, max_vertices: int | None = None
    ) -> None: ...
    def push(self, piece: bytes) -> list[Update]: ...
    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.uint32]] | None: ...
    def info(self) -> Info | None: ...
    def checksum(self) -> int | None: ...
    @property
    def is_complete(self) -> bool: ...
    @property
    def passes_done(self) -> int: ...
