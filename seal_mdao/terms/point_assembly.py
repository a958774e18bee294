"""Add forces and tangents of single points to the equations: of contact its form b(z, z-bar), Eq. (29),
and the bilinear form b*(z; dz, z-bar), Eqs. (37), (42)."""

from seal_mdao.compilation import compiled


@compiled
def interpolate(table, d, out):
    """Displacement of single points, ``out[i] = sum_I Phi_I(X_i) d_I`` (k, 2), Eq. (13)."""
    for i in range(table.start.size - 1):
        ux, uy = 0.0, 0.0
        for a in range(table.start[i], table.start[i + 1]):
            # u_i = Phi_I d_Ii   Eq. (13)
            ux += table.phi[a] * d[table.neighbours[a], 0]
            uy += table.phi[a] * d[table.neighbours[a], 1]
        out[i, 0], out[i, 1] = ux, uy


@compiled
def assemble_points(table, point_force, point_tangent, state, scatter, force, values):
    """Add forces (k, 2) and tangents (k, 2, 2) of the points in contact through their own rows of Phi.

    ``values`` may be empty: then only the force is assembled.
    """
    for i in range(table.start.size - 1):
        if state[i] == 0:
            continue
        s0, s1 = table.start[i], table.start[i + 1]
        n = s1 - s0
        for a in range(n):
            for c in range(2):
                at = scatter.equations[table.neighbours[s0 + a], c]
                # f_Ic += Phi_I s_c: b(z, z-bar) in stick (30) or slip (38)   Eq. (29)
                force[at] += table.phi[s0 + a] * point_force[i, c]
        if values.size == 0:
            continue
        slots = scatter.slots[scatter.start[i] : scatter.start[i + 1]]
        for e in range(2):
            for b in range(n):
                at = (e * n + b) * 2 * n
                for c in range(2):
                    # K_(Ic)(Je) += Phi_I (ds_c/dx_e) Phi_J: b* = b_N* + b_T*   Eqs. (37), (42), (68)
                    weight = point_tangent[i, c, e] * table.phi[s0 + b]
                    for a in range(n):
                        values[slots[at + c * n + a]] += weight * table.phi[s0 + a]
