//! Signs of instruments: compression that is counted negative, and positions that decrease as the lens moves down.

use super::column::Column;
use super::reading::RowValues;

/// Which signs of a file are reversed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Reversed {
    pub(super) position: bool,
    pub(super) force: bool,
}

/// Fewest rows from which signs are detected.
const FEWEST_ROWS: usize = 8;

/// Largest force out of contact, as a fraction of the force at the other end of the positions.
const OUT_OF_CONTACT: f64 = 0.1;

/// Detects reversed signs. The force is near zero at one end of the positions and largest at the other one, where the lens is in contact: there the
/// position is the largest one, and the force is positive. If `is_open`, no sign is known, and the force may have an offset: contact is
/// at the end where the force changes most. The same holds for a load cell that was not set to zero, if the unloading begins at that end.
pub(super) fn reversed(rows: &[(u64, RowValues)], is_open: bool) -> Reversed {
    let value = |row: &RowValues, wanted: &[Column]| {
        let mut values = row.iter().filter(|(column, _)| wanted.contains(column));
        values.next().map(|(_, value)| *value)
    };
    let positions = [Column::Displacement, Column::Indentation];
    let mut points: Vec<[f64; 2]> = rows
        .iter()
        .filter_map(|(_, row)| Some([value(row, &positions)?, value(row, &[Column::Force])?]))
        .collect();
    if points.len() < FEWEST_ROWS {
        return Reversed::default();
    }
    let turns_high = turning_end(&points);
    points.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let found = signs_at_ends(&points, is_open);
    let is_confirmed =
        |found: &Reversed| turns_high.is_some_and(|is_high| is_high != found.position);
    let with_offset = || signs_at_ends(&points, true).filter(is_confirmed);
    found.or_else(with_offset).unwrap_or_default()
}

/// Whether the motion reverses at the largest position or at the smallest one, for positions in the order of the rows; `None` if it reverses at both or
/// at neither.
fn turning_end(points: &[[f64; 2]]) -> Option<bool> {
    let margin = points.len() / 20 + 1;
    let is_inside = |sign: f64| {
        let places = points.iter().map(|point| sign * point[0]).enumerate();
        let farthest = places.max_by(|one, other| one.1.total_cmp(&other.1));
        farthest.is_some_and(|(place, _)| place >= margin && place + margin < points.len())
    };
    match [is_inside(1.0), is_inside(-1.0)] {
        [true, false] => Some(true),
        [false, true] => Some(false),
        _ => None,
    }
}

/// The signs that follow from the forces at both ends of the positions, which are sorted; `None` if the forces do not determine them.
fn signs_at_ends(points: &[[f64; 2]], is_open: bool) -> Option<Reversed> {
    let count = points.len();
    let mean = |points: &[[f64; 2]]| {
        points.iter().map(|point| point[1]).sum::<f64>() / points.len() as f64
    };
    let end = (count / 20).max(1);
    let [low, high] = [mean(&points[..end]), mean(&points[count - end..])];
    let mut offset = 0.0;
    let mut is_high = high.abs() >= low.abs();
    if is_open {
        let inner = (count / 5).max(end);
        let changes = [
            (low - mean(&points[inner..inner + end])).abs(),
            (high - mean(&points[count - inner - end..count - inner])).abs(),
        ];
        is_high = changes[1] >= changes[0];
        offset = if is_high { low } else { high };
        let [least, most] = if is_high {
            changes
        } else {
            [changes[1], changes[0]]
        };
        if 3.0 * least > most {
            return None;
        }
    }
    let (contact, other) = if is_high { (high, low) } else { (low, high) };
    let (contact, other) = (contact - offset, other - offset);
    let largest = points.iter().map(|point| (point[1] - offset).abs());
    let largest = largest.fold(0.0, f64::max);
    if other.abs() > OUT_OF_CONTACT * contact.abs() || contact.abs() < 0.5 * largest {
        return None;
    }
    let end = if is_high { count - 1 } else { 0 };
    if contact < 0.0 && pulls_more_before(points, points[end][0], offset) {
        return None;
    }
    Some(Reversed {
        position: !is_high,
        force: contact < 0.0,
    })
}

