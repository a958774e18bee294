"""A friction law: the coefficient of rubber falls with the contact pressure.

A. Schallamach, Proc. Phys. Soc. B 65 (1952) 657: the true contact area of rough rubber grows with
p^(2/3), so mu falls with p^(-1/3). With a reference pressure it is finite without pressure:

    tau_max = mu_0 p (1 + p / p_0)^(-1/3)
"""

import seal_mdao as sm


@sm.register("friction_laws", "pressure_dependent")
def pressure_dependent(pressure, friction, reference):
    return friction * pressure * (1.0 + pressure / reference) ** (-1.0 / 3.0)
