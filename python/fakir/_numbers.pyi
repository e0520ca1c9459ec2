"""The classes of the record, written by tests/python/stubs.py."""

from typing import NamedTuple

from ._result import Answer, Number, Numbered

class FloorErrors(NamedTuple):
    share: float
    'Estimated relative error of the fraction carried by the floor.'
    contact_area: float
    'Estimated relative error of the area.'

class ErrorEstimate(NamedTuple):
    force: float
    'Estimated relative error of the force.'
    indentation: float
    'Estimated relative error of the indentation.'
    contact_radius: float | None = None
    'Estimated relative error of the contact radius.'
    top_contact_radius: float | None = None
    'Estimated relative error of the top contact radius.'
    contact_area: float | None = None
    'Estimated relative error of the contact area, at least a part of the cells along its edge.'

class FrictionErrors(NamedTuple):
    lateral_force: float | None = None
    'Estimated relative error of the lateral force, from those of both areas; the shear stresses count as exact.'
    tops_contact_area: float | None = None
    'Estimated relative error of the contact area on tops.'
    floor_contact_area: float | None = None
    'Estimated relative error of the contact area on the floor.'

class Friction(NamedTuple):
    tops_force: float
    'Part of the pillar tops, or of the whole contact on a surface without a floor (N).'
    tops_contact_area: float
    'Contact area on pillar tops, or the whole one on a surface without a floor, A_tops (m^2).'
    error: FrictionErrors
    '`FrictionErrors` with lateral_force, tops_contact_area, floor_contact_area.'
    lateral_force: float | None = None
    'Lateral force of the sliding contact, τ_tops A_tops + τ_floor A_floor, Q (N); of a cycle at the end of loading; `friction` is there only with shear stresses in the case; None if the floor is reached and its area not computed.'
    floor_force: float | None = None
    'Part of the floor (N).'
    floor_share: float | None = None
    'Part of the floor over the lateral force.'
    floor_contact_area: float | None = None
    'Contact area on the floor, A_floor (m^2); None on a surface without a floor, and where the floor is reached and its area not computed.'

class Normalized(NamedTuple):
    force: float
    'Critical force over hd/γ_int.'
    contact_radius: float
    'Critical contact radius over the pitch.'
    indentation: float
    'Critical indentation over the height of the pillars.'

class SurfacePressTops(NamedTuple):
    force: float
    'Force on the tops, all that is not floor (N); `tops` and `floor` are None if it is not known which part is the floor.'
    contact_area: float
    'Contact area of the tops (m^2).'

class SurfacePressFloor(NamedTuple):
    force: float
    'Force on the floor (N).'
    contact_area: float
    'Contact area on the floor (m^2).'

class Grid(NamedTuple):
    columns: int
    'Cells along x.'
    rows: int
    'Cells along y.'
    cell: tuple[float, float]
    'Sides of a cell (m).'
    origin: tuple[float, float]
    'Lower left corner of the grid, relative to the lens axis (m).'

class Certificate(NamedTuple):
    energy_bound: float
    'Upper bound of the energy error of the solution on its cells, over the elastic energy; with adhesion the largest gap of a cell in contact, over the indentation.'
    interpenetration: float
    'Deepest interpenetration anywhere (m).'
    gap_under_pressure: float
    'Largest gap of a cell in contact (m).'

class AsperityErrors(NamedTuple):
    force: float
    'Estimated relative error of the force, from a pressure of higher degree and from ovals that are treated as discs; the whole object is None if there is no estimate.'
    contact_area: float
    'Estimated relative error of the contact area.'
    indentation_m: float
    'Estimated error of the indentation, not relative: it counts from a level that may be anywhere (m).'

class AsperityCycleErrors(NamedTuple):
    turn_force: float | None = None
    'Estimated relative error of the force at the end of loading.'
    pull_off_force: float | None = None
    'Estimated relative error of the pull-off force.'
    hysteresis: float | None = None
    'Estimated relative error of the hysteresis.'

