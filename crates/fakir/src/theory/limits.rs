//! Validity limits of contacts, and effects that are not included in the model: closed-form estimates from the contact alone.

use super::layer::Layers;
use super::summits;
use crate::numerics::convergence::smaller;
use crate::problem::{
    AsperityArray, FlatSystem, HeightMap, Layer, Material, Method, PillarCompliance, ShapedLens,
    SurfaceSystem,
};
use crate::state::limit::{
    DEEPEST_IN_LAYER, DOUBTFUL_CONTACT, LARGEST_STRAIN, Limit, SMALLEST_TABOR_NUMBER,
    THINNEST_LAYER, WIDEST_ON_TOP, limits_of_adhesion,
};
use crate::state::{AsperityContact, ContactState, FlatContact, PillarState, SurfaceContact};
use std::f64::consts::PI;
use std::iter;

/// Ratio of the force on a pillar to its buckling force above which small imperfections are significant: a ratio of one half doubles them.
const LARGEST_BUCKLING: f64 = 0.5;

/// Ratio of contact radius to lens thickness above which a flat layer is inaccurate: asperities were compared with it by finite elements up
/// to 0.4.
const WIDEST_ON_LENS: f64 = 1.0;

/// Ratio of thickness to radius of a spherical asperity above which it is nearly a hemisphere and not represented by a flat layer: in
/// finite elements, its shift is smaller by a tenth, and by a quarter close to a ratio of one
/// ([`asperity_reduction`](super::layer::asperity_reduction)).
const THICKEST_CAP: f64 = 0.5;

/// Number of cells in contact below which elements do not resolve it: a disc of four cells across, the smallest number on a pillar.
const FEWEST_CELLS: f64 = 12.0;

/// Relative difference of compliance or force that is negligible compared with the uncertainty of moduli and lengths.
const SMALL: f64 = 0.01;

/// Largest error of critical forces compared with pillars with all their modes, with tilt and without: see [the problem](crate::problem).
const ELASTIC_ERRORS: [f64; 2] = [0.0017, 0.0033];

/// Mean square of the distance from the axis under Hertz's pressure, divided by the square of the contact radius (K. L. Johnson, Contact
/// Mechanics, sec. 4.2).
const HERTZ_SPREAD: f64 = 0.4;

/// The same of the pressure under a flat punch.
const PUNCH_SPREAD: f64 = 2.0 / 3.0;

