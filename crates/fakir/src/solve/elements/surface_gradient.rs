//! Derivatives of a contact with a height map.
//!
//! On the cells in contact the pressures satisfy `c B p + C p = zeta - g`, with the compliance `c` of both half-spaces, the columns `C` of the pillars and
//! the separation `g`. Cells join or leave the contact with neither pressure nor gap, so that to first order they stay: with the solution `q` for
//! `zeta - g = 1`, the contact of a flat end of their shape, the stiffness is the sum of `q`, and a change of a quantity changes the force by
//! `q (-dg - dc B p - dC p)`.
//!
//! On layers `B` is the response of the half-spaces and a correction, which is linear in the weights of the layers: its derivative by a thickness, a modulus or a
//! Poisson's ratio is the correction for other weights, applied to the same pressures.

use super::solver::Prescribed;
use super::surface_level::Level;
use crate::halfspace::elements::Operator;
use crate::halfspace::elements::half_space::HalfSpace;
use crate::problem::layer::WeightedLayer;
use crate::problem::{Cells, Load, Material, Quantity, SurfaceSystem, Unsupported};
use crate::state::{Derivatives, Gradient, Run, SolveError, SurfaceContact};

impl SurfaceSystem {
    /// The contact with the derivatives of force or indentation by the numbers of the bodies: moduli, Poisson's ratios, those of layers and their bases,
    /// thicknesses, and the radius of the lens, in which its lowest point stays where it is.
    ///
    /// They are those of the solution on its cells. Pillars shorten in inverse proportion to the modulus of the substrate. The contact area has no
    /// derivative, as it changes in steps of cells.
    ///
    /// # Errors
    /// As [`press`](Self::press); [`SolveError::NoGradient`] if nothing is touched, and for the critical state; [`SolveError::Unsupported`] with adhesion.
    pub fn gradient(
        &self,
        load: Load,
        run: &Run<'_>,
    ) -> Result<Gradient<SurfaceContact>, SolveError> {
        if !self.adhesion().is_none() {
            return Err(SolveError::Unsupported(Unsupported::GRADIENT_WITH_ADHESION));
        }
        let none = |why| SolveError::NoGradient { why };
        let is_force_given = match load {
            Load::Indentation(_) => false,
            Load::Force(_) => true,
            Load::FloorContact => {
                return Err(none(
                    "prescribe the indentation or the force: the critical state of a height map has no derivatives",
                ));
            }
        };
        let contact = self.press(load, run)?;
        if contact.contact_area <= 0.0 {
            return Err(none("the surface is not touched; raise the load"));
        }
        let in_contact: Vec<usize> = (0..contact.pressure.len())
            .filter(|cell| contact.pressure[*cell] > 0.0)
            .collect();
        let unit = self.flat_end(&in_contact, run)?;
        if in_contact.iter().any(|cell| unit[*cell] <= 0.0) {
            return Err(none(
                "a part of the contact detaches from a flat end of its shape, as layers rise beside a load; change the load a little",
            ));
        }
        let area = contact.grid.cell_area();
        let sum = |of: &dyn Fn(usize) -> f64| {
            area * in_contact
                .iter()
                .map(|cell| unit[*cell] * of(*cell))
                .sum::<f64>()
        };
        let stiffness = sum(&|_| 1.0);
        let shortening = self.shortening(&contact, &in_contact);
        // The displacement of the columns, and that of the half-spaces, which is in proportion to their compliance.
        let of_column = |cell: usize| {
            let pillar = self.surface.label(cell) as usize;
            shortening.get(pillar).copied().unwrap_or(0.0)
        };
        let in_columns = sum(&of_column);
        let in_half_spaces = sum(&|cell| contact.displacement[cell] - of_column(cell));
        let compliance = self.contact_compliance();
        let mut forces = Vec::new();
        let mut add_body = |material: &Material, names: [Quantity; 2], columns: f64| {
            let part = material.plane_strain_compliance() / compliance;
            let by_modulus = (part * in_half_spaces + columns) / material.young_modulus;
            let ratio = material.poisson_ratio;
            let by_ratio = 2.0 * ratio / (material.young_modulus * compliance) * in_half_spaces;
            forces.extend([(names[0], by_modulus), (names[1], by_ratio)]);
        };
        add_body(
            self.substrate(),
            [
                Quantity::SubstrateYoungModulus,
                Quantity::SubstratePoissonRatio,
            ],
            in_columns,
        );
        if let Some(material) = self.indenter().material() {
            add_body(
                &material,
                [Quantity::LensYoungModulus, Quantity::LensPoissonRatio],
                0.0,
            );
        }
        if let Some(lens) = self
            .indenter()
            .lens()
            .filter(|lens| lens.radius().is_some())
        {
            let grid = &contact.grid;
            let place = |cell: usize| grid.centre(cell % grid.columns(), cell / grid.columns());
            let moved = sum(&|cell| lens.by_radius(place(cell)));
            forces.push((Quantity::LensRadius, -moved));
        }
        for (quantity, moved) in self.layer_displacements(&contact, run)? {
            let change = -sum(&|cell| moved[cell]);
            match forces.iter_mut().find(|(name, _)| *name == quantity) {
                Some((_, by)) => *by += change,
                None => forces.push((quantity, change)),
            }
        }
        let indentations = forces.iter().map(|(name, by)| (*name, -by / stiffness));
        let of = |quantities| Derivatives {
            heights: Vec::new(),
            quantities,
            column_compliance: 0.0,
        };
        Gradient {
            stiffness,
            indentation: is_force_given.then(|| of(indentations.collect())),
            force: (!is_force_given).then(|| of(forces)),
            area: None,
            contact,
        }
        .with_checked_derivatives()
    }

