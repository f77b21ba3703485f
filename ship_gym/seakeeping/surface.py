"""Gradients of a potential on the hull, from its values on the panels.

Axes and units: see `radiation_diffraction`. Both halves of the hull are used, so that a panel at
the keel has neighbours on either side.
"""

from __future__ import annotations

import dataclasses
from functools import cached_property

import numpy as np
from scipy import sparse

from ship_gym.seakeeping.radiation_diffraction import Flow, HalfHull

_MIRROR = np.array([1.0, -1.0, 1.0])
_SMOOTH = 0.3  # cosine between normals; neighbours beyond it lie around an edge
_SLIVER = 0.1  # of the median area; smaller panels (of a transom) are fitted across edges
_QUADRATIC = 10  # neighbours that a fit with curvature needs
# a fit that multiplies errors by more (at a fine bow) does without curvature
_NOISE = 12.0
# singular values below this share of the largest are dropped; without curvature, where neighbours
# may lie in a line, more of them: the slope across it is then 0
_TINY, _LINE = 1e-3, 0.2


@dataclasses.dataclass(frozen=True)
class Waterline:
    """Edges of panels at z = 0 of both sides.

    Attributes
    ----------
    panel : numpy.ndarray
        Its panel, shape (e,).
    middle : numpy.ndarray
        Midpoint by L, shape (e, 3).
    normal : numpy.ndarray
        Horizontal normal into the water times the edge's length, shape (e, 3).
    """

    panel: np.ndarray
    middle: np.ndarray
    normal: np.ndarray