impl ContactState {
    /// The validity limits of the model, and the corresponding values for this contact. `range` is that of the attraction (m), if tops are
    /// adhesive and it is known.
    ///
    /// Some have no threshold: they are effects that would change this contact. The evaluation takes microseconds.
    ///
    /// * `kendall_strain`, `tabor_number`: for adhesive tops ([kendall_strain](crate::problem::System::kendall_strain), [tabor_number](crate::problem::System::tabor_number)).
    /// * `slope`: of the lens at the edge of the contact; `contact_radius_over_lens_radius`.
    /// * `lens_table_error_over_indentation`, for a lens given by a table
    ///   ([`interpolation_error`](crate::problem::LensProfile::interpolation_error)), on every kind of surface.
    /// * `pillar_stress`: mean stress on the top of the pillar with the largest stress, divided by Young's modulus of the substrate.
    /// * `buckling`: force on a pillar divided by `pi^2 E_s I/h^2` with `I = pi d^4/64`, the buckling force of a pillar that is clamped at
    ///   its foot, with a top that can move sideways but not rotate (S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability, sec. 2.1).
    /// * `pillar_compliance`: relative difference of the compliance of a single pillar from that of an elastic one, if available. Close to
    ///   the transition, the relative change of the force is up to four times as large. For elastic pillars, `elastic_pillar_error`
    ///   instead: the largest error of a critical force that was found.
    /// * For layers: `contact_radius_over_lens_thickness` and `contact_radius_over_substrate_thickness`, of which the latter has no
    ///   threshold, since the solution for a flat film is valid for any thickness; `lens_thickness_over_radius`, which for an asperity must
    ///   be below 0.5; `indentation_over_thickness` of the thinnest layer; and `thickness_over_diameter` of the thinnest layer and the
    ///   widest pillar, which must be at least 2.
    /// * `substrate_thickness_of_one_percent_m` and similar values for half-spaces: the thickness, on a rigid base, at which the
    ///   indentation under this force would be smaller by this fraction ([`Layers::shift`]).
    /// * `work_of_adhesion_of_one_percent_J_per_m2`, without adhesion: the work of adhesion at which the pull-off force of `N` tops under
    ///   equal tension is a hundredth of the force, `(F/100 N)^2/(8 pi E* a^3)` (K. Kendall, J. Phys. D 4, 1186 (1971)).
    #[must_use]
    pub fn limits(&self, range: Option<f64>) -> Vec<Limit> {
        let system = &self.system;
        let farthest = self.whole_contact_radius();
        let lens = system.lens();
        let mut limits = if system.adhesion().is_none() {
            of_lens(lens, farthest, self.indentation).collect()
        } else {
            let mut limits = limits_of_adhesion(system, farthest, range);
            limits.extend(of_lens_beside_slope(lens, farthest, self.indentation));
            limits
        };
        let modulus = system.substrate().young_modulus;
        let hardest = |of: &dyn Fn(&PillarState) -> f64| {
            let each = self.pillars.iter().map(of);
            each.fold(0.0, f64::max)
        };
        if !self.pillars.is_empty() {
            let stress = hardest(&|pillar| pillar.force / pillar.top_area()) / modulus;
            limits.push(Limit::at_most("pillar_stress", stress, LARGEST_STRAIN));
            let buckling = hardest(&|pillar| {
                pillar.force / buckling_force(modulus, pillar.diameter, pillar.height)
            });
            limits.push(Limit::at_most("buckling", buckling, LARGEST_BUCKLING));
        }
        limits.extend(self.of_pillars());
        let sphere = system.lens().sphere().map(|sphere| sphere.radius);
        let layers = [system.substrate_layer(), system.lens_layer()];
        limits.extend(of_layers(layers, sphere, Some(farthest), self.indentation));
        if let Some(thinnest) = system.thinnest_layer() {
            let ratio = thinnest / system.largest_diameter();
            let name = "thickness_over_diameter";
            limits.push(Limit::at_least(name, ratio, THINNEST_LAYER));
        }
        if self.force > 0.0 && self.indentation > 0.0 {
            limits.extend(self.thicknesses());
            limits.extend(self.negligible_work());
        }
        // Removes values that overflow for extremely small loads.
        limits.retain(|limit| limit.value.is_finite());
        limits
    }

    /// Accuracy of the compliance model of the pillars.
    fn of_pillars(&self) -> Option<Limit> {
        let system = &self.system;
        if system.pillar().compliance == PillarCompliance::Elastic {
            let leans = system.leans() && matches!(self.method, Method::Spectral(_));
            let error = ELASTIC_ERRORS[usize::from(!leans)];
            return Some(Limit::without_threshold("elastic_pillar_error", error));
        }
        let law = system.column_law();
        let elastic = law.as_elastic()?.of_common().shortening;
        let own = law.of_common().shortening;
        let difference = ((1.0 + own) / (1.0 + elastic) - 1.0).abs();
        Some(Limit::at_most("pillar_compliance", difference, SMALL))
    }

    /// Thicknesses at which a finite thickness of a half-space would be significant.
    fn thicknesses(&self) -> Vec<Limit> {
        let system = &self.system;
        let of_pillar = |pillar: &PillarState| {
            let [x, y] = pillar.centre;
            pillar.force * (x * x + y * y + pillar.diameter * pillar.diameter / 12.0)
        };
        let second_moment = if self.pillars.is_empty() {
            HERTZ_SPREAD * self.force * self.contact_radius.powi(2)
        } else {
            self.pillars.iter().map(of_pillar).sum()
        };
        HalfSpaces {
            bodies: [
                (system.lens().material, system.lens_layer()),
                (*system.substrate(), system.substrate_layer()),
            ],
            lens_radius: system.lens().curvature_radius().unwrap_or(0.0),
            force: self.force,
            second_moment,
            indentation: self.indentation,
        }
        .limits()
    }