class SurfaceCycleErrors(NamedTuple):
    turn_force: float | None = None
    'Estimated relative error of the force at the end of loading; None, as all estimates, on too few cells.'
    pull_off_force: float | None = None
    'Estimated relative error of the pull-off force.'
    work_of_separation: float | None = None
    'Estimated relative error of the work of separation.'
    hysteresis: float | None = None
    'Estimated relative error of the hysteresis.'

class CycleError(NamedTuple):
    numerical: float
    'Estimated relative error of the numerical solution: the sum of the next three; the whole object is None where the cycle has no such figure.'
    levels: float
    'Part of it from the discrete positions of the fronts on pillar tops.'
    rim_angles: float
    'Part of it from the angular resolution along the rims.'
    degree: float
    'Part of it from the degree of the pressure on pillar tops.'
    model: float
    'Estimated relative error of the model: the sum of the next three.'
    model_fronts: float
    'Part of it from the possible shapes of the fronts.'
    model_columns: float
    'Part of it because columns do not tilt under eccentric tension as real pillars do.'
    model_corners: float
    'Part of it because the stress at the corners of elastic pillars is less singular than that at the rim of a flat punch: the increase for flaws of 1 % of the radius at the rims.'

class CycleErrors(NamedTuple):
    critical_force: CycleError | None = None
    '`CycleError` with numerical, levels, rim_angles, degree, model, model_fronts, model_columns, model_corners.'
    critical_indentation: CycleError | None = None
    '`CycleError` with numerical, levels, rim_angles, degree, model, model_fronts, model_columns, model_corners.'
    pull_off_force: CycleError | None = None
    '`CycleError` with numerical, levels, rim_angles, degree, model, model_fronts, model_columns, model_corners.'
    hysteresis: CycleError | None = None
    '`CycleError` with numerical, levels, rim_angles, degree, model, model_fronts, model_columns, model_corners.'

class FlatCycleErrors(NamedTuple):
    turn_force: float
    'Estimated relative error of the force at the end of loading.'
    pull_off_force: float | None = None
    'Estimated relative error of the pull-off force.'
    hysteresis: float | None = None
    'Estimated relative error of the hysteresis.'

class HistoryEnd(NamedTuple):
    time: float
    'Time at the end (s).'
    indentation: float
    'Indentation at the end (m).'
    force: float
    'Force at the end (N).'
    contact_radius: float | None = None
    'Contact radius at the end (m); None under a plate.'
    floor_share: float | None = None
    'Floor force over total force at the end; None without a floor.'

class HistoryEquilibrium(NamedTuple):
    indentation: float
    'Indentation in equilibrium, if the last load is held (m).'
    force: float
    'Force in equilibrium (N).'
    contact_radius: float | None = None
    'Contact radius in equilibrium (m); None under a plate.'
    floor_share: float | None = None
    'Floor force over total force in equilibrium; None without a floor.'

class HistoryErrors(NamedTuple):
    force: float
    'Estimated error of the forces, relative to the largest.'
    indentation: float
    'Estimated error of the indentations, relative to the largest.'

class FloorNumbers(Numbered):
    force: Number[float]
    'Force on the floor (N).'
    share: Number[float]
    'Floor force over total force.'
    contact_area: Number[float]
    'Contact area on the floor (m^2).'
    radius: Number[float]
    'Distance between the lens axis and the farthest floor contact (m).'
    smallest_distance_to_rim: Number[float]
    'Smallest distance between the floor contact and the rim of a pillar (m).'
    patches: Number[int | None]
    'Number of separate floor contacts; None if two grids differ.'
    cell: Number[tuple[float, float]]
    'Cell sides of the floor pressure (m); the cells rotate with the lattice.'
    error: Number[FloorErrors]
    '`FloorErrors` with share, contact_area.'

