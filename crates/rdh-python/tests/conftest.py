"""Scenes that several tests use."""

import pytest
from making import soup

import rdh


@pytest.fixture(scope="session")
def small() -> rdh.Scene:
    """A scene of 200 triangles."""
    return rdh.Scene(*soup(200, 1))


@pytest.fixture(scope="session")
def quarter() -> rdh.Scene:
    """A part of a town."""
    return rdh.load("quarter")
