//! Non-negative pressure on one pillar top.
//!
//! With coefficients `c` of `q` and the load `b` (the required displacement, projected on the modes), the pressure minimises
//! `1/2 c' Lam c - c' b` under `q >= 0` at the nodes of [`bos_array`]. With `V` the modes at the nodes, the dual problem is a linear
//! complementarity problem with the matrix `G = V Lam^-1 V'`, the same for every pillar: `c = Lam^-1 (b + V' s)`,
//! `q = V Lam^-1 b + G s`, `q >= 0`, `s >= 0`, `q's = 0`, solved by [block principal pivoting](super::pivoting).
//!
//! A narrow contact along the rim is not resolved by the nodes; it is solved on [cells](super::rim) instead.

use super::rim::{Motion, Rim, RimContact, RimSolver};
use crate::halfspace::disc::basis::{
    BasisEvaluator, column_factors, compliances, degree_with, mode_count,
};
use crate::halfspace::disc::nodes::{Node, Resolution, bos_array};
use crate::numerics::convergence::{larger, largest, smaller, within};
use crate::numerics::pivoting::{Inverse, PivotSolver, Pivoting};
use crate::numerics::vector::{inner_dot, widest};
use crate::problem::column::Column;
use crate::state::PillarStatus;
use std::borrow::Cow;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Largest tension at a node that is attributed to rounding of the node values, relative to the largest unconstrained value.
const PRESSURE_TOLERANCE: f64 = 1e-11;

/// Fraction of the largest unconstrained pressure below which a node is initially assumed to be without pressure: the adjacent tension,
/// which the constraint removes, reduces it further. Saves one factorisation in four on the edge of a contact.
const LOW_PRESSURE: f64 = 0.15;

/// Recently created tops, for reuse, and the largest total number of values that they may have.
static KEPT: Mutex<Vec<Arc<PillarTop>>> = Mutex::new(Vec::new());
const MOST_KEPT: usize = 1 << 21;

/// A pillar top of unit radius with a node array: data shared by pillars of one column compliance.
#[derive(Debug, Clone)]
pub(crate) struct PillarTop {
    resolution: Resolution,
    column: Column,
    /// Number of modes, equal to the number of nodes.
    count: usize,
    /// Number of leading modes by which pillars interact.
    lead: usize,
    /// `Lam`.
    compliance: Vec<f64>,
    /// `V`, one row of `count` values per node.
    values: Vec<f64>,
    /// `V Lam^-1`, the values at all nodes mode by mode.
    pressures: Vec<f64>,
    /// `G`, symmetric.
    response: Vec<f64>,
    /// `G^-1`, if many pillars are expected to need it.
    inverse: Option<Inverse>,
    /// `G^-1 V Lam^-1 = V'^-1` of the leading modes, mode by mode, computed when first needed.
    loads: OnceLock<Vec<f64>>,
    /// Largest absolute value of every leading mode at the nodes.
    bounds: Vec<f64>,
}

/// Work space of the local problem, and its solution.
pub(crate) struct LocalSolver {
    pivot: PivotSolver,
    /// The rim and its cells are created when the first load needs them; the cells depend on the column.
    rim: Option<Rim>,
    cells: Option<Box<RimSolver>>,
    column: Option<Column>,
    /// Whether the solution is that of a narrow contact, on cells.
    on_cells: bool,
}

impl PillarTop {
    /// The same as [`new`](Self::new), with reuse of tops created before.
    pub(crate) fn shared(
        resolution: Resolution,
        lead: usize,
        column: impl Into<Column>,
    ) -> Arc<Self> {
        let column = column.into();
        let is_it = |top: &Arc<Self>| {
            (top.resolution, top.lead, top.column) == (resolution, mode_count(lead), column)
        };
        let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let found = kept().iter().find(|top| is_it(top)).cloned();
        found.unwrap_or_else(|| {
            let top = Arc::new(Self::new(resolution, lead, column));
            let mut kept = kept();
            kept.push(Arc::clone(&top));
            while kept.iter().map(|top| top.response.len()).sum::<usize>() > MOST_KEPT {
                // The oldest one.
                kept.remove(0);
            }
            top
        })
    }

