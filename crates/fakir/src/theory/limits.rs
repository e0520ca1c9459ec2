//! How near a contact comes to where its model ends, and what of the model would change it: estimates from the contact alone, in closed form.

use super::layer::Layers;
use crate::numerics::convergence::smaller;
use crate::problem::{
    HeightMap, Indenter, Layer, Material, Method, PillarCompliance, SurfaceSystem, System,
};
use crate::state::limit::{
    DEEPEST_IN_LAYER, DOUBTFUL_CONTACT, LARGEST_STRAIN, Limit, THINNEST_LAYER, limits_of_adhesion,
};
use crate::state::{ContactState, PillarState, SurfaceContact};
use std::f64::consts::PI;

/// Force on a pillar over that under which it buckles from which on small imperfections are no longer small: half of it doubles them.
const LARGEST_BUCKLING: f64 = 0.5;

/// Contact radius over the thickness of a lens from which on a flat layer is doubtful: asperities were compared with it by finite elements up to 0.4.
const WIDEST_ON_LENS: f64 = 1.0;

/// Thickness of a spherical asperity over its radius from which on it is nearly half a sphere, and a flat layer no longer stands for it: finite elements
/// make it softer by a tenth of what it shifts, and by a quarter near the radius ([`asperity_reduction`](super::layer::asperity_reduction)).
const THICKEST_CAP: f64 = 0.5;

/// Cells in contact below which elements do not resolve it: a disc of four across, the fewest that a pillar can have.
const FEWEST_CELLS: f64 = 12.0;

/// Relative difference of compliance or force that does not matter beside what moduli and lengths are known to.
const SMALL: f64 = 0.01;

/// Largest error of critical forces found beside pillars with all their modes, with leaning and without: [the problem](crate::problem).
const ELASTIC_ERRORS: [f64; 2] = [0.0017, 0.0033];

/// Mean square of the distance from the axis under Hertz's pressure, over that of the contact radius (K. L. Johnson, Contact Mechanics, sec. 4.2).
const HERTZ_SPREAD: f64 = 0.4;

impl ContactState {
    /// The conditions of the model, and how near this contact comes to where they end. `range` is that of the attraction (m), if tops stick and it is known.
    ///
    /// Some have no threshold: they are what would change this contact. All take microseconds.
    ///
    /// * `kendall_strain`, `tabor_number`: of tops that stick ([`System::kendall_strain`], [`System::tabor_number`]).
    /// * `slope`: of the lens at the edge of the contact; `contact_radius_over_lens_radius`.
    /// * `pillar_stress`: mean stress on the top of the hardest pillar over Young's modulus of the substrate.
    /// * `buckling`: force on a pillar over `pi^2 E_s I/h^2` with `I = pi d^4/64`, under which a pillar buckles that is clamped at its foot and led at its
    ///   top (S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability, sec. 2.1).
    /// * `pillar_compliance`: by which part a lone pillar gives way otherwise than an elastic one, where that is known. Near the transition the force changes by up to
    ///   four times as much. Of elastic pillars `elastic_pillar_error` instead: the largest error of a critical force that was found.
    /// * Of bodies that are layers: `contact_radius_over_lens_thickness` and `contact_radius_over_substrate_thickness`, of which the latter has no threshold, as a flat
    ///   film is solved however thin it is; `lens_thickness_over_radius`, from 0.5 on doubtful for an asperity; `indentation_over_thickness` of the thinnest
    ///   layer; and `thickness_over_diameter` of the thinnest layer and the widest pillar, doubtful below 2.
    /// * `substrate_thickness_of_one_percent_m` and the like, of bodies that are half-spaces: a thickness at which the indentation under this force would be that much smaller, on a rigid back
    ///   ([`Layers::shift`]).
    /// * `work_of_adhesion_of_one_percent_J_per_m2`, where nothing sticks: at which `N` tops, pulled alike, hold a hundredth of the force at pull-off,
    ///   `(F/100 N)^2/(8 pi E* a^3)` (K. Kendall, J. Phys. D 4, 1186 (1971)).
    #[must_use]
    pub fn limits(&self, range: Option<f64>) -> Vec<Limit> {
        let system = &self.system;
        let farthest = self.whole_contact_radius();
        let mut limits = if system.adhesion().is_none() {
            let slope = system.lens().slope_at(farthest);
            vec![Limit::at_most("slope", slope, DOUBTFUL_CONTACT)]
        } else {
            limits_of_adhesion(system, farthest, range)
        };
        if let Some(radius) = system.lens().radius() {
            let ratio = farthest / radius;
            let name = "contact_radius_over_lens_radius";
            limits.push(Limit::at_most(name, ratio, DOUBTFUL_CONTACT));
        }
        let modulus = system.substrate().young_modulus;
        let hardest = |of: &dyn Fn(&PillarState) -> f64| {
            let each = self.pillars.iter().map(of);
            each.fold(0.0, f64::max)
        };
        if !self.pillars.is_empty() {
            let stress = hardest(&|pillar| pillar.force / pillar.top_area()) / modulus;
            limits.push(Limit::at_most("pillar_stress", stress, LARGEST_STRAIN));
            let buckling = hardest(&|pillar| pillar.force / buckling_force(modulus, pillar));
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
            limits.extend(self.sticking());
        }
        // Numbers that overflow under loads of no size say nothing.
        limits.retain(|limit| limit.value.is_finite());
        limits
    }

    /// How well it is known how pillars give way.
    fn of_pillars(&self) -> Option<Limit> {
        let system = &self.system;
        if system.pillar().compliance == PillarCompliance::Elastic {
            let leans = system.leans() && matches!(self.method, Method::Spectral(_));
            let error = ELASTIC_ERRORS[usize::from(!leans)];
            return Some(Limit::told("elastic_pillar_error", error));
        }
        let law = system.column_law();
        let elastic = law.as_elastic()?.of_common().shortening;
        let own = law.of_common().shortening;
        let difference = ((1.0 + own) / (1.0 + elastic) - 1.0).abs();
        Some(Limit::at_most("pillar_compliance", difference, SMALL))
    }

