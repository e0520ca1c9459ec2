# %% [markdown]
# # Fitting measured data
#
# A loading curve was measured: displacement of the instrument, force, and contact radius under the microscope. (Here it is made up: the
# answer of the model with noise, from a substrate of 1.6 MPa touched at 2 µm. The file of an experiment would be read with
# `pandas.read_csv`, or its path be given.)

# %%
import numpy as np

import fakir


def system_with(modulus):
    """The texture on a substrate of that modulus, under a lens that is known."""
    return fakir.System(
        fakir.Lens(radius="2.2 mm", young_modulus="2 MPa", poisson_ratio=0.5),
        fakir.Substrate(young_modulus=modulus, poisson_ratio=0.5),
        fakir.HexagonalTexture(diameter="6 um", height="2.2 um", surface_fraction=0.03),
    )


depths = np.linspace(0.2e-6, 4.0e-6, 20)
noise = np.random.default_rng(7)
truth = [system_with("1.6 MPa").press(indentation=depth) for depth in depths]
measured = {
    "displacement_m": 2e-6 + depths,
    "force_N": [state.force + noise.normal(0, 1e-6) for state in truth],
    "contact_radius_m": [state.contact_radius + noise.normal(0, 1e-6) for state in truth],
}

# %% [markdown]
# ## Least squares
#
# The search begins from 1 MPa. Standard errors of force and radius are estimated from the scatter, as none were given.

# %%
fit = fakir.fit(measured, system_with("1 MPa"), ["substrate.young_modulus", "contact_point"])
fit

# %%
fakir.plot.fit(fit);

# %% [markdown]
# The truth is inside the intervals:

# %%
low, high = fit["substrate.young_modulus"].interval
assert low < 1.6e6 < high
low, high = fit["contact_point"].interval
assert low < 2e-6 < high

# %% [markdown]
# ## What the data cannot tell
#
# On pillars that do not shorten, the contact depends on the moduli of lens and substrate through the reduced modulus only. A fit of both
# says so instead of giving numbers:

# %%
import warnings

stiff = system_with("1 MPa").replace({"texture.pillar.compliance": "none"})
with warnings.catch_warnings(record=True):
    both = fakir.fit(
        measured, stiff, ["substrate.young_modulus", "lens.young_modulus", "contact_point"]
    )
both.undetermined

# %% [markdown]
# ## On the phase diagram
#
# The loading path ends on the transition.

# %%
system = fit.system
fakir.plot.phase_diagram(system, [system.transition()], [system.approach("0.5 um")]);

# %% [markdown]
# ## What to cite

# %%
for work in fakir.cite(system.transition()):
    print(work.text)
