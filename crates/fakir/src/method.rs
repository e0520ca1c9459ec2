//! The one place where a question goes to a method.

use crate::problem::scaled::Scene;
use crate::problem::{Accuracy, CyclePlan, Feature, Load, Method, Question, System};
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

/// The contact under what is prescribed, by the given method.
///
/// Past the transition the spectral method has the floor bear its part: [`ContactState::floor`]. By the other methods, and where the
/// [system](System::with_floor) ignores the floor, such a load is answered as if that were not there; the smallest floor gap is
/// then negative.
///
/// With [adhesion](System::adhesion) it is the contact on loading, from the first touch on, and the loading ends at the critical state unless
/// the floor is ignored. A force is that which is first borne; under none the lens rests where it snapped into contact.
///
/// # Errors
/// [`Unsupported`](crate::problem::Unsupported) of what the method does not solve. A load that cannot be, a contact too large for the lens or for memory, or interruption:
/// see [`SolveError`]. A solution that did not converge is not an error: it says so in
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

/// The contact under what is prescribed with its exact derivatives with respect to the quantities of the system, by the spectral method without
/// adhesion, as long as the floor bears nothing. It takes about as long as [`press`]; of a critical state, a linear solution more.
///
/// ```
/// use fakir::problem::{Load, Method, Quantity};
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, Texture};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, Texture::new(pillar, lattice))?;
/// let gradient = fakir::gradient(&system, Load::FloorContact, Method::default(), &Run::default())?;
/// let force = gradient.force.ok_or("it is prescribed")?;
/// let by_height = force.by(Quantity::PillarHeight).ok_or("it is not known")?; // N/m
/// // The critical force grows faster than the height.
/// assert!(by_height * system.pillar().height > gradient.contact.force);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::NoGradient`] where nothing is touched, where the lens touches a part of one pillar top alone, where the floor bears a part of
/// the load, and of a contact that did not converge; and as [`press`].
pub fn gradient(
    system: &System,
    control: Load,
    method: Method,
    run: &Run<'_>,
) -> Result<Gradient, SolveError> {
    let control = checked_control(system, control)?;
    let features = Feature::of(system);
    if control == Load::FloorContact {
        Question::Transition.check(method.into(), &features)?;
    }
    Question::Gradient.check(method.into(), &features)?;
    let accuracy = accuracy_of(method);
    let mut gradient = gradient::gradient(system, control, accuracy, run)?;
    check_reach(&gradient.contact)?;
    gradient.contact = with_layer_warnings(gradient.contact);
    gradient.checked()
}

/// The critical state, in which the lens just reaches the floor, by the given method: [`press`] with
/// [`Load::FloorContact`], and where the floor is touched.
///
/// Where the lens reaches the floor before any pillar, that is a valid answer: the critical
/// indentation is the pillar height and the critical force zero.
///
/// # Errors
/// As [`press`].
pub fn transition(
    system: &System,
    method: Method,
    run: &Run<'_>,
) -> Result<CriticalState, SolveError> {
    let contact = press(system, Load::FloorContact, method, run)?;
    CriticalState::new(contact).checked()
}

/// The contacts past a critical state of the spectral method in which the floor bears these parts of the force. Each takes about as long as one under a
/// prescribed force; in rising order every one tells where to look for the next. Where pillars are touched one after the other there may be several contacts of one share, and one of them
/// is found.
///
/// ```
/// use fakir::problem::Method;
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, Texture};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, Texture::new(pillar, lattice))?;
/// let critical = fakir::transition(&system, Method::default(), &Run::default())?;
/// for contact in fakir::press_to_floor_shares(&critical, &[0.2, 0.4], &Run::default())? {
///     assert!(contact.converged() && contact.force > critical.contact.force);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SolveError::NoFloorShare`] where a share is not between 0 and 1, or the floor is reached before any pillar; and as [`press`].
pub fn press_to_floor_shares(
    critical: &CriticalState,
    shares: &[f64],
    run: &Run<'_>,
) -> Result<Vec<ContactState>, SolveError> {
    let CriticalState { contact, .. } = critical;
    let system = &contact.system;
    Question::FloorShare.check(contact.method.into(), &Feature::of(system))?;
    let refused = |why| Err(SolveError::NoFloorShare { why });
    if !shares.iter().all(|share| *share > 0.0 && *share < 1.0) {
        return refused("it has to be between 0 and 1 (100 %), without these");
    }
    let accuracy = accuracy_of(contact.method);
    if !(contact.converged() && contact.force > 0.0) {
        return refused("it takes a critical state that converged, in which pillars are touched");
    }
    let states = answers::press_to_floor_shares(contact, shares, accuracy, run)?;
    states.into_iter().map(finished).collect()
}