    /// Work of adhesion at which the neglected adhesion would be significant.
    fn negligible_work(&self) -> Option<Limit> {
        let system = &self.system;
        if !system.adhesion().is_none() || self.pillars.is_empty() {
            return None;
        }
        let radius = 0.5 * system.pillar().diameter;
        let share = SMALL * self.force / self.pillars.len() as f64;
        let work = share * share / (8.0 * PI * system.reduced_modulus() * radius.powi(3));
        Some(Limit::without_threshold(
            "work_of_adhesion_of_one_percent_J_per_m2",
            work,
        ))
    }
}

/// Limits for bodies that are layers, the substrate and the lens, with respect to the validity of flat layers. The radius of a spherical
/// lens, that of the contact and the indentation are in m.
fn of_layers(
    [film, lens]: [Option<&Layer>; 2],
    sphere: Option<f64>,
    contact_radius: Option<f64>,
    indentation: f64,
) -> Vec<Limit> {
    let mut limits = Vec::new();
    if let (Some(film), Some(radius)) = (film, contact_radius) {
        let name = "contact_radius_over_substrate_thickness";
        limits.push(Limit::without_threshold(name, radius / film.thickness));
    }
    if let Some(lens) = lens {
        if let Some(radius) = contact_radius {
            let name = "contact_radius_over_lens_thickness";
            limits.push(Limit::at_most(
                name,
                radius / lens.thickness,
                WIDEST_ON_LENS,
            ));
        }
        if let Some(sphere) = sphere {
            let name = "lens_thickness_over_radius";
            limits.push(Limit::at_most(name, lens.thickness / sphere, THICKEST_CAP));
        }
    }
    let thicknesses = [film, lens].into_iter().flatten();
    let thinnest = thicknesses
        .map(|layer| layer.thickness)
        .fold(f64::INFINITY, smaller);
    if thinnest.is_finite() {
        let name = "indentation_over_thickness";
        limits.push(Limit::at_most(
            name,
            indentation / thinnest,
            DEEPEST_IN_LAYER,
        ));
    }
    limits
}

/// Limits of a lens in a contact that reaches this far from its axis (m), at an indentation (m): its slope and the rest.
fn of_lens(lens: &ShapedLens, reach: f64, indentation: f64) -> impl Iterator<Item = Limit> {
    let slope = Limit::at_most("slope", lens.slope_at(reach), DOUBTFUL_CONTACT);
    iter::once(slope).chain(of_lens_beside_slope(lens, reach, indentation))
}

/// The rest: how far the contact reaches relative to the radius of curvature, and how well the rows of a table describe the lens there.
fn of_lens_beside_slope(
    lens: &ShapedLens,
    reach: f64,
    indentation: f64,
) -> impl Iterator<Item = Limit> {
    let ratio = lens.curvature_radius().map(|radius| {
        let name = "contact_radius_over_lens_radius";
        Limit::at_most(name, reach / radius, DOUBTFUL_CONTACT)
    });
    let profile = lens.profile().filter(|_| indentation > 0.0);
    let table = profile.map(|profile| {
        let name = "lens_table_error_over_indentation";
        let error = profile.interpolation_error(reach);
        Limit::at_most(name, error / indentation, SMALL)
    });
    ratio.into_iter().chain(table)
}

