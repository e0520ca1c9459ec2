//! A contact radius without the jumps from one ring of pillars to the next, for derivatives.

use fakir::problem::{Arrangement, System};
use fakir::state::ContactState;

/// Square of the contact radius over the mean square of the distances of the pillars from the lens axis, weighted by their forces: 5/2 on a
/// dense pattern, where the pressure is Hertzian, and 3 if pillars deform independently and the force decreases linearly with the square of
/// the distance. Another value would change the weights of measured radii, not the result for data without errors.
const SPREAD: f64 = 2.75;

/// Radius, m, of a disc whose pressure has the same second moment as the forces on the pillars. It changes without jumps, because the force on a pillar
/// starts from zero at contact. It is limited to the farthest pillar, as the contact radius is.
pub(super) fn smooth_radius(contact: &ContactState) -> f64 {
    if contact.pillars.is_empty() {
        return contact.contact_radius;
    }
    let (mut force, mut moment) = (0.0, 0.0);
    for pillar in &contact.pillars {
        let [x, y] = pillar.centre;
        force += pillar.force;
        moment += pillar.force * (x * x + y * y);
    }
    let single = 0.5 * contact.system.pillar().diameter;
    if force <= 0.0 {
        return single;
    }
    (SPREAD * moment / force + single * single)
        .sqrt()
        .min(farthest_rim(&contact.system))
}

/// Distance from the lens axis to the farthest rim of a pillar, m; infinite on an infinite lattice.
fn farthest_rim(system: &System) -> f64 {
    let away = |[x, y]: [f64; 2]| x.hypot(y);
    match system.arrangement() {
        Arrangement::Lattice(lattice) => {
            let Some([first, end]) = lattice.ends() else {
                return f64::INFINITY;
            };
            let ([a, b], origin) = (lattice.vectors(), lattice.origin());
            let sides = [first, end - 1].map(|side| side as f64);
            let corners = sides
                .iter()
                .flat_map(|i| sides.map(|j| away([0, 1].map(|k| origin[k] + i * a[k] + j * b[k]))));
            corners.fold(0.0, f64::max) + 0.5 * system.pillar().diameter
        }
        Arrangement::Listed(list) => {
            let pillars = list.pillars().iter();
            let rims = pillars.map(|pillar| away(pillar.centre) + 0.5 * pillar.diameter);
            rims.fold(0.0, f64::max)
        }
        _ => f64::INFINITY,
    }
}
