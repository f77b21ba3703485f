"""A disk that is full after so many bytes."""

from __future__ import annotations

import contextlib

import pytest


@pytest.fixture
def limited():
    """Context in which no file of this process grows beyond a size [bytes]."""
    resource = pytest.importorskip("resource")

    @contextlib.contextmanager
    def limit(size: int):
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)

    return limit
