# %% [markdown]
# # A sweep on Dask
#
# Many cases, on the machines of a cluster. Here the cluster is two processes on this machine; with
# `dask_jobqueue.SLURMCluster` in place of `LocalCluster` it is a real one, and the rest stays as it is.

# %%
import tempfile
from pathlib import Path

from distributed import Client, LocalCluster

import fakir

system = fakir.System(
    lens=fakir.Lens(radius="2.2 mm", young_modulus="2 MPa", poisson_ratio=0.5),
    substrate=fakir.Substrate(young_modulus="2 MPa", poisson_ratio=0.5),
    texture=fakir.HexagonalTexture(diameter="6 um", height="2.2 um", surface_fraction=0.1),
)
study = {
    "system": system,
    "axes": {
        "texture.offset": [0, 0.5],
        "surface_fraction": {"from": 1e-3, "to": 0.05, "points": 12, "spacing": "log"},
    },
}

# %% [markdown]
# ## On an executor
#
# Any executor of `concurrent.futures` will do, and that of Dask is one. What is answered is in the journal of the output
# folder at once: should the cluster go down, `resume=True` goes on from there.

# %%
folder = Path(tempfile.mkdtemp()) / "sweep"
cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
with cluster, Client(cluster) as client:
    sweep = fakir.sweep(study, client.get_executor(), output=folder)
sweep

# %% [markdown]
# The table is the one that the command line gives, wherever it was computed:

# %%
assert (folder / "table.csv").read_text() == sweep.to_csv() == fakir.sweep(study).to_csv()
print(*sorted(path.name for path in folder.iterdir()))

# %% [markdown]
# ## The results
#
# As a data set with the axes as dimensions, with units:

# %%
data = sweep.to_xarray()
data.critical_force_N.sel({"texture.offset": 0.5}).to_series().head(3)

# %%
axes = fakir.plot.critical_curves(sweep)
