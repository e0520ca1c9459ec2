"""Contact between a soft lens and a surface patterned with pillars, and the load at which the lens touches the floor between
them.

>>> import fakir
>>> system = fakir.System(
...     fakir.Lens(radius="2.2 mm", young_modulus="2 MPa", poisson_ratio=0.5),
...     fakir.Substrate(young_modulus="2 MPa", poisson_ratio=0.5),
...     fakir.HexagonalPattern(diameter="6 um", height="2.2 um", surface_fraction=0.1),
... )
>>> critical = system.transition()
>>> critical.pillars_in_contact
451

Results are in SI units; quantities are given as numbers in SI units, as strings with a unit, or as pint quantities. Names are
those of case files and of the command line. `fakir.theory` contains closed forms, `fakir.bem` contacts on height maps,
`fakir.plot` figures.
"""

import warnings as _warnings
from typing import Any as _Any

from . import bem, errors, love, plot, theory
from ._bodies import (
    CylinderLens,
    ElasticBase,
    FlatPunch,
    HexagonalPattern,
    LatticeOptions,
    LayerOptions,
    Lens,
    ObliquePattern,
    ParaboloidLens,
    Pillars,
    PlateLens,
    ProfileLens,
    RectangularPattern,
    SquarePattern,
    Substrate,
)
from ._comparison import Comparison
from ._cycle import Adhesion, AdhesiveFloor, Cycle, PullOff
from ._design import Candidate, Citation, Design, OutOfReach, Spread, cite, design, spread
from ._fakir import __version__
from ._fit import Estimate, Fit, fit
from ._fits import Fits, JointFit, fit_many
from ._flat import (
    Flat,
    FlatApproach,
    FlatContact,
    FlatCycle,
    FlatElements,
    FlatSystem,
    FlatVerification,
)
from ._floor import FloorContact
from ._friction import FrictionFit, ShearStress, fit_friction
from ._gradient import Gradient
from ._history import History, Relaxation
from ._homogenised import HomogenisedLattice, homogenised
from ._loading import Approach
from ._numbers import Contact, Critical, CycleError, ErrorEstimate, FloorErrors, Normalized
from ._result import Answer, Limit, Result
from ._problem import problem, read_case
from ._asperities import (
    AsperityApproach,
    AsperityArray,
    AsperityContact,
    AsperityCycle,
    AsperityElements,
    AsperityTransition,
    AsperityVerification,
    HeightDesign,
    design_heights,
)
from ._state import ContactState, CriticalState
from ._sweep import Sweep, sweep
from ._system import System
from ._verification import Difference, Verification
from .errors import (
    CaseError,
    DesignError,
    FakirError,
    FakirWarning,
    FitError,
    NotConverged,
    SolveError,
    StudyError,
    WorkersLost,
)

__all__ = [
    "Adhesion",
    "AdhesiveFloor",
    "Answer",
    "Approach",
    "AsperityApproach",
    "AsperityArray",
    "AsperityContact",
    "AsperityCycle",
    "AsperityElements",
    "AsperityTransition",
    "AsperityVerification",
    "Candidate",
    "CaseError",
    "Citation",
    "Comparison",
    "Contact",
    "ContactState",
    "Critical",
    "CriticalState",
    "Cycle",
    "CycleError",
    "CylinderLens",
    "Design",
    "DesignError",
    "Difference",
    "ErrorEstimate",
    "ElasticBase",
    "Estimate",
    "FakirError",
    "FakirWarning",
    "Fit",
    "FitError",
    "Fits",
    "Flat",
    "FlatApproach",
    "FlatContact",
    "FlatCycle",
    "FlatElements",
    "FlatPunch",
    "FlatSystem",
    "FlatVerification",
    "FloorContact",
    "FloorErrors",
    "FrictionFit",
    "Gradient",
    "HeightDesign",
    "History",
    "HexagonalPattern",
    "HomogenisedLattice",
    "JointFit",
    "LatticeOptions",
    "LayerOptions",
    "Lens",
    "Limit",
    "Normalized",
    "NotConverged",
    "ObliquePattern",
    "OutOfReach",
    "ParaboloidLens",
    "Pillars",
    "PlateLens",
    "ProfileLens",
    "PullOff",
    "Relaxation",
    "Result",
    "RectangularPattern",
    "ShearStress",
    "SolveError",
    "Spread",
    "SquarePattern",
    "StudyError",
    "Substrate",
    "Sweep",
    "System",
    "Verification",
    "WorkersLost",
    "__version__",
    "bem",
    "cite",
    "design",
    "design_heights",
    "errors",
    "fit",
    "fit_friction",
    "fit_many",
    "homogenised",
    "plot",
    "problem",
    "read_case",
    "spread",
    "sweep",
    "theory",
]

_FORMER_NAMES = {
    "HexagonalTexture": "HexagonalPattern",  # former name
    "ObliqueTexture": "ObliquePattern",  # former name
    "RectangularTexture": "RectangularPattern",  # former name
    "SquareTexture": "SquarePattern",  # former name
    "RoundedContact": "AsperityContact",  # former name
    "StuckFloor": "AdhesiveFloor",  # former name
    "RoundedTops": "AsperityArray",  # former name
}


def __getattr__(name: str) -> _Any:
    """Looks up a class by its deprecated name."""
    if name not in _FORMER_NAMES:
        raise AttributeError(f"module 'fakir' has no attribute {name!r}")
    present = _FORMER_NAMES[name]
    _warnings.warn(f"fakir.{name} is now called fakir.{present}", FutureWarning, stacklevel=2)
    return globals()[present]
