//! Which rows of a measurement on an adhesive flat surface are in contact.
//!
//! The force jumps where the lens touches and where it detaches. If the model decided at every step of a search on which side of a jump a row is, the sum of
//! squares would have steps, and the search would stop at one of them. The data show it: the jump is the largest fall of the force with increasing load.
//! A lens that is about to detach has a steep curve too, of the shape of a square root: a fall that continues in this shape is no jump. A branch without a
//! jump that begins in tension is attached as a whole.

use super::measurements::Measurements;

/// A jump is found if it is this many times larger than the median of the second differences of the forces, which is 1.65 standard deviations of normal noise:
/// the largest of a hundred differences of noise is less.
const CLEAR: f64 = 4.0;

/// A row that can be compared.
#[derive(Debug, Clone, Copy)]
struct Place {
    row: usize,
    load: f64,
    force: f64,
}

/// For every row, whether the lens is attached; `None` where the data do not show it. `orders` are the rows of both branches in the order of increasing load,
/// `zero` is the reading without force, if it is known.
pub(super) fn attached(
    data: &Measurements,
    orders: &[Vec<usize>; 2],
    zero: Option<f64>,
) -> Vec<Option<bool>> {
    let rows = data.rows();
    let mut attached = vec![None; rows.len()];
    let branches: [Vec<Place>; 2] = orders.each_ref().map(|order| {
        let of_row = |number: &usize| {
            let row = rows.get(*number)?;
            Some(Place {
                row: *number,
                load: row.position?.value, // without a position the force is the load
                force: row.force?.value,
            })
        };
        order.iter().filter_map(of_row).collect()
    });
    let mut seconds: Vec<f64> = branches
        .iter()
        .flat_map(|places| places.windows(3))
        .map(|three| (three[0].force - 2.0 * three[1].force + three[2].force).abs())
        .collect();
    seconds.sort_by(f64::total_cmp);
    let Some(median) = seconds.get(seconds.len() / 2) else {
        return attached;
    };
    let clear = CLEAR * median;
    for places in &branches {
        let falls = places.windows(2).map(|pair| pair[0].force - pair[1].force);
        let largest = falls.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let is_jump = |place: usize, fall: f64| match place {
            0 => !is_steep(places, *median),
            // The steepest fall of an attached lens is the first one; before a jump there is no force.
            _ => 2.0 * (places[place - 1].force - places[place].force) < fall,
        };
        let jump = largest.filter(|(place, fall)| *fall > clear && is_jump(*place, *fall));
        let begins_in_tension = match (places.first(), zero) {
            (Some(first), Some(zero)) => first.force < zero - clear,
            _ => false,
        };
        for (number, place) in places.iter().enumerate() {
            attached[place.row] = match jump {
                Some((last, _)) => Some(number > last),
                None => begins_in_tension.then_some(true),
            };
        }
    }
    attached
}

/// Whether the fall of the force from the first row to the second continues to the third as under an attached lens near its end, where the force follows a
/// square root of the load at the steepest, up to a noise.
fn is_steep(places: &[Place], noise: f64) -> bool {
    let [first, second, third, ..] = places else {
        return false;
    };
    let [near, far] = [second, third].map(|place| (place.load - first.load).max(0.0).sqrt());
    let falls = [first.force - second.force, second.force - third.force];
    falls[0] * (far - near) <= (falls[1] + noise) * near
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::column::Column;

    fn of(forces: Vec<f64>) -> Vec<Option<bool>> {
        let loads = (0..forces.len()).map(|k| k as f64 * 1e-6).collect();
        let rows = (0..forces.len()).collect();
        let columns = [(Column::Displacement, loads), (Column::Force, forces)];
        let data = Measurements::new(&columns).unwrap();
        attached(&data, &[rows, Vec::new()], Some(0.0))
    }

    #[test]
    fn the_largest_fall_is_the_jump() {
        let found = of(vec![0.0, 0.1, -0.1, -3.0, -2.7, -2.3, -1.8, -1.2]);
        let expected = [false, false, false, true, true, true, true, true];
        assert_eq!(found, expected.map(Some));
    }

    #[test]
    fn a_jump_between_rows_that_are_far_apart_is_one() {
        let forces = vec![0.0, 0.01, -0.01, -1.0, -1.7, -2.0, -2.1, -2.0, -1.8, -1.4];
        let expected: Vec<_> = (0..10).map(|row| Some(row > 2)).collect();
        assert_eq!(of(forces), expected);
    }

    /// `-1 - sqrt(load)` under a lens that is about to detach: its end is no jump. Nor is the end of a measurement in tension.
    #[test]
    fn an_attached_branch_has_no_jump() {
        for beyond in [0.0, 0.3, 5.0] {
            let forces = (0..12).map(|k| -1.0 - (beyond + f64::from(k)).sqrt());
            assert_eq!(of(forces.collect()), [Some(true); 12]);
        }
        assert_eq!(
            of((0..9).map(|k| -5.0 + f64::from(k)).collect()),
            [Some(true); 9]
        );
    }

    #[test]
    fn without_a_clear_jump_nothing_is_known() {
        assert_eq!(of(vec![0.0, 0.1, -0.1, 0.1, 0.0, 0.2, 0.1, 0.5]), [None; 8]);
        assert_eq!(of(vec![0.0, 1.0]), [None; 2]);
    }
}