    /// At which thickness a body that is a half-space would matter.
    fn thicknesses(&self) -> Vec<Limit> {
        let system = &self.system;
        let radius = system.lens().radius().unwrap_or(0.0);
        let of_pillar = |pillar: &PillarState| {
            let [x, y] = pillar.centre;
            pillar.force * (x * x + y * y + pillar.diameter * pillar.diameter / 12.0)
        };
        let second_moment = if self.pillars.is_empty() {
            HERTZ_SPREAD * self.force * self.contact_radius.powi(2)
        } else {
            self.pillars.iter().map(of_pillar).sum()
        };
        let bodies = [
            (
                system.lens().material,
                system.lens_layer(),
                [
                    "lens_thickness_of_one_percent_m",
                    "lens_thickness_of_ten_percent_m",
                ],
            ),
            (
                *system.substrate(),
                system.substrate_layer(),
                [
                    "substrate_thickness_of_one_percent_m",
                    "substrate_thickness_of_ten_percent_m",
                ],
            ),
        ];
        let of_body = |(material, names): (Material, [&'static str; 2])| {
            let layers = one_metre(system, material);
            let thin = layers.shift(self.force, 0.0);
            let bend = layers.shift(self.force, second_moment).indentation - thin.indentation;
            // Under Hertz's contact the indentation goes as the third root of the curvature.
            let bend = bend + thin.curvature * radius * self.indentation / 3.0;
            let parts = names.into_iter().zip([0.01, 0.1]);
            parts.map(move |(name, part)| {
                let change = part * self.indentation;
                Limit::told(name, thickness([thin.indentation, bend], change))
            })
        };
        let half_spaces = bodies.into_iter().filter(|body| body.1.is_none());
        let half_spaces = half_spaces.map(|(material, _, names)| (material, names));
        half_spaces.flat_map(of_body).collect()
    }

    /// At which work of adhesion sticking would matter that is left out.
    fn sticking(&self) -> Option<Limit> {
        let system = &self.system;
        if !system.adhesion().is_none() || self.pillars.is_empty() {
            return None;
        }
        let radius = 0.5 * system.pillar().diameter;
        let share = SMALL * self.force / self.pillars.len() as f64;
        let work = share * share / (8.0 * PI * system.reduced_modulus() * radius.powi(3));
        Some(Limit::told(
            "work_of_adhesion_of_one_percent_J_per_m2",
            work,
        ))
    }
}

/// Where bodies that are layers, the substrate and the lens, are beyond what flat layers stand for. The radius of a spherical lens, that of the contact and the
/// indentation are in m.
fn of_layers(
    [film, lens]: [Option<&Layer>; 2],
    sphere: Option<f64>,
    contact_radius: Option<f64>,
    indentation: f64,
) -> Vec<Limit> {
    let mut limits = Vec::new();
    if let (Some(film), Some(radius)) = (film, contact_radius) {
        let name = "contact_radius_over_substrate_thickness";
        limits.push(Limit::told(name, radius / film.thickness));
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

impl SurfaceContact {
    /// The conditions of the model, and how near this contact with a system's surface comes to where they end.
    ///
    /// * `slope`: of the lens at the edge of the contact; `contact_radius_over_lens_radius`.
    /// * `surface_slope`: the largest between neighbouring cells in contact, of one pillar or beside all pillars.
    /// * `pillar_stress`: mean stress on the top of the hardest pillar over Young's modulus of the substrate; without pillars
    ///   `contact_stress`, that on all cells in contact.
    /// * Of bodies of finite thickness those that contacts with pillars have, but for the diameter of pillars.
    /// * `cells_in_contact`: how many there are, doubtful below 12.
    #[must_use]
    pub fn limits(&self, system: &SurfaceSystem) -> Vec<Limit> {
        let mut limits = Vec::new();
        if let (Indenter::Lens(lens), Some(radius)) = (system.indenter(), self.contact_radius) {
            // That of a sphere, as results have it.
            let slope = radius / lens.radius;
            for name in ["slope", "contact_radius_over_lens_radius"] {
                limits.push(Limit::at_most(name, slope, DOUBTFUL_CONTACT));
            }
        }
        let sphere = match system.indenter() {
            Indenter::Lens(lens) => Some(lens.radius),
            Indenter::Flat(_) => None,
        };
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
        // Without load there is no stress.
        limits.retain(|limit| limit.value.is_finite());
        limits
    }

    /// The largest slope between neighbouring cells in contact that belong together.
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

    /// The largest mean stress on the top of a pillar, Pa.
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
fn buckling_force(modulus: f64, pillar: &PillarState) -> f64 {
    let second_moment = PI * pillar.diameter.powi(4) / 64.0;
    PI * PI * modulus * second_moment / (pillar.height * pillar.height)
}

/// A body as a layer of 1 m, the other one a half-space.
fn one_metre(system: &System, material: Material) -> Layers {
    let compliance = system.contact_compliance() - material.plane_strain_compliance();
    // Of the other body only the compliance counts.
    let other = Material::new(compliance.recip(), 0.0);
    Layers::new([(material, Some(Layer::new(1.0))), (other, None)])
}

/// Part of the shift beyond which the curvature that a layer adds is no correction: the layer is then thinner than about three contact radii.
const LARGEST_BEND: f64 = 0.1;

/// The thickness at which `shift/t + bend/t^3` is a change; by the shift alone where the second is no small part of it, which no longer says how the
/// indentation goes on.
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
