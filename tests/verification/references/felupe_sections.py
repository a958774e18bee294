"""Sections of ``felupe_contact``: meshes of biquadratic quadrilaterals by gmsh, lengths in mm."""

import felupe as fem
import gmsh
import numpy as np


class Grid:
    """Blocks of structured quadrilaterals in gmsh."""

    def point(self, x, y):
        return gmsh.model.geo.addPoint(x, y, 0.0)

    def line(self, start, end, count, growth=1.0):
        """Straight curve of ``count`` elements, each ``growth`` times as long as the one before."""
        curve = gmsh.model.geo.addLine(start, end)
        gmsh.model.geo.mesh.setTransfiniteCurve(curve, count + 1, "Progression", growth)
        return curve

    def swelling(self, start, end, count):
        """Straight curve whose elements, two more, are smaller at both ends."""
        curve = gmsh.model.geo.addLine(start, end)
        gmsh.model.geo.mesh.setTransfiniteCurve(curve, count + 3, "Bump", 0.2)
        return curve

    def arc(self, start, centre, end, count, growth=1.0):
        curve = gmsh.model.geo.addCircleArc(start, centre, end)
        gmsh.model.geo.mesh.setTransfiniteCurve(curve, count + 1, "Progression", growth)
        return curve

    def block(self, *curves):
        """Four curves, head to tail; a minus turns one round."""
        face = gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves)])
        gmsh.model.geo.mesh.setTransfiniteSurface(face)

    def quarter(self, centre, radius, along, inward, upper=None, growth=1.0):
        """Make three blocks in a quarter disc: a square in the middle and two between it and the arc.

        ``along`` elements lie along each half of the arc, or ``upper`` along the upper one; ``inward``
        from there to the square, each ``growth`` times as long as its neighbour further in. Returns
        the curves and the points of its two straight edges.
        """
        upper = along if upper is None else upper
        (x, y), a, b, s = centre, 0.5 * radius, 0.42 * radius, radius * np.sqrt(0.5)
        o, pa, pb, pc, pd, pe, pf = (
            self.point(x + dx, y + dy)
            for dx, dy in ((0, 0), (a, 0), (b, b), (0, a), (radius, 0), (s, s), (0, radius))
        )
        oa, ab = self.line(o, pa, upper), self.line(pa, pb, along)
        bc, co = self.line(pb, pc, upper), self.line(pc, o, along)
        ad, be, cf = (self.line(p, q, inward, growth) for p, q in ((pa, pd), (pb, pe), (pc, pf)))
        de, ef = self.arc(pd, o, pe, along), self.arc(pe, o, pf, upper)
        self.block(oa, ab, bc, co)
        self.block(ad, de, -be, -ab)
        self.block(be, ef, -cf, -bc)
        return (oa, ad, co, cf), (o, pa, pd, pc, pf)


def quarter_disc(radius):
    """Quarter in x, y > 0."""

    def draw(size):
        along = max(2, round(0.25 * np.pi * radius / size))
        Grid().quarter((0.0, 0.0), radius, along, max(2, round(0.55 * radius / size)))

    return draw


