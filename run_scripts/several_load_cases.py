"""Optimise the door seal for several load cases at once: frictions and hardnesses."""

import numpy as np
import openmdao.api as om

import seal_mdao as sm

seal = sm.door_seal(accuracy="engineering")

# one row for each load case: Coulomb coefficient, and a factor of the constants of the rubber
cases = sm.Scenarios(
    (sm.Variation("friction"), sm.Variation("hardness", "factor", ("c10", "c01"))),
    np.array([[0.15, 0.9], [0.25, 1.0], [0.35, 1.1]]),
)
start = sm.analyze(seal)

prob = om.Problem(reports=None)
# outputs of every measure: <measure>_scenarios, _mean, _std, _highest and _lowest over the load cases;
# workers=2 analyses two load cases at a time (then keep the script below `if __name__ == "__main__":`)
group = sm.ScenarioGroup(
    seal=seal, scenarios=cases, measures=("gap_square_sum", "reaction"), workers=0
)
prob.model.add_subsystem("seal", group, promotes=["*"])
prob.model.add_design_var("boundary_offsets", lower=-0.5, upper=0.5, units="mm")
prob.model.add_design_var("door_radius", lower=3.5, upper=4.5, units="mm")
prob.model.add_objective("gap_square_sum_mean", ref=start.gap_square_sum)
# the vertical force (component 1) of the stiffest case
most = 1.2 * start.reaction[-1, 1]
prob.model.add_constraint("reaction_highest", indices=[1], upper=most, ref=most, units="N/m")
prob.driver = sm.UnoDriver()
prob.setup()
prob.run_driver()

gaps, forces = prob.get_val("gap_square_sum_scenarios"), prob.get_val("reaction_scenarios")
for (friction, hardness), gap, force in zip(cases.numbers, gaps, forces, strict=True):
    print(
        f"friction {friction:g}, hardness {hardness:g}: gaps {gap[0]:.2e} mm2, {force[1]:.1f} N/m"
    )
print(f"mean gaps at the start {start.gap_square_sum:.2e} mm2 (nominal case)")
