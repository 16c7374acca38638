"""What goes into an encoder and comes out of a decoder."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(eq=False)
class Attribute:
    """A table of values, and which entry of it each element has.

    ``values``: entries × components (one component: entries), numbers of 8, 16 or 32 bits, float64, or names. Of corners
    also faces × 3 × components. ``indices``: the entry of each element, -1 for none; ``None``: element k has entry k.
    ``domain``: what has a value, ``vertex``, ``corner`` (element 3 f + i is corner i of face f) or ``face``.
    ``semantic``: ``normal``, ``texcoord``, ``color``, ``material``, ``group``, ``object`` or ``generic``. ``set_index``: of
    texture coordinates and colours, which of several. ``normalized``: integers are fractions of the largest of their type.
    """

    values: Any
    domain: str = "vertex"
    semantic: str = "generic"
    set_index: int = 0
    normalized: bool = False
    indices: Any = None

    @classmethod
    def of(cls, values: Any) -> Attribute:
        """An attribute as it is; an array as values of vertices."""
        return values if isinstance(values, cls) else cls(values)

    def elements(self, fill: Any = 0) -> np.ndarray:
        """The value of each element: elements × components (one component: elements); ``fill`` where there is none."""
        values = np.asarray(self.values, dtype=object if self._is_named() else None)
        if values.ndim > 2:
            values = values.reshape(-1, values.shape[-1])
        if self.indices is None:
            return values
        indices = np.asarray(self.indices, dtype=np.int64)
        found = np.full((len(indices), *values.shape[1:]), fill, dtype=values.dtype)
        found[indices >= 0] = values[indices[indices >= 0]]
        return found

    def _is_named(self) -> bool:
        return np.asarray(self.values).dtype.kind in "USO"

    def _table(self) -> list[str] | np.ndarray:
        """Names, or entries × components of a type that a stream holds."""
        if self._is_named():
            return [str(name) for name in np.asarray(self.values, dtype=object).ravel()]
        values = np.asarray(self.values)
        if values.dtype.kind == "b":
            values = values.astype(np.uint8)
        elif values.dtype.kind in "iu" and values.dtype.itemsize > 4:
            low, high = (int(values.min()), int(values.max())) if values.size else (0, 0)
            fitting = [t for t in (np.int32, np.uint32) if np.iinfo(t).min <= low and high <= np.iinfo(t).max]
            if not fitting:
                raise ValueError("integers of attributes have at most 32 bits")
            values = values.astype(fitting[0])
        elif values.dtype.kind == "f" and values.dtype.itemsize not in (4, 8):
            values = values.astype(np.float32 if values.dtype.itemsize < 4 else np.float64)
        elif values.dtype.kind not in "iuf":
            raise ValueError(f"attributes have no values of type {values.dtype}")
        components = values.shape[-1] if values.ndim > 1 else 1
        values = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))
        return values.reshape(values.size // max(components, 1), components)

    def _indices(self) -> np.ndarray | None:
        return None if self.indices is None else np.ascontiguousarray(self.indices, dtype=np.int64).ravel()


@dataclass(frozen=True)
class Loss:
    """One thing that is lost on the way from a mesh to a stream, or from a stream to a mesh. ``str()`` is a sentence."""

    stage: str
    """``reading``, ``encoding``, ``decoding`` or ``writing``."""
    kind: str
    """Such as ``positions-rounded``, ``values-rounded``, ``dropped``, ``reordered`` or ``coarser``."""
    subject: str
    """What: the name of an attribute, or a few words; may be empty."""
    count: int | None
    """Elements concerned, if they were counted."""
    total: int | None
    """Of how many, if known."""
    largest_error: float | None
    """Of positions a distance, of directions an angle in radians, else in the units of the attribute."""
    largest_error_in_edges: float | None
    """Of positions: the largest error of a vertex divided by the mean length of its edges."""
    remedy: str
    """The option of ``lwc`` that keeps it; may be empty."""
    message: str

    def __str__(self) -> str:
        return self.message


class Stream(bytes):
    """The bytes of a stream, with the list of ``losses``: what it does not give back of the mesh."""

    losses: list[Loss]

    def __new__(cls, data: bytes = b"", losses: list[Loss] | None = None) -> Stream:
        stream = super().__new__(cls, data)
        stream.losses = losses or []
        return stream

    def __getnewargs__(self) -> tuple[Any, ...]:
        return bytes(self), self.losses


class Mesh(tuple):
    """Unpacks into ``vertices`` (n × 3, float64) and ``faces`` (m × 3, uint32); has ``attributes`` by name, and a list
    of ``losses``: what it lacks of its stream."""

    vertices: np.ndarray
    faces: np.ndarray
    attributes: dict[str, Attribute]
    losses: list[Loss]

    def __new__(
        cls,
        vertices: np.ndarray,
        faces: np.ndarray,
        attributes: dict[str, Attribute] | None = None,
        losses: list[Loss] | None = None,
    ) -> Mesh:
        mesh = super().__new__(cls, (vertices, faces))
        mesh.vertices, mesh.faces, mesh.attributes = vertices, faces, attributes or {}
        mesh.losses = losses or []
        return mesh

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.vertices, self.faces, self.attributes, self.losses

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} faces, attributes {list(self.attributes)})"


@dataclass(eq=False)
class Instance:
    """A mesh in its place."""

    mesh: int
    """Index of the mesh in its scene."""
    name: str
    transform: np.ndarray
    """4 × 4: from the coordinates of the mesh to those of the scene."""


@dataclass(eq=False)
class Scene:
    """Several meshes, each once and in its own coordinates, and where each of them is."""

    meshes: list[Mesh]
    instances: list[Instance]
    """A mesh may be in several places, or nowhere."""
    materials: str | None = field(default=None, repr=False)
    """How materials look: JSON with the lists of glTF 2.0, ``bufferView`` of an image counting ``images``."""
    images: list[bytes] = field(default_factory=list, repr=False)
    metadata: dict[str, str] = field(default_factory=dict)
    """What else is known of the whole: ``crs.wkt`` is a coordinate reference system."""
