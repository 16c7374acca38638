"""The package that is installed, against the golden streams and numpy."""

import ctypes
import os
import pickle
import platform
import runpy
import signal
import sys
import threading
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
        if not line.startswith("#") and " whole " not in line and " shown " not in line:
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
    stream = lwc.encode(vertices, faces, descriptor="harris3d", quantization_bits=14)
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


def test_tiles_on_one_lattice_share_their_border():
    vertices, faces = torus()
    lattice = {"step": (0.003, 0.01, 0.02), "grid_origin": (100.1, 0.0, -7.0)}
    left = lwc.decode(lwc.encode(vertices, faces, **lattice))
    stream = lwc.encode(vertices * [1, 1, -1], faces[:, ::-1], **lattice)
    info = lwc.info(stream)
    assert info["step"] == lattice["step"] and info["lattice_origin"] == lattice["grid_origin"]
    assert lwc.info(lwc.encode(vertices, faces))["lattice_origin"] is None
    border = lambda mesh: sorted(map(tuple, mesh[0][abs(mesh[0][:, 2]) < 1e-2]))
    assert len(border(left)) == 96 and border(left) == border(lwc.decode(stream))
    assert lwc.info(lwc.encode(vertices, faces, step=0.5))["step"] == (0.5, 0.5, 0.5)


def test_grids_that_cannot_be_are_refused():
    for keywords, error in [
        ({"step": 1e-12}, lwc.EncodeError),
        ({"step": -1.0}, lwc.EncodeError),
        ({"step": (1.0, 2.0)}, (TypeError, ValueError)),
        ({"grid_origin": (0.0, 0.0, 0.0)}, TypeError),
        ({"step": 1.0, "cubic_grid": True}, TypeError),
    ]:
        with pytest.raises(error):
            lwc.encode(*torus(), **keywords)


def test_levels_and_prefixes_are_coarser_meshes():
    stream = lwc.encode(*torus())
    passes = lwc.info(stream)["passes"]
    level = 3
    vertices, faces = lwc.decode(stream, level=level)
    assert len(vertices) == max(p["vertices"] for p in passes if p["level"] == level)
    lazy, _ = lwc.decode(stream, level=level, shrinkage_compensation=False)
    assert lazy.shape == vertices.shape and not np.array_equal(lazy, vertices)
    assert np.array_equal(lwc.decode(stream, shrinkage_compensation=False).vertices, lwc.decode(stream).vertices)
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
        (lambda: lwc.encode(*torus(), quantization_bits=31), "Option"),
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


