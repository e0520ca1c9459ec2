//! The points of a pillar top at which the pressure must not be negative.

use std::f64::consts::{FRAC_PI_2, PI};

/// Resolution of a partially covered pillar top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Resolution {
    /// Degree of the node array (even), equal to that of the modes.
    pub(crate) nodes: usize,
    /// Rotation of the node array, rad.
    pub(crate) turn: f64,
    /// Number of rings of cells for a narrow contact along the rim; there are twice as many sectors.
    pub(crate) rings: usize,
}

impl Resolution {
    /// The resolution with nodes of a degree, also for narrow contacts at the rim.
    pub(crate) const fn of_nodes(nodes: usize) -> Self {
        Self {
            nodes,
            turn: 0.0,
            rings: 0,
        }
    }
}

/// A node: `mu`, `rho` and the unit vector of its angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    pub(crate) mu: f64,
    pub(crate) rho: f64,
    pub(crate) direction: [f64; 2],
}

/// Bos array of an even `degree` `p` (for `p = 0` the centre alone): rings of `2p + 1, 2p - 3, ..., 1` points, the outermost on the edge,
/// at colatitudes `pi/2 (1 - 2k/p)`, alternate rings rotated by half a step. The values at the `(p+1)(p+2)/2` points determine a
/// combination of the modes up to degree `p` uniquely (L. Bos, J. Approx. Theory 64, 271 (1991)).
///
/// `turn` rotates the whole array about the centre, rad. All rings have odd numbers of points, so that a rotation by pi moves every node to
/// the middle between two others of its ring: an independent second array.
pub(crate) fn bos_array(degree: usize, turn: f64) -> Vec<Node> {
    debug_assert!(degree.is_multiple_of(2));
    if degree == 0 {
        return vec![Node {
            mu: 1.0,
            rho: 0.0,
            direction: [1.0, 0.0],
        }];
    }
    let mut nodes = Vec::with_capacity(super::basis::mode_count(degree));
    for ring in 0..=degree / 2 {
        let count = 2 * degree + 1 - 4 * ring;
        let colatitude = FRAC_PI_2 * (1.0 - 2.0 * ring as f64 / degree as f64);
        let (rho, mu) = colatitude.sin_cos();
        let mu = if ring == 0 { 0.0 } else { mu };
        let half_step = if ring % 2 == 1 { 0.5 } else { 0.0 };
        for k in 0..count {
            let angle = turn + 2.0 * PI * (k as f64 + half_step) / count as f64;
            let (sin, cos) = angle.sin_cos();
            nodes.push(Node {
                mu,
                rho,
                direction: [cos, sin],
            });
        }
    }
    nodes
}

/// Number of points of the outermost ring, which is on the edge.
pub(crate) const fn edge_count(degree: usize) -> usize {
    2 * degree + 1
}

#[cfg(test)]
mod tests {
    use super::super::basis::mode_count;
    use super::*;

    #[test]
    fn as_many_nodes_as_modes_the_first_ring_on_the_edge() {
        for degree in [2, 8, 16, 24] {
            let nodes = bos_array(degree, 0.0);
            assert_eq!(nodes.len(), mode_count(degree));
            assert!(
                nodes[..edge_count(degree)]
                    .iter()
                    .all(|node| node.mu == 0.0)
            );
            assert!(nodes[edge_count(degree)..].iter().all(|node| node.mu > 0.0));
        }
    }
}