class Critical(Answer):
    regime: Number[str]
    '`top_first`, or `bottom_first` if the lens reaches the floor before any pillar.'
    force: Number[float]
    'Force at which the lens just reaches the floor, F_c (N).'
    indentation: Number[float]
    'Indentation at which the lens just reaches the floor, ζ_c (m).'
    floor_contact: Number[tuple[float, float]]
    'Position of the floor contact relative to the lens axis (m); under a plate, which has no axis, in the coordinates of the grid.'
    friction: Number[Friction | None]
    '`Friction` with lateral_force, tops_force, floor_force, floor_share, tops_contact_area, floor_contact_area, error.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class Contact(Answer):
    force: Number[float]
    'Normal force on the lens, F (N).'
    indentation: Number[float]
    'Displacement of the lens from the position in which its lowest point is level with the pillar tops, ζ (m).'
    friction: Number[Friction | None]
    '`Friction` with lateral_force, tops_force, floor_force, floor_share, tops_contact_area, floor_contact_area, error.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class PressNumbers(Contact):
    method: Number[str]
    '`spectral`, `love`, `punch` or `homogenised`.'
    lens_shape: Number[str]
    'Shape of the lens, as `lens.shape` in case files.'
    contact_radius: Number[float]
    'Distance between the lens axis and the farthest point in contact, on a pillar top or on the floor, a (m); None under a plate.'
    top_contact_radius: Number[float]
    'Distance between the lens axis and the farthest point in contact on a pillar top (m).'
    pillars_in_contact: Number[int]
    'Number of pillars in contact.'
    pillars_partially_in_contact: Number[int]
    'Number of pillars that the edge of the contact crosses.'
    smallest_floor_gap: Number[float]
    'Smallest gap between lens and floor (m); beyond the transition 0, or negative if the floor is ignored; under a cylinder or a plate, the gap to the undeformed lens between the outermost pillars.'
    beyond_transition: Number[bool]
    'Whether the lens has reached the floor, or would have if the floor were not ignored.'
    error: Number[ErrorEstimate]
    '`ErrorEstimate` with force, indentation, contact_radius.'
    iterations: Number[int]
    'Solver iterations.'

class TransitionNumbers(Critical):
    method: Number[str]
    '`spectral`, `love`, `punch` or `homogenised`.'
    lens_shape: Number[str]
    'Shape of the lens, as `lens.shape` in case files.'
    surface_fraction: Number[float]
    'Surface fraction of the pillar tops, φ.'
    pitch: Number[float]
    'Distance between neighbouring pillars, e (m).'
    contact_radius: Number[float]
    'The larger of `top_contact_radius` and the distance between the lens axis and the floor contact, a_c (m).'
    top_contact_radius: Number[float]
    'Distance between the lens axis and the farthest point in contact on a pillar top (m).'
    pillars_in_contact: Number[int]
    'Number of pillars in contact.'
    pillars_partially_in_contact: Number[int]
    'Number of pillars that the edge of the contact crosses.'
    normalized: Number[Normalized]
    '`Normalized` with force, contact_radius, indentation.'
    error: Number[ErrorEstimate]
    '`ErrorEstimate` with force, indentation, contact_radius, top_contact_radius.'
    iterations: Number[int]
    'Solver iterations.'

class SurfacePressNumbers(Contact):
    method: Number[str]
    '`love`: elements.'
    tops: Number[SurfacePressTops | None]
    '`SurfacePressTops` with force, contact_area.'
    floor: Number[SurfacePressFloor | None]
    '`SurfacePressFloor` with force, contact_area.'
    contact_area: Number[float]
    'Area of the cells in contact, A (m^2).'
    contact_radius: Number[float | None]
    'Distance between the lens axis and the farthest point in contact, on a pillar top or on the floor, a (m); None under a plate.'
    indenter: Number[str]
    '`lens` or `plate`.'
    lens_shape: Number[str]
    'Shape of a lens.'
    boundary: Number[str]
    '`free` or `periodic`.'
    grid: Number[Grid]
    '`Grid` with columns, rows, cell, origin.'
    error: Number[ErrorEstimate | None]
    '`ErrorEstimate` with force, indentation, contact_radius, contact_area.'
    certificate: Number[Certificate]
    '`Certificate` with energy_bound, interpenetration, gap_under_pressure.'
    iterations: Number[int]
    'Solver iterations on the last grid.'