    /// `lead` is the degree of the coupling between pillars.
    pub(crate) fn new(resolution: Resolution, lead: usize, column: impl Into<Column>) -> Self {
        let column = column.into();
        let Resolution {
            nodes: degree,
            turn,
            ..
        } = resolution;
        let count = mode_count(degree);
        let nodes = bos_array(degree, turn);
        let compliance = compliances(degree, column);
        let mut basis = BasisEvaluator::new(degree);
        let mut values = vec![0.0; count * count];
        for (node, row) in nodes.iter().zip(values.chunks_exact_mut(count)) {
            basis.evaluate_polar(node.mu, node.rho, node.direction, row);
        }
        let pressures: Vec<f64> = values
            .chunks_exact(count)
            .flat_map(|row| row.iter().zip(&compliance).map(|(y, lambda)| y / lambda))
            .collect();
        let response = node_responses(&nodes, &mut basis, &compliance);
        let by_mode = (0..count).flat_map(|mode| pressures.iter().skip(mode).step_by(count));
        let pressures = by_mode.copied().collect();
        let lead = mode_count(lead);
        let largest = |mode: usize| {
            let at_nodes = values.chunks_exact(count).map(|row| row[mode].abs());
            at_nodes.fold(0.0, f64::max)
        };
        let bounds = (0..lead.min(count)).map(largest).collect();
        Self {
            resolution,
            column,
            count,
            lead,
            bounds,
            compliance,
            values,
            pressures,
            response,
            inverse: Some(Inverse::default()),
            loads: OnceLock::new(),
        }
    }

    /// Resolution of the top.
    pub(crate) fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Number of modes, equal to the number of nodes.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Compliances of the leading modes.
    pub(crate) fn lead_compliance(&self) -> &[f64] {
        &self.compliance[..self.lead]
    }

    /// Compliances of all modes.
    pub(crate) fn compliance(&self) -> &[f64] {
        &self.compliance
    }

    /// Factors on the responses of the first modes on another column.
    pub(crate) fn ratios(&self, column: Column) -> [f64; 3] {
        let [own, other] = [self.column, column].map(column_factors);
        std::array::from_fn(|mode| own[mode] / other[mode])
    }

    /// The same top on another column: the compliance of its mean changes, by the same amount at all nodes, and that of its tilts may.
    pub(crate) fn on_column(&self, column: Column) -> Cow<'_, Self> {
        let ratios = self.ratios(column);
        let is_same = |ratio: &f64| ratio.to_bits() == 1.0_f64.to_bits();
        if ratios.iter().all(is_same) {
            return Cow::Borrowed(self);
        }
        let mut top = self.clone();
        top.column = column;
        // An inverse for a single pillar takes longer than what it saves.
        top.inverse = None;
        for (mode, ratio) in ratios.into_iter().enumerate().take(self.count) {
            if !is_same(&ratio) {
                top.scale_mode(mode, ratio);
            }
        }
        Cow::Owned(top)
    }

    /// Multiplies the response of a mode by a factor.
    fn scale_mode(&mut self, mode: usize, ratio: f64) {
        self.compliance[mode] /= ratio;
        let pressures = &mut self.pressures[mode * self.count..(mode + 1) * self.count];
        let changes: Vec<f64> = pressures
            .iter_mut()
            .map(|pressure| {
                let before = *pressure;
                *pressure = before * ratio;
                *pressure - before
            })
            .collect();
        let rows = self.response.chunks_exact_mut(self.count);
        for (row, change) in rows.zip(changes) {
            for (response, values) in row.iter_mut().zip(self.values.chunks_exact(self.count)) {
                *response += change * values[mode];
            }
        }
    }

    /// `V'^-1` of the leading modes; requires that the inverse has been used.
    fn loads(&self) -> &[f64] {
        self.loads.get_or_init(|| {
            let of_lead = &self.pressures[..self.lead.min(self.count) * self.count];
            let inverse = self.inverse.as_ref();
            inverse.map_or_else(Vec::new, |inverse| inverse.times(of_lead, self.count))
        })
    }

    /// Values of the modes at a node.
    fn values(&self, node: usize) -> &[f64] {
        &self.values[node * self.count..(node + 1) * self.count]
    }

    /// The unconstrained pressure at all nodes, `V Lam^-1 b`.
    fn pressures(&self, load: &[f64], pressures: &mut [f64]) {
        widest(
            #[inline(always)]
            || {
                pressures.fill(0.0);
                for (b, of_mode) in load.iter().zip(self.pressures.chunks_exact(self.count)) {
                    for (pressure, of_mode) in pressures.iter_mut().zip(of_mode) {
                        *pressure += b * of_mode;
                    }
                }
            },
        );
    }

    /// The status on a column, if the mean load exceeds all variations over the top, for either sign.
    pub(crate) fn plain_status(&self, load: &[f64], column: Column) -> Option<PillarStatus> {
        let (mut target, mut pressure) = (0.0, 0.0);
        let [of_mean, of_tilts, _] = self.ratios(column);
        let modes = load.iter().zip(&self.compliance).zip(&self.bounds);
        for (mode, ((load, lambda), bound)) in modes.enumerate().skip(1) {
            target += load.abs() * bound;
            let ratio = if mode < 3 { of_tilts } else { 1.0 };
            pressure += (load / lambda * ratio).abs() * bound;
        }
        let (load, bound) = (*load.first()?, self.bounds[0]);
        let mean = load / self.compliance[0] * of_mean;
        if load * bound > target && mean * bound > pressure {
            Some(PillarStatus::Full)
        } else if load * bound < -target {
            Some(PillarStatus::Untouched)
        } else {
            None
        }
    }

    /// Status of a pillar under `load`, the required displacement; `rim` must have the same number of modes.
    ///
    /// It is untouched if the required displacement is positive nowhere, and fully touched if the unconstrained pressure is negative
    /// nowhere. With a NaN load it counts as partial, and has no solution.
    pub(crate) fn status(&self, load: &[f64], rim: &mut Rim) -> PillarStatus {
        if let Some(status) = self.plain_status(load, self.column) {
            return status;
        }
        let mut touched = false;
        let mut smallest = f64::INFINITY;
        let mut largest = 0.0_f64;
        for node in 0..self.count {
            let target = self.values(node).iter().zip(load);
            let target = target.map(|(y, b)| y * b).sum();
            let of_modes = self.pressures.iter().skip(node).step_by(self.count);
            let pressure: f64 = of_modes.zip(load).map(|(p, b)| p * b).sum();
            touched |= !within(target, 0.0);
            smallest = smaller(smallest, pressure);
            largest = larger(largest, pressure.abs());
        }
        if touched && smallest >= -PRESSURE_TOLERANCE * largest {
            PillarStatus::Full
        } else if touched || (self.resolution.rings > 0 && rim.is_touched(load)) {
            PillarStatus::Partial
        } else {
            PillarStatus::Untouched
        }
    }
}

