"""The pictured ship is a closed solid of the right size, the right way round."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from ship_gym.recording import scene
from ship_gym.recording.hull_shape import (
    box_mesh,
    deck_outline,
    flat_shaded,
    hull_mesh,
    smooth_shaded,
    superstructure_mesh,
)

SIZES = [(230.0, 32.2, 10.8), (3.0464, 0.4265, 0.1431), (320.0, 58.0, 20.8)]
SHIP = scene.ShipShape(L=230.0, B=32.2, d=10.8, A_R=115.0, D_P=7.9)


def solids():
    for sizes in SIZES:
        yield hull_mesh(*sizes)
        yield superstructure_mesh(*sizes)
    yield box_mesh((0.0, -1.0, 2.0), (1.0, 3.0, 5.0))
    yield scene.propeller_mesh(SHIP)[1:]


@pytest.mark.parametrize("mesh", list(solids()))
def test_closed_with_outward_normals(mesh):
    vertices, triangles = mesh
    edges = Counter(map(tuple, triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).tolist()))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)  # two triangles, wound alike
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(faces, axis=1).min() > 0.0
    assert np.einsum("ij,ij->", corners[:, 0], faces) > 0.0  # six times the volume


@pytest.mark.parametrize(("L", "B", "d"), SIZES)
def test_hull_extents_and_bow(L, B, d):
    vertices, _ = hull_mesh(L, B, d)
    x, y, z = vertices.T
    assert (x.min(), x.max()) == pytest.approx((-L / 2, L / 2))
    assert (y.min(), y.max()) == pytest.approx((-B / 2, B / 2))
    assert z.max() == pytest.approx(d)
    assert -1.2 * d < z.min() < -0.5 * d
    assert np.all(y[x > 0.4999 * L] == 0.0)  # pointed at +x
    assert np.ptp(y[x < -0.4999 * L]) > 0.5 * B  # a transom at -x


@pytest.mark.parametrize("shape", [hull_mesh, superstructure_mesh])
def test_starboard_mirrors_port(shape):
    vertices, triangles = shape(*SIZES[0])
    mirrored = vertices * [1.0, -1.0, 1.0] + 0.0
    assert {*map(tuple, vertices + 0.0)} == {*map(tuple, mirrored)}
    if shape is hull_mesh:  # also the triangles, seen as sets of corners
        faces = {frozenset(map(tuple, corners)) for corners in (vertices + 0.0)[triangles]}
        assert faces == {frozenset(map(tuple, corners)) for corners in mirrored[triangles]}


def test_hull_volume_is_ship_like():
    vertices, triangles = hull_mesh(*SIZES[0])
    wet = vertices.copy()
    wet[:, 2] = np.maximum(wet[:, 2], 0.0)
    corners = wet[triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    assert 0.55 < volume / np.prod(SIZES[0]) < 0.85  # block coefficient


def test_flat_shading_keeps_the_triangles():
    mesh = hull_mesh(*SIZES[0])
    vertices, triangles, normals = flat_shaded(*mesh)
    assert np.array_equal(vertices[triangles], mesh[0][mesh[1]])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    sides = np.abs(normals[:, 1]) > 0.5
    assert np.all(normals[sides, 1] * vertices[sides, 1] >= 0.0)  # y faces away from the centre


def test_sizes_must_be_positive():
    with pytest.raises(ValueError, match="B = -1"):
        hull_mesh(100.0, -1.0, 5.0)


def test_deck_outline_is_closed_with_the_bow_ahead():
    outline = deck_outline(*SIZES[0])
    assert np.array_equal(outline[0], outline[-1])
    assert outline[np.argmax(outline[:, 0])] == pytest.approx([115.0, 0.0])


def test_smooth_shading_keeps_the_surface_and_its_paint():
    vertices, _, normals = flat_shaded(*hull_mesh(*SIZES[0]))
    paint = scene.hull_colors(vertices, normals)
    shared, triangles, means, colors = smooth_shaded(vertices, normals, paint)
    corners = triangles.ravel()
    assert len(shared) < 0.4 * len(vertices)
    assert shared[corners] == pytest.approx(vertices)
    assert (colors[corners] == paint).all()
    assert np.linalg.norm(means, axis=1) == pytest.approx(1.0)
    assert np.einsum("ij,ij->i", means[corners], normals).min() > 0.5  # of one side
