//! Which rows of a measurement on an adhesive flat surface are in contact.
//!
//! The force jumps where the lens touches and where it detaches. If the model decided at every step of a search on which side of a jump a row is, the sum of
//! squares would have steps, and the search would stop at one of them. The data show it: the jump is the largest fall of the force with increasing load.

use super::measurements::Measurements;

/// A jump is found if it is this many times larger than the median of the second differences of the forces, which is 1.65 standard deviations of normal noise:
/// the largest of a hundred differences of noise is less.
const CLEAR: f64 = 4.0;

/// For every row, whether the lens is attached; `None` where the data do not show it. `orders` are the rows of both branches in the order of increasing load.
pub(super) fn attached(data: &Measurements, orders: &[Vec<usize>; 2]) -> Vec<Option<bool>> {
    let rows = data.rows();
    let mut attached = vec![None; rows.len()];
    let forces: [Vec<(usize, f64)>; 2] = orders.each_ref().map(|order| {
        let of_row = |number: &usize| {
            let row = rows.get(*number)?;
            row.position?; // without a position the force is the load
            Some((*number, row.force?.value))
        };
        order.iter().filter_map(of_row).collect()
    });
    let mut seconds: Vec<f64> = forces
        .iter()
        .flat_map(|forces| forces.windows(3))
        .map(|three| (three[0].1 - 2.0 * three[1].1 + three[2].1).abs())
        .collect();
    seconds.sort_by(f64::total_cmp);
    let Some(median) = seconds.get(seconds.len() / 2) else {
        return attached;
    };
    for forces in &forces {
        let falls = forces.windows(2).map(|pair| pair[0].1 - pair[1].1);
        let largest = falls.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((place, _)) = largest.filter(|(_, fall)| *fall > CLEAR * median) else {
            continue;
        };
        for (number, (row, _)) in forces.iter().enumerate() {
            attached[*row] = Some(number > place);
        }
    }
    attached
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::column::Column;

    fn of(forces: Vec<f64>) -> Vec<Option<bool>> {
        let loads = (0..forces.len()).map(|k| k as f64 * 1e-6).collect();
        let rows = (0..forces.len()).collect();
        let columns = [(Column::Displacement, loads), (Column::Force, forces)];
        attached(&Measurements::new(&columns).unwrap(), &[rows, Vec::new()])
    }

    #[test]
    fn the_largest_fall_is_the_jump() {
        let found = of(vec![0.0, 0.1, -0.1, -3.0, -2.7, -2.3, -1.8, -1.2]);
        let expected = [false, false, false, true, true, true, true, true];
        assert_eq!(found, expected.map(Some));
    }

    #[test]
    fn without_a_clear_jump_nothing_is_known() {
        assert_eq!(of(vec![0.0, 0.1, -0.1, 0.1, 0.0, 0.2, 0.1, 0.5]), [None; 8]);
        assert_eq!(of(vec![0.0, 1.0]), [None; 2]);
    }
}
