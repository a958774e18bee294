"""Optimise a section of your own, read from a seal file, in an OpenMDAO problem."""

from pathlib import Path

import openmdao.api as om

import seal_mdao as sm

FILE = Path(__file__).parents[1] / "examples" / "o_ring.toml"

# section, rubber, profiles, measures and design of the file; what it leaves open is chosen here
seal = sm.build_seal(sm.read_seal_file(FILE))

prob = om.Problem(reports=None)
# inputs: boundary_offsets; outputs: area and every [[measure]] of the file under its name
prob.model.add_subsystem("seal", sm.SealGroup(seal=seal), promotes=["*"])
prob.model.add_design_var("boundary_offsets", lower=-0.2, upper=0.2, units="mm")
prob.model.add_objective("area", ref=10.0, units="mm**2")
prob.model.add_constraint("reaction", lower=2500.0, ref=2500.0, units="N/m")
prob.driver = sm.UnoDriver()
# every iteration is stored; `openmdao seal_report` makes a report of the file
prob.driver.add_recorder(sm.RestartRecorder("own_section.sql"))
prob.setup()
prob.run_driver()

print(
    f"area {prob.get_val('area')[0]:.3f} mm2, at the start {seal.area(seal.check_offsets(None))[0]:.3f}"
)
print(f"force on the lid {prob.get_val('reaction')[0]:.0f} N/m")
print(f"boundary offsets {prob.get_val('boundary_offsets').round(3)} mm")