impl LocalSolver {
    pub(crate) fn new(top: &PillarTop) -> Self {
        Self {
            pivot: PivotSolver::new(top.count, top.lead),
            rim: None,
            cells: None,
            column: None,
            on_cells: false,
        }
    }

    /// The narrow region of contact of a load, if that is the whole contact.
    fn rim_contact(
        &mut self,
        top: &PillarTop,
        load: &[f64],
        active: &[bool],
    ) -> Option<RimContact> {
        if top.resolution.rings == 0 {
            return None;
        }
        let rim = self
            .rim
            .get_or_insert_with(|| Rim::new(degree_with(load.len())));
        rim.rim_contact(load, !active.is_empty() && active.len() != top.count)
    }

    /// Computes the pressure under `load` (leading modes suffice; the others count as zero).
    ///
    /// `active` marks the nodes without pressure: an initial guess on entry, or empty, and the solution on return. For a narrow contact it
    /// marks the cells with pressure.
    pub(crate) fn solve(
        &mut self,
        top: &PillarTop,
        load: &[f64],
        active: &mut Vec<bool>,
    ) -> Pivoting {
        if let Some(rim_contact) = self.rim_contact(top, load, active) {
            self.on_cells = true;
            if self.column != Some(top.column) {
                (self.cells, self.column) = (None, Some(top.column));
            }
            let cells = self.cells.get_or_insert_with(|| {
                Box::new(RimSolver::new(top.resolution, top.lead, top.column))
            });
            return cells.solve(&rim_contact, load, active);
        }
        self.on_cells = false;
        top.pressures(load, &mut self.pivot.constant);
        if active.len() != top.count {
            // Nodes that would be in tension without the constraint, or under low pressure.
            let pressures = &self.pivot.constant;
            let low = LOW_PRESSURE * largest(pressures.iter().copied());
            active.clear();
            active.extend(pressures.iter().map(|q| *q < low));
        }
        self.pivot
            .solve(&top.response, top.inverse.as_ref(), active)
    }

    /// The cells of the last solution, if it was a narrow contact.
    pub(crate) fn cells(&self) -> Option<&RimSolver> {
        self.cells.as_deref().filter(|_| self.on_cells)
    }

