"""Export of a seal file's section, contact and motion to Abaqus, for comparison.

Lengths are in mm, stresses in kPa and the thickness is 1 mm, so forces are in mN per mm, which is N/m. A
ring has axisymmetric elements, and forces in mN.
"""

import re
from itertools import combinations_with_replacement, pairwise
from pathlib import Path

import numpy as np

from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.friction_law import FrictionLaw
from seal_mdao.errors import SealFileError
from seal_mdao.export.abaqus_materials import element_type, material_lines
from seal_mdao.export.abaqus_mesh import QuadraticMesh, quadratic_mesh
from seal_mdao.export.abaqus_profiles import has_cubic, surface_lines
from seal_mdao.geometry.motion import BEFORE
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.profiles import contacts, moved_edges, self_contacts

PER_LINE = 16
"""Numbers in a line of a set."""
LEAST_INCREMENT = 1e-6
MOST_INCREMENTS = 10_000


def require_exportable(file: SealFile) -> None:
    """Raise an error for a file with a material that Abaqus does not have, or with names that differ
    only in what Abaqus does not distinguish.

    Raises
    ------
    SealFileError
    """
    for name, law in file.materials.items():
        try:
            material_lines(law)
        except ValueError as error:
            raise SealFileError(f"{file.path}: [material.{name}]: {error}") from None
    profiles = [own.name for own in file.profiles]
    every = {
        "edges": file.section.outline.edge_names,
        "profiles": profiles,
        "materials": file.materials,
    }
    for kind, names in every.items():
        # Abaqus joins sets of the same name
        first = {}
        for name in names:
            other = first.setdefault(name_of(name), name)
            if other != name:
                raise SealFileError(
                    f"{file.path}: the {kind} {other!r} and {name!r} have the same name "
                    f"{name_of(name)} in Abaqus; rename one of them"
                )


def write_abaqus(file: SealFile, seal: OutlineSeal, path: Path) -> list[str]:
    """Write the nominal seal of a file as an input file of Abaqus/Standard.

    The cells between particles are divided into quadratic triangles; edges are sets of nodes, rigid
    profiles analytical surfaces with a reference node at their pivot, stages of their motion steps.

    Parameters
    ----------
    file : SealFile
    seal : OutlineSeal
        That of the file.
    path : Path

    Returns
    -------
    list of str
        What is not exported, also written as comments.

    Raises
    ------
    SealFileError
        As of ``require_exportable``.
    """
    require_exportable(file)
    mesh = quadratic_mesh(seal.nominal_particles, seal.body.cells, seal.parts)
    left_out = not_exported(file, seal)
    kind = "ring, forces in mN" if seal.body.axisymmetric else "thickness 1 mm, forces in N/m"
    lines = [
        "*HEADING",
        f"Seal of {file.path.name}: mm, kPa, {kind}",
        *(f"** NOT EXPORTED: {text}" for text in left_out),
        *_mesh_lines(file, seal, mesh), *_material_lines(seal, mesh), *_profile_lines(file, seal, mesh),
        *_self_contact_lines(file, seal, mesh), *_fixed_lines(file), *_step_lines(file, seal),
    ]  # fmt: skip
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return left_out


