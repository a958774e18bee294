"""Contact pressure of the door seal under a flat door by the elements of ``pressed_elements``.

Same rubber, contact law and penalties as ``door_seal``, so that the difference from it is that of the
discretisation. Not run by the tests. It writes ``references/flat_door.json``::

    python tests/verification/door_pressure.py

The pressure at a node i between two elements is the mean of w_n |g_n| at their contact points, weighted
with their lengths and with the function that falls linearly from 1 at i to 0 at the next nodes between
elements. The contact ends where the gap between two contact points is zero.
"""

import json
import sys
from pathlib import Path

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.seals.door.door_seal import door_seal
from verification.pressed_elements import PER_EDGE, PressedElements

MESHES = ((4, 232), (4, 464))
"""Elements across the wall and around the ring."""
STEPS = 11, 21
SECTION = "nominal door seal under a flat door, at the end of its path"
METHOD = (
    "biquadratic displacement, linear discontinuous pressure, plane strain; contact law and penalties "
    "of door_seal at three Gauss points of every edge; one half by symmetry"
)


def profile(across: int, around: int, n_steps: int) -> dict:
    """Pressure at the end of the path along the right half of the outer boundary, from its top."""
    seal = door_seal(door="flat", n_steps=n_steps)
    pressed = PressedElements(seal, across, around)
    force = abs(pressed.press().reaction[-1, 1])
    x, pose = pressed.mesh.nodes + pressed.end, pressed.options.motion.pose(n_steps)
    gap = np.empty(len(pressed.where.length))
    normal_gaps(pressed.curve, pose, pressed.where.at(x), gap)
    # edges run from the base up the right side; from the top on the other way round
    half = len(pressed.edges) // 2
    edges = pressed.edges[:half][::-1, ::-1]
    parts = [
        own.reshape(-1, PER_EDGE, *own.shape[1:])[:half][::-1, ::-1]
        for own in (gap, pressed.where.length, pressed.where.values[:, ::-1])
    ]
    gap, length, values = parts
    pressure = pressed.options.law.normal_penalty * np.maximum(-gap, 0.0)
    # H_i = N_i + N_middle / 2 at both ends of an element
    hats = values[..., ::2] + 0.5 * values[..., 1:2]
    weight = _summed(np.einsum("eg,ega->ea", length, hats))
    at_nodes = _summed(np.einsum("eg,ega->ea", length * pressure, hats)) / weight
    middles = np.cumsum(length.ravel()) - 0.5 * length.ravel()
    # the gap is linear between Gauss points
    low, high = np.sort([gap.ravel()[:-1], gap.ravel()[1:]], axis=0)
    touching = np.where(high < 0.0, 1.0, np.maximum(-low, 0.0) / np.maximum(high - low, 1e-300))
    width = np.diff(middles) @ touching + middles[0]
    return {
        "length": np.append(0.0, np.cumsum(length.sum(axis=1))),
        "place": pressed.mesh.nodes[np.append(edges[:, 0], edges[-1, 2])],
        "pressure": at_nodes, "peak": at_nodes.max(), "width": 2.0 * width, "force": force,
    }  # fmt: skip


def _summed(of_ends) -> np.ndarray:
    """Sum of the parts (m, 2) of the ends of elements in a row, shape (m + 1,)."""
    return np.append(of_ends[:, 0], 0.0) + np.append(0.0, of_ends[:, 1])


def _change(one, other) -> dict:
    """Of one path to another: rms over the peak, at the nodes of the first, and relative changes."""
    near = one["length"] < 0.5 * max(one["width"], other["width"])
    apart = np.interp(one["length"], other["length"], other["pressure"]) - one["pressure"]
    rms = np.sqrt(np.mean(apart[near] ** 2)) / one["peak"]
    return {"rms_over_peak": rms} | {n: other[n] / one[n] - 1 for n in ("peak", "width", "force")}


def main() -> None:
    coarse, fine = (profile(*mesh, STEPS[1]) for mesh in MESHES)
    fewer = profile(*MESHES[0], STEPS[0])
    near = fine["length"] < fine["width"]
    found = {
        "mesh": MESHES[1],
        "change_on_coarse_mesh": [_change(fine, coarse)],
        "change_with_half_the_load_steps": [_change(coarse, fewer)],
        "arc_length_mm": fine["length"][near],
        "place_mm": fine["place"][near],
        "stages": [{
            "force_N_per_m": fine["force"], "peak_kPa": fine["peak"], "width_mm": fine["width"],
            "pressure_kPa": fine["pressure"][near],
        }],
    }  # fmt: skip
    text = json.dumps({"section": SECTION, "method": METHOD, "pressure": _plain(found)}, indent=1)
    file = Path(__file__).parent / "references" / "flat_door.json"
    file.write_text(text + "\n", encoding="utf-8")


def _plain(value):
    """As JSON holds it, floats with six digits."""
    if isinstance(value, dict):
        return {name: _plain(own) for name, own in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(own) for own in value]
    return value if isinstance(value, int | str) else float(f"{value:.6g}")


if __name__ == "__main__":
    main()
