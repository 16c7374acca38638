"""The package that is installed, against the golden streams and numpy."""

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

import lwc

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "format" / "golden"


def recorded():
    """Checksums of the passes of each stream."""
    found = {}
    for line in (GOLDEN / "checksums.txt").read_text().splitlines():
        if not line.startswith("#") and " whole " not in line:
            name, *_, checksum = line.split()
            found.setdefault(name, []).append(int(checksum, 16))
    return found


def torus(along=48, around=24):
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, along, False), np.linspace(0, 2 * np.pi, around, False), indexing="ij")
    vertices = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    c, d = (i + 1) % along * around + j, (i + 1) % along * around + (j + 1) % around
    faces = np.concatenate([np.stack([a, c, d], -1).reshape(-1, 3), np.stack([a, d, b], -1).reshape(-1, 3)])
    return vertices, faces


def test_the_installed_package_is_tested():
    assert "site-packages" in Path(lwc.__file__).parts


@pytest.mark.parametrize("name, checksums", recorded().items())
def test_golden_streams_have_their_checksums_after_each_pass(name, checksums):
    stream = (GOLDEN / name).read_bytes()
    decoder = lwc.Decoder()
    found, vertices, faces = [], 0, 0
    for at in range(len(stream)):
        for update in decoder.push(stream[at : at + 1]):
            found.append(decoder.checksum())
            assert update.vertices >= vertices and update.faces >= faces
            vertices, faces = update.vertices, update.faces
    assert found == checksums
    assert decoder.is_complete and decoder.passes_done == len(checksums)


def test_a_mesh_comes_back_on_the_grid():
    vertices, faces = torus()
    stream = lwc.encode(vertices, faces, descriptor="harris3d", quantization=14)
    assert isinstance(stream, bytes)
    back, triangles = lwc.decode(stream)
    assert back.shape == vertices.shape and back.dtype == np.float64
    assert triangles.shape == faces.shape and triangles.dtype == np.uint32
    step = lwc.info(stream)["side"] / (2**14 - 1)

    distances = np.linalg.norm(vertices[:, None] - back[None], axis=-1)
    nearest = distances.argmin(1)
    assert len(set(nearest)) == len(vertices)
    assert distances.min(1).max() <= step
    wanted = {tuple(np.roll(t, -t.argmin())) for t in nearest[faces]}
    assert wanted == {tuple(np.roll(t, -t.argmin())) for t in triangles.astype(np.int64)}


def test_levels_and_prefixes_are_coarser_meshes():
    stream = lwc.encode(*torus())
    passes = lwc.info(stream)["passes"]
    level = 3
    vertices, faces = lwc.decode(stream, level=level)
    assert len(vertices) == max(p["vertices"] for p in passes if p["level"] == level)
    early, _ = lwc.decode(stream[: len(stream) // 3])
    assert 0 < len(early) < len(torus()[0])


def test_updates_name_what_changed():
    stream = lwc.encode(*torus())
    decoder = lwc.Decoder()
    vertices, faces = np.zeros((0, 3)), np.zeros((0, 3), np.uint32)
    for at in range(0, len(stream), 64):
        for update in decoder.push(stream[at : at + 64]):
            new, triangles = decoder.mesh()
            if len(new) != update.vertices:
                continue  # A later update of the same piece will name the rest.
            vertices = np.concatenate([vertices, np.zeros((len(new) - len(vertices), 3))])
            faces = np.concatenate([faces, np.zeros((len(triangles) - len(faces), 3), np.uint32)])
            for array, source, ranges in [
                (vertices, new, [update.changed_vertices]),
                (faces, triangles, [update.new_faces, *update.rewritten_faces]),
            ]:
                for first, end in ranges:
                    array[first:end] = source[first:end]
    assert np.array_equal(vertices, decoder.mesh()[0])
    assert np.array_equal(faces, decoder.mesh()[1])


def test_arrays_of_any_type_and_layout_are_taken():
    vertices, faces = torus(12, 8)
    expected = lwc.encode(vertices, faces)
    assert lwc.encode(np.asfortranarray(vertices), faces.astype(np.uint32)) == expected
    assert lwc.encode(vertices.tolist(), faces.astype(np.int16)) == expected
    assert lwc.encode(np.repeat(vertices, 2, axis=0)[::2], faces) == expected
    for name in lwc.descriptors():
        assert lwc.decode(lwc.encode(vertices, faces, descriptor=name))[0].shape == vertices.shape


@pytest.mark.parametrize(
    "call, kind",
    [
        (lambda: lwc.decode(b"solid cube"), "NotAStream"),
        (lambda: lwc.decode(lwc.encode(*torus())[:20]), "NoMesh"),
        (lambda: lwc.decode(lwc.encode(*torus()), max_vertices=3), "Limit"),
        (lambda: lwc.decode(lwc.encode(*torus())[:-1] + b"\0"), "Checksum"),
        (lambda: lwc.encode(*torus(), quantization=31), "Option"),
        (lambda: lwc.encode(*torus(), descriptor="magic"), "Option"),
        (lambda: lwc.encode([[0, 0, 0]], [[0, 0, 0]]), "NoTriangles"),
        (lambda: lwc.encode([[0, 0, 0]], [[0, 0, 1]]), "IndexOutOfRange"),
        (lambda: lwc.encode([[0, 0, 0]], [[0, 0, -1]]), "IndexOutOfRange"),
        (lambda: lwc.encode([[0, np.nan, 0]], [[0, 0, 0]]), "NotFinite"),
    ],
)
def test_errors_have_the_kinds_of_the_library(call, kind):
    with pytest.raises((lwc.DecodeError, lwc.EncodeError)) as caught:
        call()
    assert caught.value.kind == kind
    assert isinstance(caught.value, ValueError)


def test_shapes_are_checked():
    with pytest.raises(ValueError, match="3 columns"):
        lwc.encode(np.zeros((4, 2)), [[0, 1, 2]])


def test_the_last_good_mesh_survives_damage():
    stream = bytearray(lwc.encode(*torus()))
    stream[-1] ^= 1
    decoder = lwc.Decoder()
    with pytest.raises(lwc.DecodeError):
        decoder.push(bytes(stream))
    vertices, faces = decoder.mesh()
    assert len(vertices) > 0 and faces.max() < len(vertices)
    with pytest.raises(lwc.DecodeError) as caught:
        decoder.push(b"more")
    assert caught.value.kind == "Failed"


def test_the_example_with_trimesh_runs(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["with_trimesh.py"])
    runpy.run_path(str(Path(__file__).parents[1] / "examples" / "with_trimesh.py"), run_name="__main__")
    assert "volume" in capsys.readouterr().out
