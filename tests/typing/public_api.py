"""The public API as a user writes it. Read by a type checker (test_public_api.py), not run."""

from typing import assert_type

import seal_mdao as sm

seal = sm.door_seal(friction=0.25)
assert_type(seal, sm.Seal)

result = sm.analyze(seal)
assert_type(result, sm.SealResult)
assert_type(result.converged, bool)

rates = sm.differentiate(result, ("door_radius",), method="direct")
assert_type(rates, sm.Sensitivities)

file = sm.read_seal_file("examples/lip.toml")
assert_type(file, sm.SealFile)
built: sm.Seal = sm.build_seal(file)

law = sm.NeoHookean(0.4, 1000.0)
assert_type(law, sm.NeoHookean)
options = sm.NewtonOptions(tolerance=1e-9)
assert_type(options, sm.NewtonOptions)