    /// Coefficients of the solution, `Lam^-1 (b + V' s)`: as many as `coefficients` contains.
    pub(crate) fn coefficients(&self, top: &PillarTop, load: &[f64], coefficients: &mut [f64]) {
        if let Some(cells) = self.cells() {
            return cells.coefficients(coefficients);
        }
        let count = coefficients.len();
        coefficients.fill(0.0);
        coefficients[..load.len().min(count)].copy_from_slice(&load[..load.len().min(count)]);
        for (node, s) in self.pivot.multipliers() {
            for (c, value) in coefficients.iter_mut().zip(top.values(node)) {
                *c += value * s;
            }
        }
        for (c, lambda) in coefficients.iter_mut().zip(&top.compliance) {
            *c /= lambda;
        }
    }

    /// Coefficients at another load, of any sign, with the nodes or cells of the last solution held fixed.
    pub(crate) fn respond_fixed(
        &mut self,
        top: &PillarTop,
        load: &[f64],
        active: &[bool],
        coefficients: &mut [f64],
    ) {
        if self.on_cells
            && let Some(cells) = &mut self.cells
        {
            return cells.respond_fixed(load, active, coefficients);
        }
        top.pressures(load, &mut self.pivot.constant);
        self.pivot
            .solve_active(&top.response, top.inverse.as_ref(), active);
        self.coefficients(top, load, coefficients);
    }

    /// Motion of the narrow contact of the last solution with its load; empty on nodes. `None` if it has only just formed. Solve again
    /// before other calls.
    pub(crate) fn motions(&mut self, load: &[f64], active: &[bool]) -> Option<Vec<Motion>> {
        match (&mut self.cells, &mut self.rim) {
            (Some(cells), Some(rim)) if self.on_cells => cells.motions(rim, load, active),
            _ => Some(Vec::new()),
        }
    }

    /// Derivative of the leading coefficients with respect to the leading load with the active nodes held fixed,
    /// `Lam^-1 - Lam^-1 V_I' G_II^-1 V_I Lam^-1`, row by row into `derivative`. With `H = G^-1` on the other nodes `J` and `U = V'^-1` it is
    /// `U_J' H_JJ^-1 U_J`.
    pub(crate) fn derivative(&mut self, top: &PillarTop, derivative: &mut [f64]) {
        if self.on_cells
            && let Some(cells) = &mut self.cells
        {
            return cells.derivative(derivative);
        }
        let lead = top.lead;
        if self.pivot.is_exchanged() {
            let loads = top.loads();
            self.pivot
                .projected_inverse(lead, derivative, |node, mode| {
                    loads[mode * top.count + node]
                });
            return;
        }
        self.pivot
            .projected_inverse(lead, derivative, |node, mode| {
                top.pressures[mode * top.count + node]
            });
        for (index, value) in derivative.iter_mut().enumerate() {
            let (row, column) = (index / lead, index % lead);
            let free = if row == column {
                top.compliance[row].recip()
            } else {
                0.0
            };
            *value = free - *value;
        }
    }
}

