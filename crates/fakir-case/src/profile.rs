//! Tables of the heights of an axisymmetric lens.

use crate::columns::TableError;
use crate::headings::{Columns, Given};
use fakir::problem::LensProfile;
use std::path::Path;

const COLUMNS: Columns<2> = Columns {
    names: ["radius_m", "height_m"],
    required: 2,
    accepted: "a profile of a lens has radius_m and height_m",
};

/// Reads a profile of a lens: values separated by commas under a line with the names of the columns, `radius_m` and `height_m` (m), from the axis
/// outwards. Lines that begin with `#` are left out.
///
/// # Errors
/// A file that cannot be read, unknown or missing columns, values that are not numbers, and heights that are not a valid
/// [`LensProfile`], with the line.
pub(crate) fn read_profile(path: &Path) -> Result<LensProfile, TableError> {
    let table = COLUMNS.read(path, &Given::default(), [f64::NAN; 2])?;
    let column = |column: usize| table.rows.iter().map(|row| row[column]).collect();
    LensProfile::new(column(0), column(1))
        .map_err(|invalid| table.wrong(invalid.row(), invalid.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<LensProfile, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_profile(file.path()).map_err(|error| error.to_string())
    }

    #[test]
    fn profiles_are_read_row_by_row() {
        let text = "# measured\nheight_m, radius_m\n0, 0\n1e-9, 1e-6\n4e-9, 2e-6\n9e-9, 3e-6\n";
        let profile = read(text).unwrap();
        let range = profile.range();
        assert_eq!(range.to_bits(), 3e-6_f64.to_bits());
        // r^2/(2R) with R = 0.5 mm.
        assert!((profile.height(1.5e-6) / 2.25e-9 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn errors_state_their_line() {
        let wrong = |text: &str| read(text).unwrap_err();
        let begins = |text: &str, accepted: &str| {
            let wrong = wrong(text);
            assert!(wrong.contains(accepted), "{wrong}");
        };
        begins(
            "radius_m\n0\n",
            "line 1: the column height_m is missing: a profile of a lens has",
        );
        begins(
            "radius_m,height_m\n0,0\n1,1\n",
            "line 1: 2 rows are too few for a profile",
        );
        begins(
            "radius_m,height_m\n0,0\n# here\n1,high\n",
            "line 4: height_m is \"high\"",
        );
        begins(
            "radius_m,height_m\n0,1\n1,2\n2,3\n3,4\n",
            "line 2: the first row is at radius 0e0 m and height 1e0 m",
        );
        begins(
            "radius_m,height_m\n0,0\n1,2\n2,1\n3,4\n",
            "line 4: the height must be larger",
        );
        begins(
            "radius_m,height_m\n0,0\n1,2\n1,3\n3,4\n",
            "line 4: the radius must be larger",
        );
    }
}