@dataclasses.dataclass(frozen=True)
class Surface:
    """Both sides of a hull: n panels of the half, then their n mirror images, N = 2 n.

    On every panel a function is fitted by least squares to its neighbours and theirs, by first and
    second derivatives along the tangents, a step along the normal being known from the normal
    velocity.
    """

    half: HalfHull

    @cached_property
    def panels(self) -> np.ndarray:
        """Corners, shape (N, 4, 3)."""
        return np.concatenate([self.half.panels, (self.half.panels * _MIRROR)[:, ::-1]])

    @cached_property
    def centres(self) -> np.ndarray:
        """Centres, shape (N, 3)."""
        return np.concatenate([self.half.centres, self.half.centres * _MIRROR])

    @cached_property
    def normals(self) -> np.ndarray:
        """Unit normals into the water, shape (N, 3)."""
        return np.concatenate([self.half.normals, self.half.normals * _MIRROR])

    @cached_property
    def areas(self) -> np.ndarray:
        """Areas, shape (N,)."""
        return np.tile(self.half.areas, 2)

    @cached_property
    def slivers(self) -> np.ndarray:
        """Panels far smaller than the others, on which values are not resolved, shape (N,)."""
        return self.areas <= _SLIVER * np.median(self.areas)

    @cached_property
    def tangents(self) -> np.ndarray:
        """Two unit tangents of every panel, shape (2, N, 3)."""
        flat = np.abs(self.normals[:, 2]) > 0.95
        axis = np.where(flat[:, None], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
        first = np.cross(self.normals, axis)
        first /= np.linalg.norm(first, axis=1)[:, None]
        return np.stack([first, np.cross(self.normals, first)])

    @cached_property
    def _neighbours(self) -> list[np.ndarray]:
        """Panels that share a corner with a panel, or with one that does."""
        corners: dict[tuple, set[int]] = {}
        for i, key in enumerate(np.round(self.panels * 1e6).astype(np.int64)):
            for corner in key:
                corners.setdefault(tuple(corner), set()).add(i)
        near: list[set[int]] = [set() for _ in self.panels]
        for group in corners.values():
            for i in group:
                near[i] |= group
        rings = (set().union(*(near[j] for j in near[i])) - {i} for i in range(len(near)))
        return [np.array(sorted(ring), dtype=int) for ring in rings]

    @cached_property
    def _fits(self) -> tuple[list[sparse.csr_array], np.ndarray]:
        """Five derivatives a, b, aa, ab, bb as matrices (N, N), and their share (5, N) of f_n."""
        N = len(self.panels)
        rows, columns, values = [], [], []
        normal = np.zeros((5, N))
        for i, ring in enumerate(self._neighbours):
            if not self.slivers[i]:
                ring = ring[self.normals[ring] @ self.normals[i] > _SMOOTH]
            step = self.centres[ring] - self.centres[i]
            fit = _fit(step, self.tangents[:, i], self.areas[ring])
            if self.slivers[i] or len(ring) < _QUADRATIC or _noise(fit, self.areas[i]) > _NOISE:
                fit = _fit(step, self.tangents[:, i], self.areas[ring], curved=False)
            normal[: len(fit), i] = -fit @ (step @ self.normals[i])
            rows.append(np.full(len(ring) + 1, i))
            columns.append(np.append(ring, i))
            full = np.zeros((5, len(ring) + 1))
            full[: len(fit), :-1], full[: len(fit), -1] = fit, -fit.sum(axis=1)
            values.append(full)
        place = np.concatenate(rows), np.concatenate(columns)
        matrices = [
            sparse.csr_array((row, place), shape=(N, N)) for row in np.concatenate(values, axis=1)
        ]
        return matrices, normal

    def both_sides(self, flow: Flow) -> tuple[np.ndarray, np.ndarray]:
        """Potential and normal velocity of a flow on all panels, shape (N,) each."""
        return (
            np.concatenate([flow.even + flow.odd, flow.even - flow.odd]),
            np.concatenate(
                [flow.even_velocity + flow.odd_velocity, flow.even_velocity - flow.odd_velocity]
            ),
        )

    def derivatives(self, values: np.ndarray, normal_velocity: np.ndarray) -> np.ndarray:
        """Derivatives a, b, aa, ab, bb along the tangents, shape (5, N)."""
        matrices, share = self._fits
        return np.stack([m @ values for m in matrices]) + share * normal_velocity

    def gradient(self, derivatives: np.ndarray, normal_velocity: np.ndarray) -> np.ndarray:
        """Velocity on the panels from `derivatives`, shape (N, 3)."""
        a, b = self.tangents
        return (
            derivatives[0][:, None] * a
            + derivatives[1][:, None] * b
            + normal_velocity[:, None] * self.normals
        )

    def second_derivatives(self, gradient: np.ndarray) -> np.ndarray:
        """Symmetric second derivatives of a harmonic function, without trace, shape (N, 3, 3)."""
        along_a, along_b = (m @ gradient for m in self._fits[0][:2])
        a, b, n = *self.tangents, self.normals
        aa, bb = np.sum(along_a * a, axis=1), np.sum(along_b * b, axis=1)
        ab = 0.5 * (np.sum(along_a * b, axis=1) + np.sum(along_b * a, axis=1))
        an, bn = np.sum(along_a * n, axis=1), np.sum(along_b * n, axis=1)
        local = np.array([[aa, ab, an], [ab, bb, bn], [an, bn, -aa - bb]])
        axes = np.stack([a, b, n], axis=1)
        return np.einsum("abi,iax,iby->ixy", local, axes, axes)

    @cached_property
    def waterline(self) -> Waterline:
        """Edges at z = 0 that do not lie in the centre plane."""
        start, end = self.panels, np.roll(self.panels, -1, axis=1)
        at_surface = (np.abs(start[..., 2]) < 1e-9) & (np.abs(end[..., 2]) < 1e-9)
        length = np.linalg.norm(end - start, axis=2)
        centre = (np.abs(start[..., 1]) < 1e-9) & (np.abs(end[..., 1]) < 1e-9)
        panel, edge = np.nonzero(at_surface & (length > 1e-9) & ~centre)
        along = (end - start)[panel, edge]
        normal = np.stack([along[:, 1], -along[:, 0], np.zeros(len(panel))], axis=1)
        side = np.sign(np.sum(normal * self.normals[panel], axis=1))
        return Waterline(
            panel, 0.5 * (start + end)[panel, edge], normal * np.where(side < 0, -1.0, 1.0)[:, None]
        )


def _fit(step, tangents, areas, curved: bool = True) -> np.ndarray:
    """Derivatives a, b (and aa, ab, bb) from the differences to m neighbours, shape (2 or 5, m)."""
    a, b = step @ tangents[0], step @ tangents[1]
    terms = np.stack([a, b, 0.5 * a * a, a * b, 0.5 * b * b] if curved else [a, b], axis=1)
    weight = np.sqrt(areas) / np.linalg.norm(step, axis=1) ** 1.5
    scale = np.linalg.norm(terms, axis=0) + 1e-30
    if not curved:
        scale[:] = scale.max()
    inverse = np.linalg.pinv(terms / scale * weight[:, None], rcond=_TINY if curved else _LINE)
    return inverse * weight / scale[:, None]


def _noise(fit: np.ndarray, area: float) -> float:
    """Error of the slopes along a panel by that of the values."""
    return float(np.abs(fit[:2]).sum(axis=1).max() * np.sqrt(area))
