"""Half an O-ring in its groove, and a gasket glued to its base; a lid presses, then a fluid comes."""

from dataclasses import replace

import numpy as np

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.measures.contact_pressure import PeakPressure
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.file.build import boundaries_of
from seal_mdao.seals.file.edge_tables import FluidTable
from seal_mdao.seals.outline.contours import Arc, Contour, Line, Outline
from seal_mdao.seals.outline.offset_fields import OffsetDesign
from seal_mdao.seals.outline.outline_seal import BodyModel, outline_seal

RADIUS, WALL, CLEAR = 3.0, 3.2, 1e-3
RUBBER = sm.MooneyRivlin(500.0, 125.0, 400_000.0)
SHEAR_MODULUS = 1250.0
PENALTY = 1e5


def _lid(top, squeeze, close, steps, law):
    """Comes down by ``squeeze``, a parameter, and stays."""
    down = Stage(close, (0.0, -squeeze), rates={"squeeze": (0.0, -1.0, 0.0)})
    motion = staged_motion([down, Stage(steps)], start=(0.0, top + CLEAR))
    return _flat("lid", motion, law)


def _flat(name, motion, law):
    """The contact of the seal with a flat profile."""
    shape = GivenShape(flat_profile())
    return lambda section: RigidContact(
        name, section.contact_points(("seal",)), shape, motion, law, f"{name}_"
    )


def _seal(outline, spacing, pressure, close, steps, contacts, standard, end="end", **more):
    fluid = FluidTable(edges=("seal",), end=end, pressure=1.0, steps=steps)
    seal = outline_seal(
        *boundaries_of(outline, spacing), RUBBER, n_steps=close + steps,
        contributions=[*contacts, fluid.on], designs=[OffsetDesign(("seal",), 4)], **more,
    )  # fmt: skip
    seal = replace(seal, standard=standard, newton=sm.NewtonOptions(tolerance=1e-12))
    return seal.with_parameters({"fluid_pressure": pressure})


def ring(pressure, *, squeeze=0.45, close=6, steps=8, spacing=0.4, axis=None):
    """The upper half of an O-ring between lids and before a wall; the fluid comes from the left.
    ``axis``: distance of the middle from the axis of a body of revolution."""
    middle = axis or 0.0
    outline = Outline(Contour((
        Arc((middle, 0.0), RADIUS, 0.0, np.pi, "seal"),
        Line((middle - RADIUS, 0.0), (middle + RADIUS, 0.0), "middle"),
    )))  # fmt: skip
    law = ContactLaw(PENALTY, 1e-2 * PENALTY, 0.1, True)
    beside = staged_motion([Stage(close + steps)], start=(middle + WALL, 0.0), angle=-90.0)
    wall = _flat("wall", beside, law)
    return _seal(
        outline, spacing, pressure, close, steps,
        [_lid(RADIUS, squeeze, close, steps, law), wall],
        (PeakPressure("lid"), Reaction("lid", name="on_lid"), Reaction("wall", name="on_wall")),
        supports={"middle": (1,)}, model=BodyModel(axis is not None),
    )  # fmt: skip


def gasket(pressure, *, squeeze=0.2, friction=0.1, close=4, steps=20, spacing=0.4, end="end"):
    """Half a lens, its flat side glued; the fluid comes from the left, its end."""
    outline = Outline(Contour((
        Arc.through((RADIUS, 0.0), (0.0, 2.0), (-RADIUS, 0.0), "seal"),
        Line((-RADIUS, 0.0), (RADIUS, 0.0), "base"),
    )))  # fmt: skip
    law = ContactLaw(PENALTY, 1e-2 * PENALTY, friction, True)
    return _seal(
        outline, spacing, pressure, close, steps, [_lid(2.0, squeeze, close, steps, law)],
        (BlowOffPressure("fluid"),), end, supports={"base": (0, 1)},
    )  # fmt: skip


def peak(result, step):
    """Highest contact pressure on the lid after a nominal step, kPa."""
    gap = result.response("lid", result.path.nominal_steps[step]).gap
    return PENALTY * float(np.maximum(-gap, 0.0).max())


def states(result):
    """Stick, slip and open points of all profiles at all steps."""
    labels = [term.label for term in result.path.problem.terms if hasattr(term, "motion")]
    return np.hstack([[r.branch for r in result.path.responses(label)] for label in labels])


def quotient(seal, names, way, measures, sequence):
    """Central difference of fourth order along ``way`` (offsets, then the parameters ``names``) on the
    same contact sequence, as far as that is given."""
    p, values = seal.n_offsets, []
    for share in (-2, -1, 1, 2):
        scalars = {
            name: seal.scalars[name].value + share * own
            for name, own in zip(names, way[p:], strict=True)
        }
        result = sm.analyze(seal, share * way[:p], scalars)
        assert np.array_equal(states(result)[: len(sequence)], sequence)
        values.append(np.concatenate([result.value(measure) for measure in measures]))
    return np.array([1, -8, 8, -1]) @ values / 12


def steps_of(seal, names):
    """What counts as one: 1 mm of an offset, the parameters' own values."""
    return np.array(
        [1.0] * seal.n_offsets + [abs(seal.scalars[name].value) or 1.0 for name in names]
    )
