"""Walls on rays have the smaller error where they are touched between their particles."""

import pytest

from verification.file_errors import force_error, forces
from verification.ray_bulb import COMPARED, limit, ray_bulb


@pytest.mark.long
def test_contact_between_the_particles_has_the_smaller_error(figure):
    exact, apart = limit()
    errors = {
        points: [
            force_error(forces(ray_bulb(rays, 4, "engineering", points)), exact)
            for rays in (24, 48, 72)
        ]
        for points in COMPARED
    }
    figure("bulb on rays: contact of both kinds on the finest wall", apart, 2e-3)
    assert all(a < b for a, b in zip(errors["edges"], errors["particles"], strict=True))
    for found in errors.values():
        assert found == sorted(found, reverse=True)
