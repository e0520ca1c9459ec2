//! Dispatches questions to methods.

use crate::problem::scaled::Scene;
use crate::problem::{
    Accuracy, CyclePlan, Feature, Load, Method, Quantity, Question, System, UnloadingPoint,
    Unsupported,
};
use crate::solve::adhesive;
use crate::solve::answers;
use crate::solve::assembled::PillarMethod;
use crate::solve::gradient;
use crate::solve::homogenised;
use crate::state::limit::{DEEPEST_IN_LAYER, THINNEST_LAYER};
use crate::state::{
    ContactState, CriticalState, Cycle, Gradient, Passage, Run, SolveError, Warning,
};
use crate::theory;

/// Computes the contact under a prescribed load with the given method.
///
/// Past the transition, the spectral method includes the load carried by the floor: [`ContactState::floor`]. In the other methods, and if
/// the [system](System::with_floor) ignores floor contact, the state is computed as if there were no floor; the smallest floor gap is then
/// negative.
///
/// With [adhesion](System::adhesion) the result is the contact during loading, from first touch on. For a prescribed force, it is the first state that reaches this force; for zero force, the lens is in
/// equilibrium where it jumped into contact.
///
/// # Errors
/// [`Unsupported`](crate::problem::Unsupported) if the method does not support the problem. An invalid load, a contact too large for the
/// lens or for the memory limit, or cancellation: see [`SolveError`]. A solution that did not converge is not an error: see
/// [`ContactState::termination`].
pub fn press(
    system: &System,
    control: Load,
    method: Method,
    run: &Run<'_>,
) -> Result<ContactState, SolveError> {
    let control = checked_control(system, control)?;
    let question = match control {
        Load::FloorContact => Question::Transition,
        Load::Indentation(_) | Load::Force(_) => Question::Press,
    };
    question.check(method.into(), &Feature::of(system))?;
    match method {
        Method::Spectral(accuracy) if !system.adhesion().is_none() => {
            let state = adhesive::press(system, control, accuracy, run)?;
            check_reach(&state)?;
            return state.checked();
        }
        Method::Spectral(accuracy) => {
            answers::press(system, control, PillarMethod::Spectral(accuracy), run)
        }
        Method::Punch(form) => answers::press(system, control, PillarMethod::Punch(form), run),
        Method::Love(mesh) => answers::press(system, control, PillarMethod::Love(mesh), run),
        Method::Homogenised => homogenised::press(system, control, run),
    }
    .and_then(finished)
}

/// Computes the contact under a prescribed load with its exact derivatives with respect to the quantities of the system, by the spectral
/// method without adhesion. It takes about as long as [`press`]; for a critical state and past the transition, one more linear solution is
/// required.
///
/// ```
/// use fakir::problem::{Load, Method, Quantity};
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, PillarPattern};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
/// let gradient = fakir::gradient(&system, Load::FloorContact, Method::default(), &Run::default())?;
/// let force = gradient.force.ok_or("it is prescribed")?;
/// let by_height = force.by(Quantity::PillarHeight).ok_or("it is not known")?; // N/m
/// // The critical force grows faster than the height.
/// assert!(by_height * system.pillar().height > gradient.contact.force);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::NoGradient`] without contact, for contact with a part of a single pillar top, for a lens that penetrates a floor which
/// carries no load, and for a contact that did not converge; and as for [`press`].
pub fn gradient(
    system: &System,
    control: Load,
    method: Method,
    run: &Run<'_>,
) -> Result<Gradient, SolveError> {
    checked_gradient(system, control, method, None, run)
}

/// [`gradient`] with at least the derivatives with respect to some quantities. With load on the floor, those with respect to pitch and diameter take
/// about half of the time of all derivatives, and are left out unless one of the two is `wanted`.
///
/// # Errors
/// As [`gradient`].
pub fn gradient_by(
    system: &System,
    control: Load,
    method: Method,
    wanted: &[Quantity],
    run: &Run<'_>,
) -> Result<Gradient, SolveError> {
    checked_gradient(system, control, method, Some(wanted), run)
}

