//! Random systems and questions within the complete range of input.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use fakir::problem::{
    Arrangement, HexagonalLattice, Lens, Load, Material, Pillar, PillarCompliance, PillarPattern,
    Point, System,
};
use std::f64::consts::{FRAC_PI_6, PI, TAU};

/// Estimated number of pillars under the contact above which another system is drawn: every system is solved about ten times.
const MOST_PILLARS: f64 = 400.0;

/// Number of squares of half a pillar radius on the floor under the lens above which another system is drawn.
const MOST_FLOOR: f64 = 2e4;

/// The load of a system.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Asked {
    Transition,
    Indentation(f64),
    /// The force, of the same order of magnitude as at this indentation.
    ForceNear(f64),
}

/// A system with its load.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) seed: u64,
    pub(crate) number: u64,
    pub(crate) system: System,
    pub(crate) asked: Asked,
}

impl Drawn {
    /// The reproducible system for a seed and a number.
    pub(crate) fn new(seed: u64, number: u64) -> Self {
        let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
        random.0.set_stream(number);
        loop {
            let system = random.system();
            let asked = random.asked(&system);
            if expected_pillars(&system, asked) < MOST_PILLARS
                && expected_floor(&system, asked) < MOST_FLOOR
            {
                return Self {
                    seed,
                    number,
                    system,
                    asked,
                };
            }
        }
    }

    /// The case file, and the command-line options of the question.
    pub(crate) fn case_file(&self) -> String {
        let system = &self.system;
        let (lens, pillar, lattice) = (
            system.lens(),
            system.pillar(),
            system.hexagonal_lattice().expect("a hexagonal lattice"),
        );
        let compliance = match pillar.compliance {
            PillarCompliance::Column => "column",
            PillarCompliance::Elastic => "elastic",
            PillarCompliance::None => "none",
        };
        format!(
            "# seed {}, system {}: {:?}\n[lens]\nradius = {:e}\nyoung_modulus = {:e}\npoisson_ratio = {}\n\
             [substrate]\nyoung_modulus = {:e}\npoisson_ratio = {}\n\
             [pattern]\nlattice = \"hexagonal\"\npitch = {:e}\noffset = {}\noffset_angle = {}\n\
             [pattern.pillar]\ndiameter = {:e}\nheight = {:e}\ncompliance = \"{compliance}\"\n",
            self.seed,
            self.number,
            self.asked,
            lens.sphere_radius(),
            lens.material.young_modulus,
            lens.material.poisson_ratio,
            system.substrate().young_modulus,
            system.substrate().poisson_ratio,
            lattice.pitch,
            lattice.offset,
            lattice.offset_angle,
            pillar.diameter,
            pillar.height,
        )
    }
}

struct Random(ChaCha8Rng);

impl Random {
    /// Between 0 and 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number with a uniformly distributed logarithm.
    fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    fn one_in(&mut self, many: f64) -> bool {
        self.unit() * many < 1.0
    }

    fn poisson_ratio(&mut self) -> f64 {
        if self.one_in(2.0) {
            0.5
        } else {
            self.uniform(0.0, 0.5)
        }
    }

    fn system(&mut self) -> System {
        let diameter = self.logarithmic(1e-7, 1e-4);
        let modulus = self.logarithmic(1e3, 1e12);
        let substrate = modulus * self.logarithmic(1e-6, 1e6);
        let [lens, substrate] =
            [modulus, substrate].map(|modulus| Material::new(modulus, self.poisson_ratio()));
        let radius = diameter * self.logarithmic(4.0, 1e5);
        let height = diameter * self.logarithmic(0.01, 10.0);
        let surface_fraction = self.logarithmic(3e-5, 0.6);
        let (offset, offset_angle) = self.landing();
        let compliance = if self.one_in(2.0) {
            PillarCompliance::None
        } else {
            PillarCompliance::Column
        };
        let lens = Lens {
            radius,
            material: lens,
        };
        let pattern = PillarPattern {
            pillar: Pillar {
                diameter,
                height: height.min(0.5 * radius),
                compliance,
            },
            arrangement: Arrangement::from(HexagonalLattice {
                offset,
                offset_angle,
                ..HexagonalLattice::with_surface_fraction(surface_fraction, diameter)
            }),
        };
        System::new(lens, substrate, pattern).expect("drawn within what is allowed")
    }

