# %% [markdown]
# # Comparing with measured data
#
# A loading curve was measured: forces and contact radii, with their errors. (Here it is made up: the answer of the
# model with noise, from a substrate of 2 MPa. The file of an experiment would be read with `numpy.loadtxt`.)

# %%
import matplotlib.pyplot as plt
import numpy as np

import fakir


def system_with(modulus):
    """The texture on a substrate of that modulus; lens and substrate are of the same elastomer."""
    return fakir.System(
        fakir.Lens(radius="2.2 mm", young_modulus=modulus, poisson_ratio=0.5),
        fakir.Substrate(young_modulus=modulus, poisson_ratio=0.5),
        fakir.HexagonalTexture(diameter="6 um", height="2.2 um", surface_fraction=0.03),
    )


forces = np.array([5, 10, 20, 40, 80, 160, 240]) * 1e-6
noise = np.random.default_rng(7)
truth = [system_with("2 MPa").press(force=force) for force in forces]
radii = np.array([state.contact_radius for state in truth]) + noise.normal(0, 1e-6, forces.size)
depths = np.array([state.indentation for state in truth]) * noise.normal(1, 0.02, forces.size)

# %% [markdown]
# ## The model for some moduli
#
# Quantities can have units of `pint`, or be texts or numbers in SI units.

# %%
figure, (above, below) = plt.subplots(2, 1, figsize=(4.2, 5), sharex=True, layout="constrained")
above.errorbar(forces * 1e6, radii * 1e6, 1.0, fmt="ko", ms=3, label="measured")
below.errorbar(forces * 1e6, depths * 1e6, 0.02 * depths * 1e6, fmt="ko", ms=3)
misfit = {}
for modulus in ["1.5 MPa", "2 MPa", "2.5 MPa"]:
    states = [system_with(modulus).press(force=force) for force in forces]
    model = np.array([state.indentation for state in states])
    misfit[modulus] = float(np.mean(((model - depths) / (0.02 * depths)) ** 2))
    above.plot(forces * 1e6, [1e6 * state.contact_radius for state in states], label=modulus)
    below.plot(forces * 1e6, 1e6 * model)
above.set_ylabel("contact radius (µm)")
above.legend(frameon=False, fontsize="small")
below.set_ylabel("indentation (µm)")
below.set_xlabel("force (µN)")
above.set_xscale("log")
misfit

# %% [markdown]
# The mean square of the deviations, in units of the errors, is about 1 for the right modulus alone:

# %%
assert min(misfit, key=misfit.get) == "2 MPa"
assert misfit["2 MPa"] < 3 < misfit["1.5 MPa"]

# %% [markdown]
# ## On the phase diagram
#
# The loading path ends on the transition.

# %%
system = system_with("2 MPa")
fakir.plot.phase_diagram(system, [system.transition()], [system.approach("0.5 um")]);

# %% [markdown]
# ## What to cite

# %%
for work in fakir.cite(system.transition()):
    print(work.text)
