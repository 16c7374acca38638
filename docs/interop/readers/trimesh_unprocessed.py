"""trimesh with `process=False, maintain_order=True`."""

from readers.trimesh_default import read as read_default


def read(path):
    return read_default(path, process=False, maintain_order=True)
