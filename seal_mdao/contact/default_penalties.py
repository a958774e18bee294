"""Default contact penalties from the modulus of the body and the distance of its particles.

``seals.adjusted_penalties`` adapts them to their error (``seals.penalty_error``).

A contact of penalty w gives way by p/w under a pressure p, a body of size L and modulus E by about
p L/E. With w = 300 E/h the contact is some hundred times stiffer than the cells beside it.
"""

from dataclasses import replace

import numpy as np

from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.rkpm.cells import beside

RIGID_RATIOS = {"normal_penalty": 300.0, "tangent_penalty": 10.0}
"""Penalties over E/h of contact with a rigid body."""
SELF_RATIOS = {"normal_penalty": 30.0, "tangent_penalty": 3.0}
"""The same of a body with itself, both of whose sides give way."""


def completed(definition, elastic, body, particles: np.ndarray):
    """Return a contact whose penalties that are None are set in terms of E/h at its points.

    Parameters
    ----------
    definition : TermDefinition
        Without an open penalty it is returned itself.
    elastic : ElasticBody
    body : Body
    particles : ndarray, shape (n, 2)
        Undeformed, mm.
    """
    law = getattr(definition, "law", None)
    if law is None or not law.open_penalties:
        return definition
    stiffness = stiffness_at(definition.where, elastic, body, particles)
    ratios = SELF_RATIOS if isinstance(definition, SelfContact) else RIGID_RATIOS
    # two significant digits, for whoever reads them
    chosen = {name: float(f"{ratios[name] * stiffness:.2g}") for name in law.open_penalties}
    return replace(definition, law=law._replace(**chosen))


def stiffness_at(where, elastic, body, particles: np.ndarray) -> float:
    """Compute E/h of the stiffest material at some points from their mean tributary length, kPa/mm.

    E = 3 G, that of the undeformed incompressible material.
    """
    modulus = [3.0 * region.material.shear_modulus for region in elastic.regions]
    touched = beside(body.cells, where.points.anchors)
    stiffest = elastic.per_cell(modulus, len(body.cells))[touched].max()
    return float(stiffest / where.lengths(particles).mean())
