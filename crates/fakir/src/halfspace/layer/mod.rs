//! Response of elastic layers: the difference from a half-space.
//!
//! A pressure of wave number `k` displaces the surface of a half-space by `2 p/(E* k)`, and that of a layer of thickness `t` by `phi(k t)`
//! times as much. A force displaces the surface of the layer at the distance `r` by `(1/r + Psi(r/t)/t)/(pi E*)`, with
//! `Psi(s) = ∫_0^∞ (phi(x) - 1) J_0(x s) dx`, which is smooth: near the force the layer responds like a half-space.
//!
//! If both bodies deform, they are weighted by their fractions of the contact compliance: `Phi(k) = sum_b w_b phi_b(k t_b)`.
//!
//! `phi` of layers on a rigid base: W. C. Hayes, L. M. Keer, G. Herrmann, L. F. Mockros, J. Biomech. 5, 541 (1972), and K. L. Johnson,
//! Contact Mechanics, section 5.8; on an elastic one: D. M. Burmister, J. Appl. Phys. 16, 89 (1945).

pub(crate) mod discs;
pub(crate) mod force;
pub(crate) mod response;
pub(crate) mod table;

pub use response::LayerResponse;

#[cfg(test)]
pub(crate) mod tests {
    use crate::problem::layer::WeightedLayer;
    use crate::problem::{Layer, Material};

    /// An incompressible layer on a rigid base, twice as thick as a pillar's radius: 6 um under the paper's pillars.
    pub(crate) fn film() -> WeightedLayer {
        let film = (Material::new(1.0, 0.5), Some(Layer::new(2.0)));
        WeightedLayer::among(&[film], 1.0)[0]
    }

    /// The rows of `tests/reference/layer.csv` for a quantity: its case and its value.
    pub(crate) fn rows(quantity: &str) -> Vec<(String, f64)> {
        let table = include_str!("../../../tests/reference/layer.csv");
        let records = csv::Reader::from_reader(table.as_bytes()).into_records();
        let rows = records.map(|record| record.unwrap());
        rows.filter(|record| record[0].starts_with(quantity))
            .map(|record| (record[1].to_owned(), record[2].parse().unwrap()))
            .collect()
    }

    /// The degrees and orders in brackets, and the distance.
    pub(crate) fn modes_of(case: &str) -> (Vec<(usize, usize)>, f64) {
        let modes = case.split('(').skip(1).map(|text| {
            let inside = text.split(')').next().unwrap();
            let (degree, order) = inside.split_once(", ").unwrap();
            (degree.parse().unwrap(), order.parse().unwrap())
        });
        let distance = case.split("r=").nth(1).unwrap();
        let distance: f64 = distance.split(' ').next().unwrap().parse().unwrap();
        (modes.collect(), distance)
    }
}