class SurfaceTransitionNumbers(Critical):
    method: Number[str]
    '`love`: elements.'
    contact_area: Number[float]
    'Area of the cells in contact, A (m^2).'
    contact_radius: Number[float | None]
    'Distance between the lens axis and the farthest point in contact, on a pillar top or on the floor, a (m); None under a plate.'
    indenter: Number[str]
    '`lens` or `plate`.'
    lens_shape: Number[str]
    'Shape of a lens.'
    boundary: Number[str]
    '`free` or `periodic`.'
    grid: Number[Grid]
    '`Grid` with columns, rows, cell, origin.'
    error: Number[ErrorEstimate | None]
    '`ErrorEstimate` with force, indentation, contact_radius, contact_area.'
    certificate: Number[Certificate]
    '`Certificate` with energy_bound, interpenetration, gap_under_pressure.'
    iterations: Number[int]
    'Solver iterations on the last grid.'

class AsperityPressNumbers(Contact):
    method: Number[str]
    '`spectral`.'
    indenter: Number[str]
    '`lens` or `plate`.'
    lens_shape: Number[str]
    'Shape of a lens.'
    contact_area: Number[float]
    'Area of all contacts on tops, A (m^2).'
    contact_radius: Number[float | None]
    'Distance between the lens axis and the farthest point in contact, on a pillar top or on the floor, a (m); None under a plate.'
    pillars: Number[int]
    'Number of pillars.'
    pillars_in_contact: Number[int]
    'Number of pillars in contact.'
    pillars_fully_in_contact: Number[int]
    'Number of pillars whose top is in contact up to the rim.'
    largest_top_contact_radius: Number[float]
    'Radius of the largest contact on a top (m).'
    largest_pillar_force: Number[float]
    'Largest force on a pillar (N).'
    smallest_floor_gap: Number[float | None]
    'Smallest gap between lens and floor (m); past the transition 0, or negative where the load of the floor is not computed; None under a plate and a cylinder, which are closest to it outside the pillars, and where pillars cover all of it.'
    stiffness: Number[float]
    'Change of the force with the indentation (N/m).'
    left_out: Number[list[str]]
    'Effects that are not computed.'
    floor_out_of_reach: Number[bool]
    'Whether the floor is certainly not reached.'
    error: Number[AsperityErrors | None]
    '`AsperityErrors` with force, contact_area, indentation_m.'
    iterations: Number[int]
    'Solver iterations.'

class AsperityTransitionNumbers(Critical):
    method: Number[str]
    '`spectral`.'
    indenter: Number[str]
    '`lens` or `plate`.'
    lens_shape: Number[str]
    'Shape of a lens.'
    contact_radius: Number[float]
    'The larger of `top_contact_radius` and the distance between the lens axis and the floor contact, a_c (m).'
    top_contact_radius: Number[float]
    'Distance between the lens axis and the farthest point in contact on a pillar top (m).'
    contact_area: Number[float]
    'Area of all contacts on tops, A (m^2).'
    pillars: Number[int]
    'Number of pillars.'
    pillars_in_contact: Number[int]
    'Number of pillars in contact.'
    pillars_fully_in_contact: Number[int]
    'Number of pillars whose top is in contact up to the rim.'
    largest_top_contact_radius: Number[float]
    'Radius of the largest contact on a top (m).'
    largest_pillar_force: Number[float]
    'Largest force on a pillar (N).'
    smallest_floor_gap: Number[float | None]
    'Smallest gap between lens and floor (m); past the transition 0, or negative where the load of the floor is not computed; None under a plate and a cylinder, which are closest to it outside the pillars, and where pillars cover all of it.'
    stiffness: Number[float]
    'Change of the force with the indentation (N/m).'
    left_out: Number[list[str]]
    'Effects that are not computed.'
    error: Number[AsperityErrors | None]
    '`AsperityErrors` with force, contact_area, indentation_m.'
    iterations: Number[int]
    'Solver iterations.'