impl AsperityContact {
    /// The validity limits of the model, and the corresponding values in this contact with an array. `range` is that of the attraction (m), if
    /// it is known.
    ///
    /// * `contact_on_top`: the largest ratio of the radius of a contact to the radius of curvature of its top, which is a paraboloid here.
    /// * `slope`: of the lens at the edge of the contact; `contact_radius_over_lens_radius`.
    /// * `pillar_stress`: the largest mean stress, divided by Young's modulus of the substrate: on the cross-section of a pillar with a rim,
    ///   otherwise on the contact.
    /// * `buckling`: force on a pillar that shortens as a column, divided by its buckling force, as on flat tops.
    /// * `tabor_number`, with adhesion and a range of the attraction.
    /// * For bodies of finite thickness, the values for contacts with flat tops, except those relative to the pillar diameter.
    #[must_use]
    pub fn limits(&self, array: &AsperityArray, range: Option<f64>) -> Vec<Limit> {
        let pairs = || array.asperities().iter().zip(&self.asperities);
        let parts = pairs().map(|(asperity, state)| state.radius / asperity.top_radius);
        let mut limits = vec![Limit::at_most(
            "contact_on_top",
            parts.fold(0.0, f64::max),
            WIDEST_ON_TOP,
        )];
        if let Some(lens) = array.indenter().lens() {
            let touched = self.asperities.iter().filter(|state| state.radius > 0.0);
            let reaches = touched.map(|state| lens.distance(state.centre) + state.radius);
            let farthest = reaches.fold(0.0, f64::max);
            limits.extend(of_lens(lens, farthest, self.indentation));
        }
        let modulus = array.substrate().young_modulus;
        let touched = || pairs().filter(|(_, state)| state.radius > 0.0);
        let strains = touched().map(|(asperity, state)| {
            let radius = asperity.rim_radius.unwrap_or(state.radius);
            state.force / (PI * radius * radius * modulus)
        });
        let strain = strains.fold(0.0, f64::max);
        limits.push(Limit::at_most("pillar_stress", strain, LARGEST_STRAIN));
        let columns = touched().filter_map(|(asperity, state)| {
            let radius = asperity
                .rim_radius
                .filter(|_| asperity.column_compliance > 0.0)?;
            // A column of this compliance has the height `C E pi r^2`.
            let height = asperity.column_compliance * modulus * PI * radius * radius;
            Some(state.force / buckling_force(modulus, 2.0 * radius, height))
        });
        if let Some(buckling) = columns.reduce(f64::max) {
            limits.push(Limit::at_most("buckling", buckling, LARGEST_BUCKLING));
        }
        if let Some(range) = range {
            let number = array.tabor_number(range);
            limits.push(Limit::at_least(
                "tabor_number",
                number,
                SMALLEST_TABOR_NUMBER,
            ));
        }
        let sphere = array.indenter().lens().and_then(ShapedLens::sphere);
        let sphere = sphere.map(|sphere| sphere.radius);
        let (radius, depth) = (self.contact_radius, self.indentation);
        limits.extend(of_layers(array.layers(), sphere, radius, depth));
        // Removes values that overflow for extremely small loads.
        limits.retain(|limit| limit.value.is_finite());
        limits
    }
}

impl SurfaceContact {
    /// The validity limits of the model, and the corresponding values for this contact with a general surface.
    ///
    /// * `slope`: of the lens at the edge of the contact; `contact_radius_over_lens_radius`, with the distance from the axis of a cylinder.
    /// * `surface_slope`: the largest slope between adjacent cells in contact, both on the same pillar or both on no pillar.
    /// * `pillar_stress`: mean stress on the top of the pillar with the largest stress, divided by Young's modulus of the substrate;
    ///   without pillars `contact_stress`, that on all cells in contact.
    /// * For bodies of finite thickness, the values for contacts with pillars, except those relative to the pillar diameter.
    /// * `cells_in_contact`: their number, which must be at least 12.
    /// * With a `range` of the attraction (m): the largest `tabor_number` of the summits in contact and the `smallest_tabor_number`, where a summit has the
    ///   curvature of the least-squares paraboloid through 3 x 3 cells of the undeformed gap, and is a punch if it is a flat top in contact up to its
    ///   rim; `summits_in_contact`, and the fraction of them that are as narrow as a cell and have no number, `unresolved_summits`.
    #[must_use]
    pub fn limits(&self, system: &SurfaceSystem, range: Option<f64>) -> Vec<Limit> {
        let mut limits = Vec::new();
        let lens = system.indenter().lens();
        if let Some(lens) = lens {
            limits.extend(of_lens(lens, self.reach(lens), self.indentation));
        }
        let sphere = lens
            .and_then(ShapedLens::sphere)
            .map(|sphere| sphere.radius);
        let (radius, depth) = (self.contact_radius, self.indentation);
        limits.extend(of_layers(system.layers(), sphere, radius, depth));
        let surface = system.surface();
        let slope = self.steepest(surface);
        limits.push(Limit::at_most("surface_slope", slope, DOUBTFUL_CONTACT));
        let (name, stress) = match surface.pillars() {
            Some(pillars) => (
                "pillar_stress",
                self.hardest(surface, pillars.compliance.len()),
            ),
            None => ("contact_stress", self.force / self.contact_area),
        };
        let strain = stress / system.substrate().young_modulus;
        limits.push(Limit::at_most(name, strain, LARGEST_STRAIN));
        let cells = self.pressure.iter().filter(|pressure| **pressure > 0.0);
        let cells = cells.count() as f64;
        if cells > 0.0 {
            limits.push(Limit::at_least("cells_in_contact", cells, FEWEST_CELLS));
        }
        if let Some(range) = range {
            limits.extend(summits::limits(self, system, range));
        }
        // Without load the stress is undefined.
        limits.retain(|limit| limit.value.is_finite());
        limits
    }