def not_exported(file: SealFile, seal: OutlineSeal) -> list[str]:
    """List the parts of a seal file that the input file does not contain."""
    found = [f"[[cavity]] of hole {own.hole}: trapped air" for own in file.cavities]
    found += [f"[[fluid]] {own.name!r}: fluid pressure" for own in file.fluids]
    found += [f"[[term]] {own.name!r}" for own in file.terms]
    reference = "the materials have their constants of the reference state"
    for name in ("temperature", "axial_stretch"):
        if getattr(file.model, name) is not None:
            found.append(f"[model]: {name}; {reference}")
    for name, own in file.material_tables.items():
        if own.swelling is not None:
            found.append(f"[material.{name}]: swelling; {reference}")
        if own.viscoelastic is not None:
            found.append(f"[material.{name}.viscoelastic]: relaxation")
        if own.softening is not None:
            found.append(f"[material.{name}.softening]: softening")
    for label, (_, _, motion) in _moved(file, seal).items():
        if np.ptp(motion.angles) > 0.0:
            found.append(f"rotation of the moved edges {label!r}; their nodes are only translated")
    for contact in (*contacts(seal), *self_contacts(seal)):
        if any(isinstance(own, FrictionLaw) for own in _frictions(contact.law)):
            found.append(
                f"friction law of {contact.label!r}; its contact is frictionless in this file"
            )
    for contact in contacts(seal):
        motion = contact.motion
        if motion.begins_at < 0.0 and contact.label in file.glued:
            found.append(
                f"preliminary increments of the profile {contact.label!r}, which would move its glued "
                "edges; it overlaps the section at the start"
            )
        radii = [*motion.positions[:, 0], motion.coordinates(BEFORE)[0]]
        if seal.body.axisymmetric and np.ptp(radii) > 0.0:
            found.append(
                f"radial motion of the profile {contact.label!r}; a rigid body of Abaqus cannot "
                "change its radius"
            )
        if has_cubic(contact.shape.profile()):
            found.append(
                f"splines of the profile {contact.label!r}; they are replaced by straight segments"
            )
    return found


def _begins_at(file: SealFile, contact) -> float:
    """Return the path parameter of the pose with which a profile is written: before its preliminary
    increments, but where the load steps begin if edges are glued to it."""
    return 0.0 if contact.label in file.glued else contact.motion.begins_at


def name_of(*words: str) -> str:
    """Convert a name to letters, digits and underscores, in capitals, as Abaqus accepts it."""
    return re.sub(r"\W", "_", "_".join(words), flags=re.ASCII).upper()


def _set(keyword: str, numbers) -> list[str]:
    """Write a set of nodes or elements, counted from 1."""
    rows = np.asarray(numbers, int) + 1
    cut = [rows[i : i + PER_LINE] for i in range(0, len(rows), PER_LINE)]
    return [keyword, *(", ".join(map(str, row)) for row in cut)]


def _mesh_lines(file: SealFile, seal: OutlineSeal, mesh: QuadraticMesh) -> list[str]:
    """Write nodes, elements by material, and the sets of nodes of all edges."""
    # reference nodes after those of the section; the pivot is the origin of their displacements
    poses = [own.motion.pose(_begins_at(file, own)) for own in contacts(seal)]
    points = [*mesh.points.tolist(), *(pose.position + pose.pivot for pose in poses)]
    lines = ["*NODE", *(f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in enumerate(points, 1))]
    for number, region in enumerate(seal.definitions[0].regions):
        kind = element_type(region.material, seal.body.axisymmetric)
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET=REGION_{number + 1}")
        own = np.flatnonzero(mesh.regions == number)
        lines += [", ".join(map(str, [e + 1, *(mesh.triangles[e] + 1)])) for e in own.tolist()]
    for name, edge in seal.body.edges.items():
        lines += _set(f"*NSET, NSET={name_of('EDGE', name)}", mesh.nodes(edge.sides))
    return lines


def _material_lines(seal: OutlineSeal, mesh: QuadraticMesh) -> list[str]:
    """Write section and material of every region."""
    lines = []
    for number, region in enumerate(seal.definitions[0].regions, 1):
        name = name_of("MATERIAL", region.name or "1")
        lines += [f"*SOLID SECTION, ELSET=REGION_{number}, MATERIAL={name}", "1.,"]
        lines += [f"*MATERIAL, NAME={name}", *material_lines(region.material)]
    return lines