class AsperityCycleNumbers(Answer):
    method: Number[str]
    '`spectral`.'
    drive: Number[str]
    'Loading mode, the quantity that is constant during a jump: `displacement`, `force` or `machine`.'
    first_contact_indentation: Number[float | None]
    'Indentation at first contact (m).'
    first_contact_force: Number[float | None]
    'Force after first contact (N).'
    zero_load_indentation: Number[float | None]
    'Equilibrium indentation without load (m).'
    turn_force: Number[float]
    'Force at the end of loading (N).'
    turn_indentation: Number[float]
    'Indentation at the end of loading (m).'
    turn_contact_area: Number[float]
    'Area of all contacts at the end of loading (m^2).'
    turn_pillars_in_contact: Number[int]
    'Pillars in contact at the end of loading.'
    pull_off_force: Number[float | None]
    'Largest tensile force on unloading, negative (N); None if there is none.'
    pull_off_indentation: Number[float | None]
    'Indentation at pull-off (m).'
    pull_off_contact_area: Number[float | None]
    'Area of all contacts at pull-off (m^2).'
    pull_off_pillars_in_contact: Number[int | None]
    'Pillars in contact at pull-off.'
    last_release_indentation: Number[float | None]
    'Indentation at which the last pillar detaches (m); None without unloading.'
    work_of_separation: Number[float | None]
    'Work against tensile forces during unloading (J); None under a prescribed force, where the lens leaves at once.'
    hysteresis: Number[float | None]
    'Area of the loop of force over indentation (J); None for a path that is not closed.'
    dissipation: Number[float]
    'Energy dissipated by all events, summed independently (J).'
    certificate: Number[float | None]
    'Relative difference of `dissipation` from `hysteresis`.'
    error: Number[AsperityCycleErrors]
    '`AsperityCycleErrors` with turn_force, pull_off_force, hysteresis.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class SurfaceCycleNumbers(Answer):
    method: Number[str]
    '`love`: elements.'
    drive: Number[str]
    'Loading mode, the quantity that is constant during a jump: `displacement`.'
    first_contact_indentation: Number[float | None]
    'Indentation at first contact (m).'
    first_contact_force: Number[float | None]
    'Force after first contact (N).'
    turn_force: Number[float]
    'Force at the end of loading (N).'
    turn_indentation: Number[float]
    'Indentation at the end of loading (m).'
    turn_contact_area: Number[float]
    'Contact area at the end of loading (m^2).'
    pull_off_force: Number[float | None]
    'Largest tensile force on unloading, negative (N); None if there is none.'
    pull_off_indentation: Number[float | None]
    'Indentation at pull-off (m).'
    pull_off_contact_area: Number[float | None]
    'Contact area at pull-off (m^2).'
    last_release_indentation: Number[float | None]
    'Indentation at which the surfaces detach (m); None without unloading.'
    work_of_separation: Number[float | None]
    'Work against tensile forces during unloading (J); None without unloading.'
    hysteresis: Number[float | None]
    'Area of the loop of force over indentation (J); None without unloading.'
    error: Number[SurfaceCycleErrors]
    '`SurfaceCycleErrors` with turn_force, pull_off_force, work_of_separation, hysteresis.'
    indenter: Number[str]
    '`lens` or `plate`.'
    lens_shape: Number[str]
    'Shape of a lens.'
    boundary: Number[str]
    '`free` or `periodic`.'
    grid: Number[Grid]
    '`Grid` with columns, rows, cell, origin.'
    friction: Number[Friction | None]
    '`Friction` with lateral_force, tops_force, floor_force, floor_share, tops_contact_area, floor_contact_area, error.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class CycleNumbers(Answer):
    method: Number[str]
    '`spectral`.'
    surface_fraction: Number[float]
    'Surface fraction of the pillar tops, φ.'
    pitch: Number[float]
    'Distance between neighbouring pillars, e (m).'
    work_of_adhesion: Number[float]
    'Energy per area released when contact forms, w (J/m^2).'
    receding_work_of_adhesion: Number[float]
    'Energy per area required to separate the contact (J/m^2).'
    drive: Number[str]
    'Loading mode, the quantity that is constant during a jump: `displacement`, `force` or `machine`.'
    machine_stiffness: Number[float | None]
    'Stiffness of the machine, if the loading mode is `machine` (N/m).'
    first_contact_indentation: Number[float | None]
    'Indentation at first contact (m).'
    first_contact_force: Number[float | None]
    'Force after first contact (N).'
    zero_load_indentation: Number[float | None]
    'Equilibrium indentation of a lens without load (m).'
    critical_force: Number[float | None]
    'Critical force, F_c (N); None, as the whole critical state, if the loading does not reach it.'
    critical_indentation: Number[float | None]
    'Critical indentation, ζ_c (m).'
    critical_contact_radius: Number[float | None]
    'Critical contact radius, a_c (m).'
    critical_pillars_in_contact: Number[int | None]
    'Pillars in contact in the critical state.'
    critical_pillars_partially_in_contact: Number[int | None]
    'Those of them that are in contact in part.'
    turn_force: Number[float]
    'Force at the end of loading (N).'
    turn_indentation: Number[float]
    'Indentation at the end of loading (m).'
    turn_contact_radius: Number[float]
    'Contact radius at the end of loading (m).'
    turn_pillars_in_contact: Number[int]
    'Pillars in contact at the end of loading.'
    turn_pillars_partially_in_contact: Number[int]
    'Those of them that are in contact in part.'
    stopped_by_floor: Number[bool]
    'Always `false`: loading continues on the floor.'
    pull_off_force: Number[float | None]
    'Largest tensile force on unloading, negative (N); None if there is none.'
    pull_off_indentation: Number[float | None]
    'Indentation at pull-off (m).'
    pull_off_pillars_in_contact: Number[int | None]
    'Pillars in contact at pull-off.'
    kendall_pull_off_force: Number[float]
    'Pull-off force of a single pillar of the common diameter with a flat top (Kendall) (N).'
    normalized_pull_off_force: Number[float | None]
    'Pull-off force over that of a single pillar of the common diameter: the equivalent number of independent pillars.'
    last_release_indentation: Number[float | None]
    'Indentation at which the last pillar detaches (m); None if something is still in contact.'
    work_of_separation: Number[float | None]
    'Work against tensile forces during unloading (J); None under a prescribed force, where the lens leaves at once.'
    hysteresis: Number[float | None]
    'Area of the loop of force over indentation (J); None for a path that is not closed, and under a prescribed force.'
    normalized_hysteresis: Number[float | None]
    'Hysteresis over the receding work of adhesion times the largest top area that was in contact; 2 (1 + κ) for flat pillars that detach one by one.'
    dissipation: Number[float]
    'Energy dissipated by all events, summed independently (J).'
    certificate: Number[float | None]
    'Relative difference of `dissipation` from the area of the loop; None for a path that is not closed.'
    kendall_strain: Number[float]
    'Tensile stress on a pillar at its detachment over the modulus of the substrate.'
    error: Number[CycleErrors]
    '`CycleErrors` with critical_force, critical_indentation, pull_off_force, hysteresis.'
    friction: Number[Friction | None]
    '`Friction` with lateral_force, tops_force, floor_force, floor_share, tops_contact_area, floor_contact_area, error.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class FlatPressNumbers(Contact):
    method: Number[str]
    '`disc`.'
    lens_shape: Number[str]
    '`sphere`, `paraboloid`, `profile` or `punch`.'
    contact_radius: Number[float | None]
    'Distance between the lens axis and the farthest point in contact, on a pillar top or on the floor, a (m); None under a plate.'
    contact_area: Number[float]
    'Contact area, A (m^2).'
    mean_pressure: Number[float]
    'Force over contact area (Pa); 0 without contact.'
    stiffness: Number[float | None]
    'Change of the force with the indentation on loading (N/m); None where it is infinite.'
    pressure_on_axis: Number[float]
    'Pressure on the lens axis: the largest under a lens without adhesion (Pa).'
    punch_stiffness: Number[float]
    'Change of the force with the indentation at a fixed contact radius: the initial slope on unloading (N/m).'
    error: Number[ErrorEstimate]
    '`ErrorEstimate` with force, indentation, contact_radius.'