    /// Distance of the farthest cell in contact from the lowest point or line of the lens, m.
    fn reach(&self, lens: &ShapedLens) -> f64 {
        if lens.is_axisymmetric() {
            return self.contact_radius.unwrap_or(0.0);
        }
        let cells = self.grid.centres().zip(&self.pressure);
        let touched = cells.filter(|(_, pressure)| **pressure > 0.0);
        let distances = touched.map(|(centre, _)| lens.distance(centre));
        distances.fold(0.0, f64::max)
    }

    /// The largest slope between adjacent cells in contact, both on the same pillar or both on no pillar.
    fn steepest(&self, surface: &HeightMap) -> f64 {
        let (columns, heights) = (self.grid.columns(), surface.heights());
        let [width, height] = self.grid.cell();
        let touched = |cell: usize| self.pressure[cell] > 0.0;
        let slope = |cell: usize, next: usize, distance: f64| {
            let belong = touched(next) && surface.label(cell) == surface.label(next);
            let rise = (heights[next] - heights[cell]).abs();
            if belong { rise / distance } else { 0.0 }
        };
        let cells = 0..self.grid.cell_count();
        cells.filter(|cell| touched(*cell)).fold(0.0, |most, cell| {
            let across = match (cell + 1) % columns {
                0 => 0.0,
                _ => slope(cell, cell + 1, width),
            };
            let up = match cell + columns < heights.len() {
                true => slope(cell, cell + columns, height),
                false => 0.0,
            };
            across.max(up).max(most)
        })
    }

    /// The largest mean stress on a pillar top, Pa.
    fn hardest(&self, surface: &HeightMap, pillars: usize) -> f64 {
        let mut tops = vec![(0.0, 0.0); pillars];
        for (cell, pressure) in self.pressure.iter().enumerate() {
            let label = surface.label(cell);
            if label != HeightMap::NO_PILLAR {
                let (sum, count) = &mut tops[label as usize];
                *sum += pressure;
                *count += 1.0;
            }
        }
        let stresses = tops.iter().map(|(sum, count)| sum / f64::max(*count, 1.0));
        stresses.fold(0.0, f64::max)
    }
}

/// `pi^2 E I/h^2`
fn buckling_force(modulus: f64, diameter: f64, height: f64) -> f64 {
    let second_moment = PI * diameter.powi(4) / 64.0;
    PI * PI * modulus * second_moment / (height * height)
}