def _surface(seal: OutlineSeal, mesh: QuadraticMesh, name: str, edges) -> list[str]:
    """Write the surface of the section along edges, by the sides of its triangles."""
    sides = np.concatenate([seal.body.edge(edge).sides for edge in edges])
    faces, lines, data = mesh.faces(sides), [], []
    for side in range(3):
        own = [element for element, number in faces if number == side]
        if own:
            elements = f"{name}_S{side + 1}"
            lines += _set(f"*ELSET, ELSET={elements}", own)
            data.append(f"{elements}, S{side + 1}")
    return [*lines, f"*SURFACE, TYPE=ELEMENT, NAME={name}", *data]


def _frictions(law) -> tuple:
    """Return the coefficients or laws of friction of a contact law, one or one for every group."""
    return law.friction.laws if isinstance(law.friction, FrictionByGroup) else (law.friction,)


def _interaction(name: str, friction) -> list[str]:
    """Write a contact law: hard contact, Coulomb's friction."""
    lines = [f"*SURFACE INTERACTION, NAME={name}", "1.,"]
    if not isinstance(friction, FrictionLaw) and friction:
        lines += ["*FRICTION", f"{friction:.12g},"]
    return lines


def _profile_lines(file: SealFile, seal: OutlineSeal, mesh: QuadraticMesh) -> list[str]:
    """Write every profile with its reference node, surface and contact."""
    lines, edges = [], {own.name: own.contact for own in file.profiles}
    for number, contact in enumerate(contacts(seal), len(mesh.points) + 1):
        label, pose = contact.label, contact.motion.pose(_begins_at(file, contact))
        reference, rigid = (name_of(word, label) for word in ("REFERENCE", "RIGID"))
        lines += _set(f"*NSET, NSET={reference}", [number - 1])
        lines += ["** outward normal on the left of the segments"]
        lines += [f"*SURFACE, TYPE=SEGMENTS, NAME={rigid}"]
        lines += surface_lines(contact.shape.profile(), pose)
        body = f"*RIGID BODY, ANALYTICAL SURFACE={rigid}, REF NODE={number}"
        if label in file.glued:
            # bonded edges move with the reference node
            sides = np.concatenate([seal.body.edge(edge).sides for edge in file.glued[label]])
            bonded = name_of("GLUED", label)
            lines += _set(f"*NSET, NSET={bonded}", mesh.nodes(sides))
            body += f", TIE NSET={bonded}"
        lines.append(body)
        # edges with a friction of their own are surfaces of their own
        parts = [((), edges[label], contact.law.friction)]
        if isinstance(contact.law.friction, FrictionByGroup):
            own = contact.law.friction
            parts = [((n,), (n,), law) for n, law in zip(own.names, own.laws, strict=True)]
        for words, touching, friction in parts:
            rubber, law = (name_of(word, label, *words) for word in ("RUBBER", "CONTACT"))
            lines += _surface(seal, mesh, rubber, touching)
            lines += _interaction(law, friction)
            lines += [
                f"*CONTACT PAIR, INTERACTION={law}, TYPE=SURFACE TO SURFACE",
                f"{rubber}, {rigid}",
            ]
    return lines


def _self_contact_lines(file: SealFile, seal: OutlineSeal, mesh: QuadraticMesh) -> list[str]:
    """Write the contact of the section with itself; of edges by pairs where these have a friction."""
    lines = []
    for contact in self_contacts(seal):
        label, edges, friction = contact.label, file.self_contact.edges, contact.law.friction
        if not isinstance(friction, FrictionByGroup):
            surface, law = (name_of(word, label) for word in ("RUBBER", "CONTACT"))
            lines += _surface(seal, mesh, surface, edges)
            lines += _interaction(law, friction)
            lines += [f"*CONTACT PAIR, INTERACTION={law}", f"{surface},"]
            continue
        surfaces = {edge: name_of("RUBBER", label, edge) for edge in edges}
        for edge, surface in surfaces.items():
            lines += _surface(seal, mesh, surface, [edge])
        # the pairs of the file, then all others if these may touch
        own = {frozenset(pair.edges): pair.friction for pair in file.self_contact.pairs}
        for one, other in combinations_with_replacement(edges, 2):
            value = own.get(frozenset((one, other)), file.self_contact.friction)
            if value is None:
                continue
            law, second = name_of("CONTACT", label, one, other), surfaces[other]
            lines += _interaction(law, value)
            lines += [f"*CONTACT PAIR, INTERACTION={law}"]
            lines += [f"{surfaces[one]}, {second if one != other else ''}".rstrip()]
    return lines