class FlatCycleNumbers(Answer):
    drive: Number[str]
    '`displacement`, `force` or `machine`.'
    first_contact_indentation: Number[float]
    'Indentation after the jump into contact (m).'
    first_contact_force: Number[float]
    'Force after the jump into contact (N).'
    turn_force: Number[float]
    'Force at the end of loading (N).'
    turn_indentation: Number[float]
    'Indentation at the end of loading (m).'
    turn_contact_radius: Number[float]
    'Contact radius at the end of loading (m).'
    pull_off_force: Number[float | None]
    'Largest tensile force on unloading, negative (N); None without unloading.'
    pull_off_indentation: Number[float | None]
    'Indentation at pull-off (m).'
    pull_off_contact_radius: Number[float | None]
    'Contact radius at pull-off (m).'
    last_release_indentation: Number[float | None]
    'Indentation at which the surfaces detach (m); None without unloading.'
    work_of_separation: Number[float | None]
    'Work against tensile forces during unloading (J); None under a prescribed force, where the lens leaves at once.'
    hysteresis: Number[float | None]
    'Area of the loop of force over indentation (J); None for a path that is not closed.'
    error: Number[FlatCycleErrors]
    '`FlatCycleErrors` with turn_force, pull_off_force, hysteresis.'
    friction: Number[Friction | None]
    '`Friction` with lateral_force, tops_force, floor_force, floor_share, tops_contact_area, floor_contact_area, error.'
    converged: Number[bool]
    'Whether the solver converged.'
    unresolved: Number[str | None]
    'A quantity whose estimated relative error is above 0.5, if any; the command then ends with exit status 1.'

class HistoryNumbers(Answer):
    time_to_floor_contact: Number[float | None]
    'Time at which the lens reaches the floor, in the protocol or later if its last load is held (s); None if it never does, or without a floor.'
    time_to_equilibrium: Number[float | None]
    'Time from which force and indentation stay within 1 % of equilibrium, in the protocol or later if its last load is held (s); None if that is later and the contact has receded.'
    critical_force: Number[float | None]
    'Critical force of slow loading, at the relaxed modulus, F_c (N); None without a floor.'
    critical_indentation: Number[float | None]
    'Critical indentation, the same at every rate, ζ_c (m); None without a floor.'
    instantaneous_modulus_ratio: Number[float]
    'Instantaneous modulus over relaxed modulus.'
    largest_force: Number[float]
    'Largest force of the history (N).'
    end: Number[HistoryEnd]
    '`HistoryEnd` with time, indentation, force, contact_radius, floor_share.'
    equilibrium: Number[HistoryEquilibrium]
    '`HistoryEquilibrium` with indentation, force, contact_radius, floor_share.'
    error: Number[HistoryErrors]
    '`HistoryErrors` with force, indentation.'
    converged: Number[bool]
    'Whether all elastic contacts converged.'