/// A contact whose bodies, the lens and the substrate, are half-spaces or layers.
struct HalfSpaces<'a> {
    bodies: [(Material, Option<&'a Layer>); 2],
    lens_radius: f64,
    force: f64,
    /// Sum of all parts of the force times their squared distances from the axis.
    second_moment: f64,
    indentation: f64,
}

impl HalfSpaces<'_> {
    /// The thicknesses at which a body that is a half-space would change the indentation by 1 and 10 %.
    fn limits(&self) -> Vec<Limit> {
        let names = [
            [
                "lens_thickness_of_one_percent_m",
                "lens_thickness_of_ten_percent_m",
            ],
            [
                "substrate_thickness_of_one_percent_m",
                "substrate_thickness_of_ten_percent_m",
            ],
        ];
        let of_body = |(body, names): (usize, [&'static str; 2])| {
            let (material, other) = (self.bodies[body].0, self.bodies[1 - body].0);
            let layers = Layers::new([(material, Some(Layer::new(1.0))), (other, None)]);
            let thin = layers.shift(self.force, 0.0);
            let bend = layers.shift(self.force, self.second_moment).indentation - thin.indentation;
            // Under Hertz's contact the indentation is proportional to the third root of the curvature.
            let bend = bend + thin.curvature * self.lens_radius * self.indentation / 3.0;
            let parts = names.into_iter().zip([0.01, 0.1]);
            parts.map(move |(name, part)| {
                let change = part * self.indentation;
                Limit::without_threshold(name, thickness([thin.indentation, bend], change))
            })
        };
        let half_spaces = names.into_iter().enumerate();
        let half_spaces = half_spaces.filter(|(body, _)| self.bodies[*body].1.is_none());
        half_spaces.flat_map(of_body).collect()
    }
}

impl FlatContact {
    /// The conditions of the model, and how near this contact with a flat surface comes to where they end. `range` is that of the attraction (m), if there is
    /// adhesion and it is known.
    ///
    /// * `slope` of the lens at the edge of the contact, and `contact_radius_over_lens_radius`.
    /// * `contact_stress`: mean pressure over Young's modulus of the substrate.
    /// * `tabor_number` ([`FlatSystem::tabor_number`]).
    /// * Of layers, and of half-spaces the thicknesses at which they would matter, as of contacts with pillars.
    /// * `work_of_adhesion_of_one_percent_J_per_m2`, without adhesion: at which the pull-off force of a sphere is a hundredth of the force.
    #[must_use]
    pub fn limits(&self, system: &FlatSystem, range: Option<f64>) -> Vec<Limit> {
        let mut limits = Vec::new();
        let (lens, radius) = (system.lens(), system.lens().curvature_radius());
        if !system.is_punch() {
            limits.extend(of_lens(lens, self.contact_radius, self.indentation));
        }
        let stress = self.mean_pressure().abs() / system.substrate().young_modulus;
        limits.push(Limit::at_most("contact_stress", stress, LARGEST_STRAIN));
        if let (Some(range), false) = (range, system.adhesion().is_none()) {
            let number = system.tabor_number(range);
            limits.push(Limit::at_least(
                "tabor_number",
                number,
                SMALLEST_TABOR_NUMBER,
            ));
        }
        let sphere = system.lens().sphere().map(|lens| lens.radius);
        let layers = system.layers();
        limits.extend(of_layers(
            layers,
            sphere,
            Some(self.contact_radius),
            self.indentation,
        ));
        if self.force > 0.0 && self.indentation > 0.0 {
            let [substrate, lens] = layers;
            let spread = match radius {
                Some(_) => HERTZ_SPREAD,
                None => PUNCH_SPREAD,
            };
            let contact = HalfSpaces {
                bodies: [
                    (system.lens().material, lens),
                    (*system.substrate(), substrate),
                ],
                lens_radius: radius.unwrap_or(0.0),
                force: self.force,
                second_moment: spread * self.force * self.contact_radius.powi(2),
                indentation: self.indentation,
            };
            limits.extend(contact.limits());
            if let (Some(radius), true) = (radius, system.adhesion().is_none()) {
                let work = SMALL * self.force / (1.5 * PI * radius);
                let name = "work_of_adhesion_of_one_percent_J_per_m2";
                limits.push(Limit::without_threshold(name, work));
            }
        }
        limits.retain(|limit| limit.value.is_finite());
        limits
    }
}

/// Fraction of the shift above which the curvature due to a layer is not a small correction: the layer is then thinner than about three
/// contact radii.
const LARGEST_BEND: f64 = 0.1;

/// The thickness at which `shift/t + bend/t^3` equals `change`; from the shift alone if the second term is not small, for which the
/// expansion is not valid.
fn thickness([shift, bend]: [f64; 2], change: f64) -> f64 {
    const STEPS: usize = 20;
    let alone = shift.abs() / change;
    let mut thickness = alone;
    for _ in 0..STEPS {
        let part = bend / (shift * thickness * thickness);
        if part.abs() > LARGEST_BEND || !part.is_finite() {
            return alone;
        }
        thickness = alone * (1.0 + part);
    }
    thickness
}