fn checked_gradient(
    system: &System,
    control: Load,
    method: Method,
    wanted: Option<&[Quantity]>,
    run: &Run<'_>,
) -> Result<Gradient, SolveError> {
    let control = checked_control(system, control)?;
    let features = Feature::of(system);
    if control == Load::FloorContact {
        Question::Transition.check(method.into(), &features)?;
    }
    Question::Gradient.check(method.into(), &features)?;
    let accuracy = accuracy_of(method);
    let mut gradient = gradient::gradient(system, control, accuracy, wanted, run)?;
    check_reach(&gradient.contact)?;
    gradient.contact = with_layer_warnings(gradient.contact);
    gradient.checked()
}

/// Computes the critical state, in which the lens first touches the floor, with the given method: [`press`] with [`Load::FloorContact`],
/// and the position of the floor contact.
///
/// If the lens reaches the floor before any pillar, this is a valid result: the critical indentation is the pillar height and the critical
/// force is zero.
///
/// # Errors
/// As for [`press`].
pub fn transition(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<CriticalState, SolveError> {
    let contact = press(system, Load::FloorContact, method, run)?;
    CriticalState::new(contact).checked()
}

/// Computes the contacts past a critical state of the spectral method in which the floor carries these fractions of the load. Each takes
/// about as long as one under a prescribed force; in increasing order, each provides the initial guess for the next. If pillars come into
/// contact one after the other, there may be several contacts for one fraction, one of which is found.
///
/// ```
/// use fakir::problem::Method;
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, PillarPattern};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
/// let critical = fakir::transition(&system, Method::default(), &Run::default())?;
/// for contact in fakir::press_to_floor_shares(&critical, &[0.2, 0.4], &Run::default())? {
///     assert!(contact.converged() && contact.force > critical.contact.force);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::NoFloorShare`] if a fraction is not between 0 and 1, or if the floor is reached before any pillar; and as for [`press`].
pub fn press_to_floor_shares(
    critical: &CriticalState,
    shares: &[f64],
    run: &Run<'_>,
) -> Result<Vec<ContactState>, SolveError> {
    let CriticalState { contact, .. } = critical;
    let system = &contact.system;
    Question::FloorShare.check(contact.method.into(), &Feature::of(system))?;
    if !system.adhesion().is_none() {
        return Err(Unsupported::SHARES_OF_ADHESIVE_TOPS.into());
    }
    let refused = |why| Err(SolveError::NoFloorShare { why });
    if !shares.iter().all(|share| *share > 0.0 && *share < 1.0) {
        return refused("it must be between 0 and 1 (100 %), excluding both");
    }
    let accuracy = accuracy_of(contact.method);
    if !(contact.converged() && contact.force > 0.0) {
        return refused("a converged critical state in which pillars are touched is required");
    }
    let states = answers::press_to_floor_shares(contact, shares, accuracy, run)?;
    states.into_iter().map(finished).collect()
}

/// Computes a cycle of loading and unloading, with its events in order: due to [adhesion](System::adhesion), unloading follows a different
/// path than loading and ends in tension.
///
/// ```
/// use fakir::problem::{Adhesion, CyclePlan, Method};
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, PillarPattern};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, PillarPattern::new(pillar, lattice))?;
/// let system = system.with_adhesion(Adhesion::new(50e-3))?; // J/m^2
/// let cycle = fakir::cycle(&system, CyclePlan::default(), Method::default(), &Run::default())?;
/// let pull_off = cycle.pull_off.as_ref().ok_or("nothing pulls")?;
/// assert!((pull_off.force / -34.2e-6 - 1.0).abs() < 1e-2); // N
/// assert_eq!(pull_off.pillars.len(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An invalid plan, a system without adhesion, and as for [`press`]. A path that does not converge is not an error: see
/// [`Cycle::termination`].
pub fn cycle(
    system: &System,
    plan: CyclePlan,
    method: Method,
    run: &Run<'_>,
) -> Result<Cycle, SolveError> {
    follow_cycle(system, plan, method, run, &|_| {})
}

