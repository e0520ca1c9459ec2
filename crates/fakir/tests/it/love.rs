//! The method of elements compared with independent results: analytical solutions of contact mechanics, and the spectral method.
//!
//! Orders of convergence are printed (`cargo test --release -p fakir --test it love -- --nocapture`).

mod arranged;
mod half_space;
mod order;
mod pillars;
mod rough;
mod waves;

use fakir::halfspace::elements::{
    FreeSpaceConvolution, Operator, PeriodicConvolution, Preconditioned,
};
use fakir::problem::{Cells, Grid, Point};
use fakir::solve::elements::solver;
use fakir::solve::elements::solver::{ElementContact, Prescribed, Settings};
use fakir::state::{CancelToken, Termination};

/// An elastic half-space of compliance 1 under a rigid surface.
struct Indenter<O> {
    cells: Cells,
    operator: Preconditioned<'static, O>,
    separation: Vec<f64>,
}

impl Indenter<FreeSpaceConvolution<'static>> {
    /// A non-periodic half-space, and a surface with the given height above each point.
    fn free(cells: Cells, height: impl Fn(Point) -> f64) -> Self {
        let operator = FreeSpaceConvolution::new(cells.clone(), 1.0, None);
        Self::new(cells, operator, height)
    }
}

impl Indenter<PeriodicConvolution<'static>> {
    /// A half-space and a surface with the grid as their period.
    fn periodic(cells: Cells, height: impl Fn(Point) -> f64) -> Self {
        let operator = PeriodicConvolution::new(cells.clone(), 1.0, None);
        Self::new(cells, operator, height)
    }
}

impl<O: Operator> Indenter<O> {
    fn new(cells: Cells, operator: O, height: impl Fn(Point) -> f64) -> Self {
        Self {
            separation: cells.centres().map(height).collect(),
            operator: Preconditioned::new(operator, cells.clone(), None),
            cells,
        }
    }

    fn area(&self) -> f64 {
        self.cells.grid().cell_area()
    }

    fn press_from(
        &mut self,
        load: Prescribed,
        tolerance: f64,
        start: Option<&[f64]>,
    ) -> ElementContact {
        let settings = Settings {
            tolerance,
            ..Settings::default()
        };
        let area = self.area();
        let contact = solver::solve(
            &mut self.operator,
            &self.separation,
            area,
            load,
            start,
            &settings,
            &CancelToken::default(),
        );
        assert_eq!(
            contact.termination,
            Termination::Converged,
            "{load:?}: {:?} after {} products",
            contact.certificate,
            contact.products
        );
        assert!(contact.products <= settings.product_limit);
        assert!(contact.certificate.energy_bound <= tolerance);
        assert!(contact.pressure.iter().all(|pressure| *pressure >= 0.0));
        contact
    }

    fn press(&mut self, load: Prescribed) -> ElementContact {
        self.press_from(load, 1e-10, None)
    }

    /// Area of the cells with positive pressure.
    fn contact_area(&self, contact: &ElementContact) -> f64 {
        let loaded = contact.pressure.iter().filter(|p| **p > 0.0).count();
        self.area() * loaded as f64
    }
}

/// Relative difference from the expected value.
fn error(value: f64, expected: f64) -> f64 {
    value / expected - 1.0
}

fn assert_within(value: f64, expected: f64, tolerance: f64, what: &str) {
    let error = error(value, expected);
    assert!(
        error.abs() <= tolerance,
        "{what}: {value:e} instead of {expected:e}, {error:.2e} off"
    );
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Square cells, centred at the origin.
fn grid(columns: usize, rows: usize, size: f64) -> Grid {
    Grid::centred(columns, rows, size).expect("a valid grid")
}