/// Whether a force that is negative at the end of the positions in contact is more so at a distance from it. A compression
/// is largest where the lens is deepest; a pull is largest just before the lens is pulled off.
fn pulls_more_before(points: &[[f64; 2]], deepest: f64, offset: f64) -> bool {
    /// Distance from the deepest position, as a fraction of the range.
    const DISTANCE: f64 = 0.1;
    /// Increase of the force beyond noise; a compression is at most 0.9 of its largest there.
    const INCREASE: f64 = 1.05;
    let range = points[points.len() - 1][0] - points[0][0];
    let (near, far): (Vec<&[f64; 2]>, Vec<&[f64; 2]>) = points
        .iter()
        .partition(|point| (point[0] - deepest).abs() <= DISTANCE * range);
    let least = |points: &[&[f64; 2]]| {
        let forces = points.iter().map(|point| point[1] - offset);
        forces.fold(0.0, f64::min)
    };
    least(&far) < INCREASE * least(&near)
}

/// Whether forces that are the loads are all negative.
pub(super) fn are_negative(rows: &[(u64, RowValues)]) -> bool {
    let forces = rows.iter().flat_map(|(_, row)| row);
    let forces = forces.filter(|(column, _)| *column == Column::Force);
    let [least, most] = forces.fold([0.0_f64, 0.0], |[least, most], (_, force)| {
        [least.min(*force), most.max(*force)]
    });
    least < 0.0 && most <= -0.01 * least && rows.len() >= FEWEST_ROWS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a loading by 20 steps, 10 of them out of contact, with signs and an offset of the force.
    fn rows(signs: [f64; 2], offset: f64) -> Vec<(u64, RowValues)> {
        let row = |step: u32| {
            let depth = f64::from(step) - 10.0;
            let force = depth.max(0.0).powf(1.5);
            let values = vec![
                (Column::Displacement, signs[0] * depth),
                (Column::Force, signs[1] * force + offset),
            ];
            (u64::from(step), values)
        };
        (0..=20).map(row).collect()
    }

    #[test]
    fn signs_are_detected() {
        for (signs, position, force) in [
            ([1.0, 1.0], false, false),
            ([1.0, -1.0], false, true),
            ([-1.0, 1.0], true, false),
            ([-1.0, -1.0], true, true),
        ] {
            let found = Reversed { position, force };
            assert_eq!(reversed(&rows(signs, 0.0), false), found);
            // An offset is more than a known sign can be compared with.
            assert_eq!(reversed(&rows(signs, 100.0), true), found);
            assert_eq!(reversed(&rows(signs, 100.0), false), Reversed::default());
        }
        // Approach and withdrawal with a load cell that was not set to zero: the lens turns in contact.
        for (signs, position, force) in [
            ([1.0, 1.0], false, false),
            ([1.0, -1.0], false, true),
            ([-1.0, 1.0], true, false),
            ([-1.0, -1.0], true, true),
        ] {
            let mut both = rows(signs, -20.0);
            both.extend(rows(signs, -20.0).into_iter().rev().skip(1));
            assert_eq!(reversed(&both, false), Reversed { position, force });
            // Withdrawal first: it turns out of contact.
            let (_, first) = both.split_at(20);
            let withdrawn: Vec<(u64, RowValues)> =
                first.iter().chain(&both[..20]).cloned().collect();
            assert_eq!(reversed(&withdrawn, false), Reversed::default());
        }
        // A pull-off that is larger than the load is no compression.
        let pull = |step: u32| {
            let depth = 10.0 - f64::from(step);
            let force = if step < 15 { 3.0 * depth } else { 0.0 };
            let values = vec![(Column::Displacement, depth), (Column::Force, force)];
            (u64::from(step), values)
        };
        let pulls: Vec<(u64, RowValues)> = (0..20).map(pull).collect();
        assert_eq!(reversed(&pulls, false), Reversed::default());
        // A contact that stays in tension: the pull at the deepest point is more than half of the pull-off force, as in a gentle contact of JKR.
        // The closer to the pull-off force the lens turns, the smaller is the difference.
        for slope in [0.1, 0.02] {
            let gentle = |step: u32| {
                let depth = f64::from(step) - 30.0;
                let force = if depth < -10.0 {
                    0.0
                } else {
                    slope * depth - 3.0
                };
                let values = vec![(Column::Displacement, depth), (Column::Force, force)];
                (u64::from(step), values)
            };
            let tension: Vec<(u64, RowValues)> = (0..=40).map(gentle).collect();
            assert_eq!(reversed(&tension, false), Reversed::default(), "{slope}");
        }
    }
}