/// [`cycle`] with a callback for every load step, from which the contact can be computed: for animations. If the path does not converge,
/// [`Cycle::stations`] does not contain all of these load steps.
///
/// # Errors
/// As for [`cycle`].
pub fn follow_cycle(
    system: &System,
    plan: CyclePlan,
    method: Method,
    run: &Run<'_>,
    follower: &dyn Fn(&Passage<'_>),
) -> Result<Cycle, SolveError> {
    let plan = plan.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    if system.adhesion().is_none() {
        return Err(SolveError::NoAdhesion);
    }
    Question::Cycle.check(method.into(), &Feature::of(system))?;
    if let UnloadingPoint::Critical(_) = plan.turn {
        Question::Transition.check(method.into(), &Feature::of(system))?;
    }
    let cycle = adhesive::cycle(system, plan, accuracy_of(method), run, follower)?;
    check_reach(&cycle.turn)?;
    cycle.checked()
}

/// Validates the load. An indentation is relative to the common height, and may be negative if some pillars are higher or touched by the lower side
/// of a tilted plate.
fn checked_control(system: &System, control: Load) -> Result<Load, SolveError> {
    if let Load::Indentation(indentation) = control
        && indentation < 0.0
        && indentation >= system.first_touch().min(-Scene::new(system).highest())
    {
        return Ok(control);
    }
    let length = 0.5 * system.pillar().diameter;
    Ok(control.checked(length, system.reduced_modulus())?)
}

/// Completes a state without adhesion before it is returned.
pub(crate) fn finished(state: ContactState) -> Result<ContactState, SolveError> {
    check_reach(&state)?;
    with_layer_warnings(state).checked()
}

/// Adds the warnings for layers.
fn with_layer_warnings(mut state: ContactState) -> ContactState {
    let system = &state.system;
    let Some(thinnest) = system.thinnest_layer() else {
        return state;
    };
    let mut warnings = Vec::new();
    let (lens, force) = (system.lens(), state.force);
    if let (Some(layer), Some(sphere)) = (system.lens_layer(), lens.sphere()) {
        let response = theory::layer::LayerResponse::new(&lens.material, layer);
        let shift = -response.shift() * lens.material.plane_strain_compliance() * force
            / (std::f64::consts::PI * layer.thickness);
        let reduction = theory::layer::asperity_reduction(layer.thickness / sphere.radius);
        if shift > 0.0 {
            let deeper = reduction.map(|reduction| reduction * shift);
            warnings.push(Warning::FlatLens { deeper });
        }
    }
    let of_diameter = thinnest / system.largest_diameter();
    if of_diameter < THINNEST_LAYER {
        warnings.push(Warning::ThinLayer { ratio: of_diameter });
    }
    let strain = state.indentation / thinnest;
    if strain > DEEPEST_IN_LAYER {
        warnings.push(Warning::LayerStrain { ratio: strain });
    }
    state.warnings.extend(warnings);
    state
}

/// Refuses a state that extends too far from the axis of the lens: a contact beyond half its radius, or a lowest floor gap beyond its table
/// of heights, where the gap is undefined.
fn check_reach(state: &ContactState) -> Result<(), SolveError> {
    let lens = state.system.lens();
    let reach = match lens.profile() {
        Some(_) => {
            let [x, y] = state.smallest_gap_position;
            x.hypot(y)
        }
        None if lens.is_axisymmetric() => state.contact_radius,
        None => return Ok(()),
    };
    if reach > lens.largest_contact() {
        return Err(SolveError::beyond(lens, reach, 1.0));
    }
    Ok(())
}

/// The accuracy setting of the spectral method; the default for other methods.
fn accuracy_of(method: Method) -> Accuracy {
    match method {
        Method::Spectral(accuracy) => accuracy,
        Method::Punch(_) | Method::Love(_) | Method::Homogenised => Accuracy::default(),
    }
}