    /// Derivatives of the displacement of every cell under the same pressures, by what changes the response of layers.
    fn layer_displacements(
        &self,
        contact: &SurfaceContact,
        run: &Run<'_>,
    ) -> Result<Vec<(Quantity, Vec<f64>)>, SolveError> {
        let changes = self.layer_changes();
        if changes.is_empty() {
            return Ok(Vec::new());
        }
        let grid = &contact.grid;
        let loaded = Cells::where_true(grid, |cell| contact.pressure[cell] > 0.0);
        let mut pressure = vec![0.0; loaded.len()];
        loaded.gather(&contact.pressure, &mut pressure);
        let displaced = |layers: &[WeightedLayer]| {
            let (cells, compliance) = (loaded.clone(), self.contact_compliance());
            let mut operator = HalfSpace::new(self.boundary(), cells, compliance, layers, run.pool);
            let mut displacement = vec![0.0; loaded.len()];
            operator.apply(&pressure, &mut displacement);
            displacement
        };
        let without_layers = displaced(&[]);
        let change = |(quantity, layers): (Quantity, Vec<WeightedLayer>)| {
            run.check_cancelled()?;
            let mut change = displaced(&layers);
            let pairs = change.iter_mut().zip(&without_layers);
            pairs.for_each(|(with, without)| *with -= without);
            let mut everywhere = vec![0.0; grid.cell_count()];
            loaded.scatter(&change, &mut everywhere);
            Ok((quantity, everywhere))
        };
        changes.into_iter().map(change).collect()
    }

    /// Pressures per unit indentation of a flat end that covers these cells.
    fn flat_end(&self, cells: &[usize], run: &Run<'_>) -> Result<Vec<f64>, SolveError> {
        let mut end = Level::new(self, self.surface.clone(), None, run);
        end.separation.fill(f64::INFINITY);
        for cell in cells {
            end.separation[*cell] = 0.0;
        }
        end.press(Prescribed::Indentation(1.0))?;
        Ok(end.pressure)
    }

    /// Shortening of every pillar, m.
    fn shortening(&self, contact: &SurfaceContact, in_contact: &[usize]) -> Vec<f64> {
        let compliance = self.surface.pillars().map(|it| it.compliance.as_slice());
        let compliance = compliance.unwrap_or_default();
        let mut shortening = vec![0.0; compliance.len()];
        for cell in in_contact {
            let pillar = self.surface.label(*cell) as usize;
            if let Some(sum) = shortening.get_mut(pillar) {
                *sum += compliance[pillar] * contact.grid.cell_area() * contact.pressure[*cell];
            }
        }
        shortening
    }
}