/// `G = V Lam^-1 V'`, ring by ring: the compliance of a mode depends on its degree `l` and order `m` alone, so that
/// `cos m theta cos m theta' + sin m theta sin m theta' = cos m(theta - theta')` leaves one sum over the orders for two nodes,
/// with the sums over the degrees common to two rings.
fn node_responses(nodes: &[Node], basis: &mut BasisEvaluator, compliance: &[f64]) -> Vec<f64> {
    let count = nodes.len();
    let modes = basis.modes().to_vec();
    let orders = modes.last().map_or(1, |mode| mode.degree + 1);
    let rings: Vec<&[Node]> = nodes
        .chunk_by(|a, b| (a.mu, a.rho) == (b.mu, b.rho))
        .collect();
    // On a ray of the angle 0; sines are zero there.
    let on_ray: Vec<Vec<f64>> = rings
        .iter()
        .map(|ring| {
            let mut values = vec![0.0; compliance.len()];
            basis.evaluate_polar(ring[0].mu, ring[0].rho, [1.0, 0.0], &mut values);
            values
        })
        .collect();
    // Cosines of all orders, then sines, node by node.
    let width = 2 * orders;
    let mut waves = vec![0.0; count * width];
    for (node, waves) in nodes.iter().zip(waves.chunks_exact_mut(width)) {
        let [cos, sin] = node.direction;
        let (cosines, sines) = waves.split_at_mut(orders);
        cosines[0] = 1.0;
        for m in 1..orders {
            cosines[m] = cosines[m - 1] * cos - sines[m - 1] * sin;
            sines[m] = sines[m - 1] * cos + cosines[m - 1] * sin;
        }
    }
    let mut responses = vec![0.0; count * count];
    let mut weighted = vec![0.0; width];
    let mut start = 0;
    for (k, ring) in rings.iter().enumerate() {
        let mut other_start = 0;
        for (l, other) in rings[..=k].iter().enumerate() {
            let mut sums = vec![0.0; orders];
            let products = on_ray[k].iter().zip(&on_ray[l]).zip(compliance);
            for (mode, ((one, other), compliance)) in modes.iter().zip(products) {
                sums[mode.order] += one * other / compliance;
            }
            widest(
                #[inline(always)]
                || {
                    for row in start..start + ring.len() {
                        let own = waves[row * width..][..width].chunks_exact(orders);
                        for (to, own) in weighted.chunks_exact_mut(orders).zip(own) {
                            for ((to, own), sum) in to.iter_mut().zip(own).zip(&sums) {
                                *to = own * sum;
                            }
                        }
                        let others = waves[other_start * width..].chunks_exact(width);
                        let row = &mut responses[row * count + other_start..][..other.len()];
                        for (response, other) in row.iter_mut().zip(others) {
                            *response = inner_dot(&weighted, other);
                        }
                    }
                },
            );
            other_start += other.len();
        }
        start += ring.len();
    }
    // Within a ring both halves have been computed, equal but for rounding.
    for row in 0..count {
        for column in row + 1..count {
            responses[row * count + column] = responses[column * count + row];
        }
    }
    responses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::halfspace::disc::basis::UNIT_FORCE;
    use crate::numerics::quadrature::hemisphere;
    use crate::numerics::vector::dot;

    /// Projects a required displacement on the modes.
    fn project(degree: usize, target: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        let mut basis = BasisEvaluator::new(degree);
        let mut values = vec![0.0; mode_count(degree)];
        let mut load = vec![0.0; mode_count(degree)];
        for (point, weight) in hemisphere(degree + 4, 4 * degree + 9) {
            basis.evaluate(point, &mut values);
            for (b, y) in load.iter_mut().zip(&values) {
                *b += weight * target(point) * y;
            }
        }
        load
    }

    fn solve(degree: usize, load: &[f64]) -> (Vec<f64>, Vec<bool>, Pivoting) {
        let top = PillarTop::new(Resolution::of_nodes(degree), 2, 0.0);
        let mut solver = LocalSolver::new(&top);
        let mut active = vec![false; top.count()];
        let pivoting = solver.solve(&top, load, &mut active);
        let mut coefficients = vec![0.0; top.count()];
        solver.coefficients(&top, load, &mut coefficients);
        (coefficients, active, pivoting)
    }

    /// Expected: sums over all modes, node by node.
    #[test]
    fn responses_between_nodes_are_sums_over_modes() {
        for (degree, turn, column) in [(0, 0.0, 0.3), (2, 0.0, 0.0), (10, 0.4, 0.7)] {
            let resolution = Resolution {
                turn,
                ..Resolution::of_nodes(degree)
            };
            let top = PillarTop::new(resolution, degree.min(2), column);
            for (row, one) in top.values.chunks_exact(top.count).enumerate() {
                for (place, other) in top.values.chunks_exact(top.count).enumerate() {
                    let terms = one.iter().zip(other).zip(&top.compliance);
                    let expected: f64 = terms.map(|((a, b), lambda)| a * b / lambda).sum();
                    let own: f64 = one
                        .iter()
                        .zip(&top.compliance)
                        .map(|(a, l)| a * a / l)
                        .sum();
                    let found = top.response[row * top.count + place];
                    assert!((found - expected).abs() < 1e-13 * own, "{row} {place}");
                }
            }
        }
    }

    #[test]
    fn loads_that_are_no_numbers_have_no_solution() {
        let resolution = Resolution {
            rings: 10,
            ..Resolution::of_nodes(8)
        };
        let top = PillarTop::new(resolution, 2, 0.3);
        let mut solver = LocalSolver::new(&top);
        let tilted = project(2, |[x, _]| 0.2 + x);
        assert!(
            solver
                .solve(&top, &tilted, &mut vec![false; top.count()])
                .converged
        );
        for mode in 0..tilted.len() {
            for odd in [f64::NAN, f64::INFINITY] {
                let mut load = tilted.clone();
                load[mode] = odd;
                for guess in [false, true] {
                    let mut active = vec![guess; top.count()];
                    let pivoting = solver.solve(&top, &load, &mut active);
                    assert!(!pivoting.converged, "{odd} in mode {mode}");
                }
            }
            let mut load = tilted.clone();
            load[mode] = f64::NAN;
            let status = top.status(&load, &mut Rim::new(2));
            assert_eq!(status, PillarStatus::Partial, "mode {mode}");
        }
    }

    #[test]
    fn flat_punch_is_exact() {
        // F = 2 E* a zeta, Johnson, Contact Mechanics, eq. 3.36.
        let (coefficients, active, pivoting) = solve(8, &[UNIT_FORCE]);
        assert!(pivoting.converged && active.iter().all(|active| !active));
        assert!((UNIT_FORCE * coefficients[0] - 2.0).abs() < 1e-14);
    }

    #[test]
    fn half_covered_tilted_punch_converges_and_is_complementary() {
        // A plane at x = 0 level with the top, rising to both sides: the required displacement is positive on half of the disc. Reference:
        // the same at degree 32, differences as documented.
        let force = |degree| {
            let load = project(2, |[x, _]| x);
            let (coefficients, active, pivoting) = solve(degree, &load);
            assert!(pivoting.converged);
            let top = PillarTop::new(Resolution::of_nodes(degree), 2, 0.0);
            let pressure: Vec<f64> = (0..top.count())
                .map(|node| dot(top.values(node), &coefficients))
                .collect();
            for (q, active) in pressure.iter().zip(&active) {
                assert!(*q > -1e-9, "tension {q}");
                assert!(!active || q.abs() < 1e-9);
            }
            UNIT_FORCE * coefficients[0]
        };
        let fine = force(32);
        for (degree, tolerance) in [(8, 1e-2), (12, 3e-3), (16, 2e-3), (24, 2e-3)] {
            let relative = force(degree) / fine - 1.0;
            println!("tilted punch, degree {degree}: {relative:e}");
            assert!(relative.abs() < tolerance, "degree {degree}: {relative}");
        }
    }

    /// Expected: the solution on the active nodes, where most nodes are active and the others are solved for instead.
    #[test]
    fn narrow_contacts_are_the_same_on_the_nodes_under_pressure() {
        for degree in [8, 16, 24] {
            let inverse = PillarTop::new(Resolution::of_nodes(degree), 2, 0.3);
            let direct = PillarTop {
                inverse: None,
                ..inverse.clone()
            };
            for level in [0.1, -0.2, -0.6, -0.9] {
                let load = project(2, |[x, y]| level + x + 0.1 * y);
                let [one, other] = [&direct, &inverse].map(|top| {
                    let mut solver = LocalSolver::new(top);
                    let mut active = Vec::new();
                    assert!(solver.solve(top, &load, &mut active).converged);
                    let mut derivative = vec![0.0; 36];
                    solver.derivative(top, &mut derivative);
                    let mut coefficients = vec![0.0; top.count()];
                    solver.coefficients(top, &load, &mut coefficients);
                    (active, coefficients, derivative)
                });
                assert_eq!(one.0, other.0);
                for (one, other) in one.1.iter().zip(&other.1).chain(one.2.iter().zip(&other.2)) {
                    assert!(
                        (one - other).abs() < 1e-9,
                        "{degree} {level}: {one} {other}"
                    );
                }
            }
        }
    }

    #[test]
    fn derivative_is_that_of_the_solution() {
        // Linear as long as the active nodes stay the same: a central difference is exact.
        let top = PillarTop::new(Resolution::of_nodes(12), 2, 0.3);
        let mut solver = LocalSolver::new(&top);
        let mut load = project(2, |[x, y]| 0.4 + x - 0.2 * y - 0.1 * x * x);
        let mut active = vec![false; top.count()];
        assert!(solver.solve(&top, &load, &mut active).converged);
        assert!(active.iter().any(|active| *active));
        let mut derivative = vec![0.0; 36];
        solver.derivative(&top, &mut derivative);
        let mut moved = [vec![0.0; 6], vec![0.0; 6]];
        for j in 0..6 {
            for (sign, coefficients) in [1e-7, -1e-7].into_iter().zip(&mut moved) {
                load[j] += sign;
                assert!(solver.solve(&top, &load, &mut active).converged);
                solver.coefficients(&top, &load, coefficients);
                load[j] -= sign;
            }
            for i in 0..6 {
                let difference = (moved[0][i] - moved[1][i]) / 2e-7;
                assert!((difference - derivative[i * 6 + j]).abs() < 1e-6);
            }
        }
    }
}