def fine_disc(radius):
    """Quarter in x, y > 0 with elements of ``size`` along the upper half of its arc."""

    def draw(size):
        upper = max(4, round(0.25 * np.pi * radius / size))
        # inward three times as long
        inward = max(3, round(0.55 * radius / (1.8 * size)))
        growth = (1.0 / 3.0) ** (1.0 / (inward - 1))
        Grid().quarter((0.0, 0.0), radius, upper // 2, inward, upper, growth)

    return draw


def rounded_block(width, height, radius, graded=False, corner=0.4):
    """Right half of a block; its rounded corner is a quarter disc, with five blocks round it.

    ``graded``: smaller elements at the lower corner too. ``corner``: size of the elements in the
    rounded corner over that of the others.
    """

    def draw(size):
        grid, b, h = Grid(), 0.5 * width - radius, height - radius
        fine = max(2, round(0.5 * radius / (corner * size)))
        (oa, ad, co, cf), (o, pa, pd, pc, pf) = grid.quarter((b, h), radius, fine, fine)
        across, up = round(b / size / 0.8), round(h / size / 0.8)

        def growing(start, end, count, ratio=0.4):
            """From the middle to the corner, elements get smaller down to those of the corner."""
            return grid.line(start, end, count, ratio ** (1.0 / count))

        xs = (0.0, b, b + 0.5 * radius, b + radius)
        low = [grid.point(x, 0.0) for x in xs]
        left = [grid.point(0.0, y) for y in (h, h + 0.5 * radius, h + radius)]
        lows = [growing(low[0], low[1], across, corner)]
        lows += [grid.line(low[1], low[2], fine), grid.line(low[2], low[3], fine)]
        rise = grid.swelling if graded else growing
        ups = [rise(p, q, up) for p, q in zip(low, (left[0], o, pa, pd), strict=True)]
        rights = [growing(p, q, across, corner) for p, q in zip(left, (o, pc, pf), strict=True)]
        lefts = [grid.line(left[0], left[1], fine), grid.line(left[1], left[2], fine)]
        grid.block(lows[0], ups[1], -rights[0], -ups[0])
        grid.block(lows[1], ups[2], -oa, -ups[1])
        grid.block(lows[2], ups[3], -ad, -ups[2])
        grid.block(rights[0], -co, -rights[1], -lefts[0])
        grid.block(rights[1], cf, -rights[2], -lefts[1])

    return draw


def quarter(grid, outer, inner, size):
    """Numbers of elements across and around a quarter of a ring in x, y > 0, its centre and corners."""
    layers = max(2, round((outer - inner) / size))
    around = max(4, round(0.5 * np.pi * outer / size))
    places = ((0, 0), (inner, 0), (outer, 0), (0, outer), (0, inner))
    return layers, around, [grid.point(*xy) for xy in places]


def half_ring(outer, inner):
    """Right half of a bulb; finer at its foot."""

    def draw(size):
        grid = Grid()
        layers, around, (o, a, b, c, d) = quarter(grid, outer, inner, size)
        growth = 4.0 ** (1.0 / around)
        grid.block(
            grid.line(a, b, layers),
            grid.arc(b, o, c, around, growth),
            grid.line(c, d, layers),
            grid.arc(d, o, a, around, 1.0 / growth),
        )

    return draw


def fine_ring(outer, inner):
    """Right half of a bulb with elements of ``size`` in the upper half of its arc."""

    def draw(size):
        grid, s = Grid(), np.sqrt(0.5)
        layers, upper = (
            max(4, round(length / size)) for length in (outer - inner, 0.25 * np.pi * outer)
        )
        lower = upper // 2
        o, a, b, c, d, e, f = (
            grid.point(*xy)
            for xy in (
                (0, 0), (inner, 0), (outer, 0), (s * outer, s * outer), (s * inner, s * inner),
                (0, outer), (0, inner),
            )
        )  # fmt: skip
        growth, middle = 2.5 ** (1.0 / lower), grid.line(c, d, layers)
        grid.block(
            grid.line(a, b, layers), grid.arc(b, o, c, lower, growth), middle,
            grid.arc(d, o, a, lower, 1.0 / growth),
        )  # fmt: skip
        grid.block(
            -middle, grid.arc(c, o, e, upper), grid.line(e, f, layers), grid.arc(f, o, d, upper)
        )

    return draw


def outlined(segments, corners):
    """Section inside line and arc ``segments`` of a seal file, refined at its arcs and at corners.

    Elements of ``size`` lie along arcs, of four times that at ``corners``; they grow with a quarter of
    the distance from there, up to thirty times ``size``.
    """

    def draw(size):
        grid, known, curves, arc = Grid(), {}, [], []

        def at(xy):
            return known.setdefault(tuple(xy), grid.point(*xy))

        for own in segments:
            if "line" in own:
                curves += [
                    gmsh.model.geo.addLine(at(a), at(b))
                    for a, b in zip(own["line"], own["line"][1:], strict=False)
                ]
                continue
            start, through, end = (np.array(own["arc"][key]) for key in ("start", "through", "end"))
            # centre of the circle: (p - start) . (centre - start) = |p - start|^2 / 2
            sides = np.array([through - start, end - start])
            centre = start + np.linalg.solve(sides, 0.5 * (sides**2).sum(axis=1))
            curves.append(gmsh.model.geo.addCircleArc(at(start), grid.point(*centre), at(end)))
            arc += curves[-1:]
        gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(curves)])
        gmsh.model.geo.synchronize()
        field = gmsh.model.mesh.field
        for tag, kind, tags, least in (
            (1, "CurvesList", arc, size), (2, "PointsList", [at(xy) for xy in corners], 4.0 * size),
        ):  # fmt: skip
            field.add("Distance", tag)
            field.setNumbers(tag, kind, tags)
            field.setNumber(tag, "Sampling", 200)
            field.add("MathEval", 10 + tag)
            field.setString(10 + tag, "F", f"2 * ({least} + 0.25 * F{tag})")
        field.add("Min", 20)
        field.setNumbers(20, "FieldsList", [11, 12])
        field.setAsBackgroundMesh(20)
        for option, value in (
            # quadrilaterals only, by halving those of twice the size
            ("RecombinationAlgorithm", 2), ("SubdivisionAlgorithm", 1), ("Algorithm", 8),
            ("MeshSizeFromPoints", 0), ("MeshSizeFromCurvature", 0),
            ("MeshSizeExtendFromBoundary", 0), ("MeshSizeMax", 60.0 * size),
        ):  # fmt: skip
            gmsh.option.setNumber(f"Mesh.{option}", value)

    return draw


def mesh_of(draw, size):
    """Biquadratic quadrilaterals of what ``draw(size)`` makes, curved at its boundary."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    draw(size)
    gmsh.model.geo.synchronize()
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    kinds, _, nodes = gmsh.model.mesh.getElements(2)
    assert list(kinds) == [10], kinds  # quadrilaterals of nine nodes only
    gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, dtype=int)
    number[tags.astype(int)] = np.arange(len(tags))
    cells = number[nodes[0].astype(int)].reshape(-1, 9)
    used, cells = np.unique(cells, return_inverse=True)
    points = xyz.reshape(-1, 3)[used, :2]
    return fem.Mesh(points, cells.reshape(-1, 9), "quad9")