def square():
    """Two triangles with a seam along their common edge."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.array([[0, 0], [1, 0], [1, 1], [0.5, 0.5], [0.75, 0.25]], np.float32)
    return vertices, faces, lwc.Attribute(uv, "corner", "texcoord", set_index=2, indices=[0, 1, 2, 3, 4, -1])


def test_attributes_of_every_domain_come_back():
    vertices, faces, uv = square()
    attributes = {
        "heat": [1.5, 2.5, 3.5, 4.5],
        "rgb": lwc.Attribute(np.arange(12, dtype=np.uint8).reshape(4, 3), semantic="color", normalized=True),
        "uv": uv,
        "part": lwc.Attribute(["left", "right"], "face", "group"),
        "number": lwc.Attribute(np.array([-7, 70000], np.int64), "face"),
        "n": lwc.Attribute(np.tile([0, 0, 1.0], (2, 3, 1)), "corner", "normal"),
    }
    stream = lwc.encode(vertices, faces, attributes=attributes, lossless=True, keep_order=True, texcoord_bits=16)
    mesh = lwc.decode(stream)
    assert np.array_equal(mesh.vertices, vertices) and np.array_equal(mesh.faces, faces)
    assert list(mesh.attributes) == list(attributes)
    found = mesh.attributes
    assert found["heat"].elements().shape == (4,) and found["heat"].domain == "vertex"
    assert np.allclose(found["heat"].elements(), attributes["heat"], atol=1e-3)
    assert found["rgb"].values.dtype == np.uint8 and (found["rgb"].semantic, found["rgb"].normalized) == ("color", True)
    assert np.array_equal(found["rgb"].elements(), attributes["rgb"].values)
    assert (found["uv"].semantic, found["uv"].set_index, found["uv"].values.dtype) == ("texcoord", 2, np.float32)
    assert np.allclose(found["uv"].elements(-1), uv.elements(-1), atol=1e-4)
    assert list(found["uv"].indices[-1:]) == [-1] and found["uv"].elements(-1)[5, 0] == -1
    assert list(found["part"].elements()) == ["left", "right"]
    assert found["number"].values.dtype == np.int32 and list(found["number"].elements()) == [-7, 70000]
    assert np.array_equal(found["n"].elements(), np.tile([0, 0, 1.0], (6, 1)))
    assert [a["name"] for a in lwc.info(stream)["attributes"]] == list(attributes)


def test_attributes_are_there_at_every_level():
    vertices, faces = torus()
    colour = ((np.sin(3 * vertices) + 1) * 120).astype(np.uint8)
    stream = lwc.encode(vertices, faces, attributes={"c": lwc.Attribute(colour, semantic="color")})
    decoder = lwc.Decoder()
    for at in range(0, len(stream), 500):
        if decoder.push(stream[at : at + 500]):
            mesh = decoder.mesh()
            assert mesh.attributes["c"].elements().shape == mesh.vertices.shape
    assert decoder.mesh(attributes=False).attributes == {}
    early = lwc.decode(stream, level=2)
    assert early.attributes["c"].elements().shape == early.vertices.shape
    # Each vertex has the colour of the nearest one of the original, exactly.
    whole = lwc.decode(stream)
    nearest = np.linalg.norm(vertices[:, None] - whole.vertices[None], axis=-1).argmin(1)
    assert np.array_equal(whole.attributes["c"].elements()[nearest], colour)


def test_options_reach_the_encoder():
    vertices, faces = torus()
    usual = lwc.encode(vertices, faces, descriptor=None)
    assert lwc.info(lwc.encode(vertices, faces, profile="fast"))["profile"] == "fast"
    assert lwc.encode(vertices, faces, effort=0) != usual
    loose = np.concatenate([vertices, [[9, 9, 9]]])
    assert len(lwc.decode(lwc.encode(loose, faces, keep_isolated=True)).vertices) == len(loose)
    degenerate = np.concatenate([faces, [[0, 0, 1]]])
    assert len(lwc.decode(lwc.encode(vertices, degenerate, keep_degenerate=True)).faces) == len(degenerate)
    kept = lwc.decode(lwc.encode(vertices, faces, lossless=True, keep_order=True))
    assert np.array_equal(kept.vertices, vertices) and np.array_equal(kept.faces, faces)
    with pytest.raises(TypeError, match="unexpected keyword argument 'quality'"):
        lwc.encode(vertices, faces, quality=3)


@pytest.mark.parametrize(
    "attribute, kind",
    [
        (lwc.Attribute([1, 2, 3]), "Attribute"),
        (lwc.Attribute([1.0], indices=[0, 0, 0, 1]), "Attribute"),
        (lwc.Attribute([1.0], indices=[0, 0, 0, -2]), "Attribute"),
        (lwc.Attribute([1, 2, 3, 2**40]), None),
        (lwc.Attribute([1, 2, 3, 4], "edge"), None),
        (lwc.Attribute([1, 2, 3, 4], semantic="taste"), None),
        (lwc.Attribute([1j, 2, 3, 4]), None),
    ],
)
def test_attributes_that_fit_nothing_are_refused(attribute, kind):
    vertices, faces, _ = square()
    with pytest.raises(ValueError) as caught:
        lwc.encode(vertices, faces, attributes={"a": attribute})
    assert getattr(caught.value, "kind", None) == kind


def recorded_attributes():
    found = {}
    for line in (GOLDEN / "attributes.txt").read_text().splitlines():
        name, number, checksum = line.split()
        if number != "end":
            found.setdefault(name, []).append(int(checksum, 16))
    return found


@pytest.mark.parametrize("name, checksums", recorded_attributes().items())
def test_attributes_of_golden_streams_have_their_checksums(name, checksums):
    stream = (GOLDEN / name).read_bytes()
    decoder, at, found = lwc.Decoder(), 0, []
    for entry in lwc.info(stream)["passes"]:
        decoder.push(stream[at : entry["end"]])
        at = entry["end"]
        found.append(decoder.attribute_checksum())
    assert found == checksums


def test_a_scene_has_its_meshes_in_their_places():
    scene = lwc.decode_scene((GOLDEN / "scene.lwc").read_bytes())
    assert [len(mesh.faces) for mesh in scene.meshes] == [4, 20]
    assert all(mesh.faces.max() == len(mesh.vertices) - 1 for mesh in scene.meshes)
    # The second one has the exponent −2 in the stream.
    assert np.ptp(scene.meshes[1].vertices, axis=0).min() > 6
    assert [(i.mesh, i.name) for i in scene.instances] == [(0, ""), (1, "Baum"), (1, "turned"), (0, "exact")]
    assert np.array_equal(scene.instances[0].transform, np.eye(4))
    assert np.array_equal(scene.instances[1].transform[:, 3], [2.5, 0, 0, 1])
    assert '"north"' in scene.materials and scene.images == [b"\1\2\3"]
    assert set(scene.meshes[0].attributes) == {"usemtl"}


def test_a_mesh_alone_is_a_scene_of_one_instance():
    stream = lwc.encode(*torus(), attributes={"x": torus()[0][:, 0]})
    scene = lwc.decode_scene(stream, level=3)
    assert len(scene.meshes) == len(scene.instances) == 1
    assert np.array_equal(scene.meshes[0].vertices, lwc.decode(stream, level=3).vertices)
    assert list(scene.meshes[0].attributes) == ["x"] and scene.materials is None


def test_the_example_with_trimesh_runs(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["with_trimesh.py"])
    runpy.run_path(str(Path(__file__).parents[1] / "examples" / "with_trimesh.py"), run_name="__main__")
    assert "volume" in capsys.readouterr().out


def test_levels_are_limited():
    stream = lwc.encode(*grid(40))
    levels = lwc.info(stream)["levels"]
    assert levels > 2
    for decode in [lwc.decode, lwc.decode_scene, lambda stream, **limits: lwc.Decoder(**limits).push(stream)]:
        decode(stream, max_levels=levels)
        with pytest.raises(lwc.DecodeError) as caught:
            decode(stream, max_levels=levels - 1)
        assert caught.value.kind == "Limit"


def test_work_is_limited():
    stream = lwc.encode(*grid(40))
    for decode in [lwc.decode, lwc.decode_scene, lambda stream, **limits: lwc.Decoder(**limits).push(stream)]:
        decode(stream, max_work=10**7)
        with pytest.raises(lwc.DecodeError, match="work") as caught:
            decode(stream, max_work=100)
        assert caught.value.kind == "Limit"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs glibc")
def test_another_rounding_mode_is_no_damage():
    """Libraries that are loaded may change it for the whole thread."""
    stream = lwc.encode(*grid(9))
    libm = ctypes.CDLL("libm.so.6")
    nearest = libm.fegetround()
    upwards = {"x86_64": 0x800, "i686": 0x800, "aarch64": 0x400000}.get(platform.machine())
    if upwards is None:
        pytest.skip("another processor")

    def kind_of(call):
        libm.fesetround(upwards)
        try:
            call()
        except (lwc.DecodeError, lwc.EncodeError) as error:
            return error.kind
        finally:
            libm.fesetround(nearest)

    decoder = lwc.Decoder()
    assert kind_of(lambda: lwc.decode(stream)) == "FloatingPoint"
    assert kind_of(lambda: decoder.push(stream)) == "FloatingPoint"
    assert lwc.decode(stream).faces.shape == (128, 3)


def test_ctrl_c_ends_encode():
    # A shell ignores it for what it starts in the background, and so does Python then.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    vertices, faces = grid(700)
    before = lwc.encode(*grid(10))
    interrupt = threading.Timer(0.5, os.kill, [os.getpid(), signal.SIGINT])
    interrupt.start()
    with pytest.raises(KeyboardInterrupt):
        # Half a million vertices, many times over: the signal comes in time.
        for _ in range(1000):
            lwc.encode(vertices, faces, optimize="size", effort=9)
    interrupt.join()
    assert lwc.encode(*grid(10)) == before


def test_a_handler_that_does_not_raise_does_not_end_encode():
    seen = []
    old = signal.signal(signal.SIGINT, lambda number, frame: seen.append(number))
    try:
        os.kill(os.getpid(), signal.SIGINT)
        assert lwc.decode(lwc.encode(*grid(30))).vertices.shape == (900, 3)
    finally:
        signal.signal(signal.SIGINT, old)
    assert seen == [signal.SIGINT]


def grid(n):
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    vertices = np.stack([i, j, np.sin(0.3 * i) * np.cos(0.2 * j)], axis=-1).reshape(-1, 3).astype(float)
    a = (i[:-1, :-1] * n + j[:-1, :-1]).ravel()
    faces = np.concatenate([np.stack([a, a + n, a + n + 1], 1), np.stack([a, a + n + 1, a + 1], 1)])
    return vertices, faces


def test_losses_are_told_of_streams_and_meshes():
    vertices, faces = torus()
    heat = np.linspace(0.0, 1.0, len(vertices)) ** 2
    stream = lwc.encode(vertices, faces, attributes={"heat": heat})
    assert isinstance(stream, bytes) and pickle.loads(pickle.dumps(stream)).losses == stream.losses
    losses = {loss.kind: loss for loss in stream.losses}
    rounded = losses["values-rounded"]
    assert (rounded.stage, rounded.subject, rounded.total) == ("encoding", "heat", len(vertices))
    assert 0 < rounded.largest_error < 1 / 4000
    assert "reordered" in losses and str(losses["reordered"]) == losses["reordered"].message

    assert lwc.decode(stream).losses == []
    coarse = lwc.decode(stream, level=1)
    assert [loss.kind for loss in coarse.losses] == ["coarser"]
    decoder = lwc.Decoder()
    decoder.push(stream[: len(stream) // 2])
    assert [loss.kind for loss in decoder.losses] == ["coarser"]


def test_strict_allows_no_loss():
    vertices, faces = torus()
    with pytest.raises(lwc.EncodeError, match="another order") as error:
        lwc.encode(vertices, faces, strict=True)
    assert error.value.kind == "Lossy"
    stream = lwc.encode(vertices, faces, strict=True, lossless=True, keep_order=True)
    assert stream.losses == []
    assert np.array_equal(lwc.decode(stream).vertices, vertices)