    /// Offset in pitches and its angle: at sites of symmetry, close to these, or anywhere.
    fn landing(&mut self) -> (f64, f64) {
        const SITES: [(f64, f64); 6] = [
            (0.0, 0.0),
            (0.866_025_403_784_438_6, 0.0),
            (0.5, FRAC_PI_6),
            (0.577_350_269_189_625_8, 0.0),
            (0.333_333_333_333_333_3, 0.0),
            (1.0, FRAC_PI_6),
        ];
        if self.one_in(2.0) {
            return (self.unit(), self.uniform(0.0, TAU));
        }
        let (offset, angle) = SITES[self.uniform(0.0, 6.0) as usize];
        if self.one_in(2.0) {
            let by = self.logarithmic(1e-12, 1e-2);
            return (offset + by, angle + by);
        }
        (offset, angle)
    }

    fn asked(&mut self, system: &System) -> Asked {
        if self.one_in(2.0) {
            return Asked::Transition;
        }
        let first_touch = system.lens().sag([nearest_edge(system), 0.0]);
        let reach = system.pitch() * self.logarithmic(0.05, 6.0);
        let radius = system.lens().sphere_radius();
        // Light contacts are the most difficult: the contact is a narrow region of one pillar top.
        let lightly = self.one_in(4.0) && first_touch > 0.0 && first_touch.is_finite();
        let indentation = if lightly {
            first_touch * (1.0 + self.logarithmic(1e-4, 1.0))
        } else {
            first_touch.min(radius) + 0.5 * reach * reach / radius
        };
        if self.one_in(2.0) {
            Asked::Indentation(indentation)
        } else {
            Asked::ForceNear(indentation)
        }
    }
}

/// Distance from the lens axis of the nearest point of a pillar top.
pub(crate) fn nearest_edge(system: &System) -> f64 {
    let (i, j) = system
        .hexagonal_lattice()
        .expect("a hexagonal lattice")
        .nearest_pillar([0.0, 0.0]);
    let [x, y]: Point = system
        .hexagonal_lattice()
        .expect("a hexagonal lattice")
        .centre(i, j);
    (x.hypot(y) - 0.5 * system.pillar().diameter).max(0.0)
}

/// Number of squares of half a pillar radius within the circle in which the undeformed lens would be below the floor.
fn expected_floor(system: &System, asked: Asked) -> f64 {
    let (lens, pillar) = (system.lens().sphere_radius(), system.pillar());
    match asked {
        Asked::Transition => 0.0,
        Asked::Indentation(indentation) | Asked::ForceNear(indentation) => {
            let depth = (indentation - pillar.height).max(0.0);
            2.0 * PI * lens * depth / (0.25 * pillar.diameter).powi(2)
        }
    }
}

/// Number of pillars under a contact with the radius of the undeformed lens at the indentation, or, at the transition, of the paper's
/// `e sqrt(1 + (R h/e^2)^2)`; `None` if the contact is too large for the lens.
fn expected_pillars(system: &System, asked: Asked) -> f64 {
    let lattice = system.hexagonal_lattice().expect("a hexagonal lattice");
    let (lens, pitch) = (system.lens().sphere_radius(), lattice.pitch);
    let contact = match asked {
        Asked::Transition => pitch.hypot(lens * system.pillar().height / pitch),
        Asked::Indentation(indentation) | Asked::ForceNear(indentation) => {
            (2.0 * indentation * lens).sqrt()
        }
    };
    PI * contact.min(0.6 * lens).powi(2) / lattice.cell_area()
}

/// The load, with the given value of a prescribed force.
pub(crate) fn control(asked: Asked, force: f64) -> Load {
    match asked {
        Asked::Transition => Load::FloorContact,
        Asked::Indentation(indentation) => Load::Indentation(indentation),
        Asked::ForceNear(_) => Load::Force(force),
    }
}