def _moved(file: SealFile, seal: OutlineSeal) -> dict:
    """Return edges, components and motion of edges that are moved without a rigid surface, by label."""
    own = {moved.name: (moved.edges, moved.components) for moved in file.moved}
    own |= {label: (edges, (0, 1)) for label, edges in file.glued.items()}
    rigid = {contact.label for contact in contacts(seal)}
    every = {edges.label: edges.motion for edges in moved_edges(seal)}
    return {label: (*own[label], motion) for label, motion in every.items() if label not in rigid}


def _fixed_lines(file: SealFile) -> list[str]:
    """Write fixed components of edges: all of fixed ones, those across planes of symmetry."""
    # edges that move are prescribed in the steps
    moving = {name for own in file.moved for name in own.edges}
    moving |= {name for edges in file.glued.values() for name in edges}
    rows = [
        f"{name_of('EDGE', name)}, {component + 1}, {component + 1}"
        for name, components in file.supports.items()
        for component in components
        if name not in moving
    ]
    return ["*BOUNDARY", *rows] if rows else []


def _step_lines(file: SealFile, seal: OutlineSeal) -> list[str]:
    """Write a step for the preliminary increments, where there are any, and one for every stage, with
    total displacements of the reference nodes, their rotations, and the displacements of moved edges."""
    motions = {own.label: own.motion for own in contacts(seal)}
    moved = _moved(file, seal)
    along = [*motions.values(), *(motion for _, _, motion in moved.values())]
    # stages of all motions, by the load steps at their ends
    ends = sorted({0, *(int(end) for motion in along for end in np.cumsum(motion.steps))})
    steps = [(f"STAGE_{n}", first, last) for n, (first, last) in enumerate(pairwise(ends), 1)]
    begins_at = {own.label: _begins_at(file, own) for own in contacts(seal)}
    earliest = min(begins_at.values(), default=0.0)
    if earliest < 0.0:
        steps.insert(0, ("PRELIMINARY", earliest, 0))
    lines = []
    for name, first, last in steps:
        lines += [f"*STEP, NAME={name}, NLGEOM=YES, INC={MOST_INCREMENTS}", "*STATIC"]
        # as many increments as load steps, shorter ones where Abaqus wants them
        increment = 1.0 / (last - first)
        lines += [f"{increment:.12g}, 1., {LEAST_INCREMENT:g}, {increment:.12g}", "*BOUNDARY"]
        for label, motion in motions.items():
            change = motion.coordinates(last) - motion.coordinates(begins_at[label])
            if seal.body.axisymmetric:
                # no radial motion of a rigid body (``not_exported``)
                change[0] = 0.0
            rows = zip((1, 2, 6), change.tolist(), strict=True)
            lines += [f"{name_of('REFERENCE', label)}, {c}, {c}, {own:.12g}" for c, own in rows]
        for edges, components, motion in moved.values():
            change = motion.coordinates(last) - motion.coordinates(0)
            lines += [
                f"{name_of('EDGE', edge)}, {c + 1}, {c + 1}, {change[c]:.12g}"
                for edge in edges
                for c in components
            ]
        lines += ["*OUTPUT, FIELD, VARIABLE=PRESELECT", "*OUTPUT, HISTORY"]
        for label in motions:
            lines += [
                f"*NODE OUTPUT, NSET={name_of('REFERENCE', label)}",
                "RF1, RF2, RM3, U1, U2, UR3",
            ]
        lines.append("*END STEP")
    return lines
