"""Seal files of half a round cord between two plates, on its plane of symmetry."""

CORD = """
symmetry = [{{ edges = ["middle"], normal = "x" }}]
[material.rubber]
law = "mooney_rivlin"
c10 = 500.0
c01 = 125.0
bulk_modulus = 400000.0
[section]
material = "rubber"
spacing = {spacing}
outer = [
  {{ edge = "side", arc = {{ start = [0, 0], through = [3, 3], end = [0, 6] }} }},
  {{ edge = "middle", line = [[0, 6], [0, 0]] }},
]
[[profile]]
name = "lid"
friction = {friction}
normal_penalty = {penalty}
tangent_penalty = {penalty}
line = [[-40, 0], [40, 0]]
start = [0, 6]
stage = [{{ translate = [0, -0.9], steps = {steps} }}]
[[profile]]
name = "floor"
friction = {friction}
normal_penalty = {penalty}
tangent_penalty = {penalty}
line = [[40, 0], [-40, 0]]
[[measure]]
type = "reaction"
profile = "lid"
[[measure]]
type = "contact_width"
profile = "lid"
[[measure]]
type = "stress_norm"
[[measure]]
type = "gap_square_sum"
profile = "lid"
"""


def cord(
    folder, spacing: float = 0.4, steps: int = 16, friction: float = 0.2, penalty: float = 1e6
):
    """Write the file and return its path; lengths in mm, penalties in kPa/mm."""
    path = folder / f"cord_{spacing}_{steps}_{friction}_{penalty:g}.toml"
    text = CORD.format(spacing=spacing, steps=steps, friction=friction, penalty=penalty)
    path.write_text(text, encoding="utf-8")
    return path
