# %% [markdown]
# # Designing a texture
#
# A soft lens is to rest on pillar tops up to a force of 1 mN, and no further. Which texture does that, and how exactly
# must it be made?

# %%
import fakir

system = fakir.System(
    lens=fakir.Lens(radius="2.2 mm", young_modulus="2 MPa", poisson_ratio=0.5),
    substrate=fakir.Substrate(young_modulus="2 MPa", poisson_ratio=0.5),
    texture=fakir.HexagonalTexture(diameter="6 um", height="2.2 um", surface_fraction=0.1),
)
system

# %% [markdown]
# ## The critical state
#
# This is the state in which the lens just reaches the floor between the pillars.

# %%
critical = system.transition()
critical

# %%
fakir.plot.pressure_map(critical);

# %% [markdown]
# The pillars are a table, and fields are functions of position:

# %%
strongest = critical.pillars["force_N"].max()
print(f"{len(critical.pillars)} pillars, the strongest bears {1e6 * strongest:.2f} uN")
x, y = critical.floor_contact
print(f"gap at the floor contact: {critical.state.gap(x, y):.1e} m")
assert abs(critical.state.gap(x, y)) < 1e-10

# %% [markdown]
# ## The texture for a force of 1 mN

# %%
design = fakir.design(system, "texture.surface_fraction", force="1 mN")
design

# %%
assert abs(design.critical.force / 1e-3 - 1) < 1e-8
axes = fakir.plot.profiles([design.system.press(force="0.2 mN"), design.critical])

# %% [markdown]
# ## How far the force scatters
#
# Pillars come out 3 % higher or lower, and the lens lands anywhere on the lattice.

# %%
spread = fakir.spread(design.system, {"texture.pillar.height": "3 %"}, samples=100, seed=1)
spread

# %% [markdown]
# ## A second opinion
#
# Two methods with nothing in common, and what the formulas of the paper say. The texture here is a wide one, which takes
# little time.

# %%
wide = system.replace({"texture.surface_fraction": 0.002})
verification = wide.verify()
assert verification.agrees
verification

# %%
fakir.theory.small_contact(wide)