/// A cycle of loading and unloading, with its events in order: [adhesion](System::adhesion) makes unloading another path than
/// loading, which ends with a pull.
///
/// ```
/// use fakir::problem::{Adhesion, CyclePlan, Method};
/// use fakir::state::Run;
/// # use fakir::problem::{HexagonalLattice, Lens, Material, Pillar, PillarCompliance, System, Texture};
/// # let rubber = Material::new(2.0e6, 0.5);
/// # let pillar = Pillar { diameter: 6.0e-6, height: 2.2e-6, compliance: PillarCompliance::Column };
/// # let lattice = HexagonalLattice::with_surface_fraction(0.01, pillar.diameter);
/// # let lens = Lens { radius: 2.2e-3, material: rubber };
/// # let system = System::new(lens, rubber, Texture::new(pillar, lattice))?;
/// let system = system.with_adhesion(Adhesion::new(50e-3))?; // J/m^2
/// let cycle = fakir::cycle(&system, CyclePlan::default(), Method::default(), &Run::default())?;
/// let pull_off = cycle.pull_off.as_ref().ok_or("nothing pulls")?;
/// assert!((pull_off.force / -34.2e-6 - 1.0).abs() < 1e-2); // N
/// assert_eq!(pull_off.pillars.len(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A plan that cannot be, a system in which nothing sticks, and as [`press`]. A path that does not converge is not an error: it says so in
/// [`Cycle::termination`].
pub fn cycle(
    system: &System,
    plan: CyclePlan,
    method: Method,
    run: &Run<'_>,
) -> Result<Cycle, SolveError> {
    follow_cycle(system, plan, method, run, &|_| {})
}

/// [`cycle`], and every station told as the lens passes it, with what is in contact there for whoever asks: for pictures that follow
/// the lens. Where the path does not converge, not all that was told is in [`Cycle::stations`].
///
/// # Errors
/// As [`cycle`].
pub fn follow_cycle(
    system: &System,
    plan: CyclePlan,
    method: Method,
    run: &Run<'_>,
    follower: &dyn Fn(&Passage<'_>),
) -> Result<Cycle, SolveError> {
    let plan = plan.checked(0.5 * system.pillar().diameter, system.reduced_modulus())?;
    if system.adhesion().is_none() {
        return Err(SolveError::NothingSticks);
    }
    Question::Cycle.check(method.into(), &Feature::of(system))?;
    let cycle = adhesive::cycle(system, plan, accuracy_of(method), run, follower)?;
    check_reach(&cycle.turn)?;
    cycle.checked()
}

/// What is prescribed, if it can be. An indentation counts from the common height and may be negative as far as pillars are higher than that.
fn checked_control(system: &System, control: Load) -> Result<Load, SolveError> {
    if let Load::Indentation(indentation) = control
        && indentation < 0.0
        && indentation >= -Scene::new(system).highest()
    {
        return Ok(control);
    }
    let length = 0.5 * system.pillar().diameter;
    Ok(control.checked(length, system.reduced_modulus())?)
}

/// A state without adhesion as it is handed out.
fn finished(state: ContactState) -> Result<ContactState, SolveError> {
    check_reach(&state)?;
    with_layer_warnings(state).checked()
}

/// With what is to be said where bodies are layers.
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

/// Refuses a state that reaches too far from the axis of the lens: a contact beyond half its radius, and a lowest point of the floor beyond its table of
/// heights, where its gap is not known.
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

/// The accuracy of the spectral method; of others that of the default.
fn accuracy_of(method: Method) -> Accuracy {
    match method {
        Method::Spectral(accuracy) => accuracy,
        Method::Punch(_) | Method::Love(_) | Method::Homogenised => Accuracy::default(),
    }
}
