//! Tables of pillars: position and, if they differ, height and diameter of each.

use crate::columns::{Table, TableError};
use crate::headings::{Chosen, Columns, Given, Unit};
use fakir::problem::{InvalidPillars, ListedPillar, Pillar, PillarList};
use std::fmt::Display;
use std::path::Path;

const COLUMNS: Columns<4> = Columns {
    names: ["x_m", "y_m", "height_m", "diameter_m"],
    required: 2,
    accepted: "a table of pillars has x_m and y_m, and optionally height_m and diameter_m (or an area), in any unit of length: x_um or X [um]; of other tables name the columns, as pillar_columns = \"x = POSITION_X, y = POSITION_Y\"",
};

/// Columns of heights and diameters in a table of pillars.
pub(crate) const HEIGHT: usize = 2;
pub(crate) const DIAMETER: usize = 3;

/// The columns that a case names by `pattern.pillar_columns`.
///
/// # Errors
/// A description of what is wrong with the text.
pub(crate) fn chosen_columns(text: &str) -> Result<Vec<Chosen>, String> {
    COLUMNS.chosen(text)
}

/// Reads a table of pillars: values under a line with the names of the columns and their units, `x_m` and `y_m` or `X [um]` and `Y [um]`, and
/// optionally heights and diameters, or areas of tops, whose defaults are those of the common pillar, as of empty cells. Lines that begin with `#`
/// are ignored. The name of the file may be followed by the unit of columns without one, or the size of a pixel: `Results.csv [um]`, `spots.csv [0.325 um]`.
///
/// # Errors
/// A file that cannot be read, unknown or missing columns, and values that are not numbers, with the line.
pub(crate) fn read_pillars(
    path: &Path,
    given: &Given,
    common: &Pillar,
) -> Result<Table<4>, TableError> {
    let text = path.to_string_lossy();
    let split = text
        .strip_suffix(']')
        .and_then(|text| text.rsplit_once('['));
    match split {
        Some((file, unit)) if !path.exists() => {
            if given.unit.is_some() {
                return Err(TableError::TwoUnits {
                    path: file.trim_end().to_owned(),
                    unit: unit.to_owned(),
                });
            }
            let mut given = given.clone();
            given.unit = Some(Unit::parse(unit).ok_or_else(|| TableError::Unit {
                path: file.trim_end().to_owned(),
                unit: unit.to_owned(),
            })?);
            COLUMNS.read(Path::new(file.trim_end()), &given, otherwise(common))
        }
        _ => COLUMNS.read(path, given, otherwise(common)),
    }
}

/// [`read_pillars`] from the contents of a file; `name` is its name in errors.
pub(crate) fn pillars_in(
    name: &str,
    contents: &[u8],
    given: &Given,
    common: &Pillar,
) -> Result<Table<4>, TableError> {
    COLUMNS.parse(name, contents, given, otherwise(common))
}

/// What the headings of a table of pillars name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PillarColumns {
    /// Whether there are heights.
    pub height: bool,
    /// Whether there are diameters, radii or areas.
    pub diameter: bool,
}

/// The columns of a table of pillars with these contents; `None` if the headings do not name x and y, so that it is no table of pillars. Its rows
/// are not checked.
#[must_use]
pub fn pillar_columns(contents: &[u8]) -> Option<PillarColumns> {
    let [x, y, height, diameter] = COLUMNS.named(contents);
    (x && y).then_some(PillarColumns { height, diameter })
}

fn otherwise(common: &Pillar) -> [f64; 4] {
    [f64::NAN, f64::NAN, common.height, common.diameter]
}

/// The common pillar of a list: its height defaults to that of the highest pillar, its diameter to the mean.
pub(crate) fn common_pillar(given: Pillar, list: &PillarList) -> Pillar {
    let pillars = list.pillars();
    let highest = || {
        pillars
            .iter()
            .map(|pillar| pillar.height)
            .fold(0.0, f64::max)
    };
    let mean = || {
        // Relative to the first one, so that the mean of equal diameters is exact.
        let first = pillars[0].diameter;
        let excess = pillars.iter().map(|pillar| pillar.diameter - first);
        first + excess.sum::<f64>() / pillars.len() as f64
    };
    let or = |value: f64, otherwise: &dyn Fn() -> f64| match value.is_nan() {
        true => otherwise(),
        false => value,
    };
    Pillar {
        height: or(given.height, &highest),
        diameter: or(given.diameter, &mean),
        ..given
    }
}

/// The pillars of a table.
///
/// # Errors
/// Invalid pillars, with the line.
pub(crate) fn listed(table: &Table<4>) -> Result<PillarList, TableError> {
    let pillar = |[x, y, height, diameter]: &[f64; 4]| ListedPillar {
        centre: [*x, *y],
        height: *height,
        diameter: *diameter,
    };
    let pillars = table.rows.iter().map(pillar).collect();
    PillarList::new(pillars).map_err(|invalid| match invalid {
        InvalidPillars::NoPlace {
            pillar,
            axis,
            value,
        } => table.wrong(Some(pillar), no_place(axis, value)),
        InvalidPillars::NoSize {
            pillar,
            what,
            value,
        } => table.wrong(Some(pillar), no_size(what, value)),
        InvalidPillars::Overlap {
            pillars,
            distance,
            radii,
        } => overlap(table, pillars, distance, radii),
        other => table.wrong(None, other.to_string()),
    })
}

fn no_place(axis: impl Display, value: f64) -> String {
    format!("{axis}_m is {value}, and has to be a finite number")
}

fn no_size(what: impl Display, value: f64) -> String {
    if value.is_nan() {
        return format!("{what}_m is not given here, nor for all pillars");
    }
    format!("{what}_m is {value}, and has to be a finite number greater than 0")
}

/// The error for pillars that overlap.
pub(crate) fn overlap(
    table: &Table<4>,
    [one, other]: [usize; 2],
    distance: f64,
    radii: f64,
) -> TableError {
    let problem = format!(
        "this pillar overlaps with that of line {}: their centres are {distance:.4e} m apart, and their \
         radii add up to {radii:.4e} m",
        table.line(Some(one))
    );
    table.wrong(Some(other), problem)
}

/// Refuses pillars that rounded tops do not support: some may have no diameter.
pub(crate) fn check_rounded(table: &Table<4>) -> Result<(), TableError> {
    if table.rows.is_empty() {
        return Err(table.wrong(None, InvalidPillars::Empty.to_string()));
    }
    for (row, [x, y, height, diameter]) in table.rows.iter().enumerate() {
        for (axis, value) in [("x", *x), ("y", *y)] {
            if !value.is_finite() {
                return Err(table.wrong(Some(row), no_place(axis, value)));
            }
        }
        for (what, value) in [("height", *height), ("diameter", *diameter)] {
            let not_given = what == "diameter" && value.is_nan();
            if !(not_given || value > 0.0 && value.is_finite()) {
                return Err(table.wrong(Some(row), no_size(what, value)));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::PillarCompliance;

    fn read(text: &str) -> Result<PillarList, String> {
        let common = Pillar {
            diameter: 6e-6,
            height: 2.2e-6,
            compliance: PillarCompliance::Column,
        };
        let table = COLUMNS.parse(
            "pillars.csv",
            text.as_bytes(),
            &Given::default(),
            otherwise(&common),
        );
        table
            .and_then(|table| listed(&table))
            .map_err(|error| error.to_string())
    }

    /// Asserts that the pillars of a text have the expected places along x and diameters.
    fn assert_alike(found: &PillarList, expected: &PillarList, text: &str) {
        for (one, other) in found.pillars().iter().zip(expected.pillars()) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
            assert!(near(one.centre[0], other.centre[0]), "{text}");
            assert!(near(one.diameter, other.diameter), "{text}");
        }
    }

    #[test]
    fn columns_may_come_in_any_order_and_some_be_left_out() {
        let list =
            read("# of a design\ny_m, x_m, height_m\n0, 1e-5, 2e-6\n0, 3e-5, 2.1e-6\n").unwrap();
        let [one, other] = list.pillars() else {
            panic!("two pillars")
        };
        let [x, y] = one.centre;
        let values = [x, y, one.height, one.diameter, other.height].map(f64::to_bits);
        assert_eq!(values, [1e-5, 0.0, 2e-6, 6e-6, 2.1e-6].map(f64::to_bits));
    }

    #[test]
    fn headings_tell_a_table_of_pillars_from_other_tables() {
        let columns = |height, diameter| Some(PillarColumns { height, diameter });
        for (text, expected) in [
            ("x_m,y_m\n0,0\n", columns(false, false)),
            (
                "# of a design\ny_m, x_m, height_m\n0, 1e-5, 2e-6\n",
                columns(true, false),
            ),
            (
                " ,Label,X [um],Y [um],Area [um^2]\n1,a,10,0,28\n",
                columns(false, true),
            ),
            (
                "Pillar,x,y,d,h\n,mm,mm,um,um\n1,0.01,0,4,2\n",
                columns(true, true),
            ),
            ("displacement_um,force_uN\n0,0\n", None),
            ("x_um,force_uN\n0,0\n", None),
            ("0 1 2\n1 2 3\n", None),
            ("", None),
        ] {
            assert_eq!(pillar_columns(text.as_bytes()), expected, "{text}");
        }
    }

    #[test]
    fn separators_of_thousands_that_nothing_shows_are_refused() {
        let text = "x_nm,y_nm\n\"10,000\",\"0\"\n\"30,000\",\"0\"\n";
        let error = read(text).unwrap_err().to_string();
        assert!(
            error.contains("10.000 or 10000") && error.contains("line 2"),
            "{error}"
        );
    }

    #[test]
    fn tables_of_other_programs() {
        let expected = read("x_m,y_m,diameter_m\n1e-5,0,4e-6\n3e-5,0,6e-6\n").unwrap();
        for text in [
            "id;x [um];y [um];diameter [um]\n1;10,0;0;4,0\n2;30,0;0;\n",
            "# x_um y_um diameter_um\n10 0 4\n30 0 6\n",
            "x_nm;y_nm;diameter_nm\n10.000;0,0;4.000\n30.000;0,0;6.000\n",
            "X (\u{b5}m)\tY (\u{b5}m)\tRadius (nm)\n10\t0\t2000\n30\t0\t3000\n",
            "Pillar,x,y,d\n,mm,mm,um\n1,0.01,0,4\n2,0.03,0,6\n",
            "x in \u{b5}m;y in \u{b5}m;Diameter (microns)\n10;0;4\n30;0;6\n",
            "Stage X (mm),Stage Y (mm),Diameter (micrometer)\n0.01,0,4\n0.03,0,6\n",
            " ,Label,X [um],Y [um],Diameter [um],Area [um^2],Mean,Circ.\n1,a,10,0,4,1,9,1\n2,b,30,0,6,1,9,1\n",
        ] {
            let found = read(text).unwrap();
            assert_alike(&found, &expected, text);
        }
        // In UTF-16, as spreadsheets save "Unicode text".
        let wide = "\u{feff}X (\u{b5}m)\tY (\u{b5}m)\n10\t0\n".encode_utf16();
        let table = COLUMNS.parse(
            "wide.txt",
            &wide.flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
            &Given::default(),
            [0.0, 0.0, 2e-6, 4e-6],
        );
        assert!((table.unwrap().rows[0][0] - 1e-5).abs() < 1e-18);
        // Areas of circles, in the unit after the name of the file.
        let text = " ,Area,Mean,X,Y,BX,BY,Width,Height\n1,28.274333882308138,1,10,0,7,0,6,6\n";
        let without = read(text).unwrap_err();
        assert!(without.contains("column \"Area\" has no unit"), "{without}");
        assert!(without.contains("\"FILE [um]\""), "{without}");
        let folder = tempfile::tempdir().unwrap();
        let common = Pillar {
            diameter: f64::NAN,
            height: 2e-6,
            compliance: PillarCompliance::Column,
        };
        let of_mass = text
            .replace("BX,BY", "Min,Max")
            .replace("Mean", "%Area")
            .replace("X,Y,", "XM,YM,")
            .replace("Width,Height", "Major,Minor");
        for text in [text, &of_mass] {
            std::fs::write(folder.path().join("Results.csv"), text).unwrap();
            let table = read_pillars(
                &folder.path().join("Results.csv [um]"),
                &Given::default(),
                &common,
            )
            .unwrap();
            let [x, y, height, diameter] = table.rows[0];
            assert!((x - 1e-5).abs() < 1e-18 && y.abs() < 1e-18 && (height - 2e-6).abs() < 1e-18);
            assert!((diameter - 6e-6).abs() < 1e-15, "{diameter}");
        }
    }

    /// Tables as TrackMate, scikit-image, trackpy, CellProfiler and QuPath write them.
    #[test]
    fn columns_may_be_named() {
        let common = Pillar {
            diameter: 5e-6,
            height: 2e-6,
            compliance: PillarCompliance::Column,
        };
        let read = |text: &str, columns: &str, unit: Option<&str>| {
            let given = Given {
                columns: chosen_columns(columns)?,
                unit: unit.and_then(Unit::parse),
            };
            let table = COLUMNS.parse("spots.csv", text.as_bytes(), &given, otherwise(&common));
            table
                .map(|table| table.rows)
                .map_err(|error| error.to_string())
        };
        let trackmate = "LABEL,ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,FRAME,RADIUS,VISIBILITY\n\
                         Label,Spot ID,Quality,X,Y,Z,Frame,Radius,Visibility\n\
                         Label,Spot ID,Quality,X,Y,Z,Frame,R,Visibility\n\
                         ,,(quality),(micron),(micron),(micron),,(micron),\n\
                         ID4,4,9.5,10.0,0.0,0.0,0,3.0,1\nID5,5,8.1,30.0,0.0,0.0,0,3.0,1\n";
        let wide = "label,area,centroid-0,centroid-1,equivalent_diameter_area\n1,28,0.0,20.0,12.0\n2,28,0.0,60.0,12.0\n";
        let spots = ",y,x,mass,size,ecc,signal,raw_mass,ep,frame\n0,0.0,20.0,9e3,3.1,0.1,50.0,1e4,0.05,0\n1,0.0,60.0,9e3,3.1,0.1,50.0,1e4,0.05,0\n";
        let tabs = "Image\tName\tCentroid X \u{b5}m\tCentroid Y \u{b5}m\tNucleus: Area\na.tif\t\t10.0\t0.0\t28\na.tif\t\t30.0\t0.0\t28\n";
        let plain = "# made by hand\n7 10 0 6\n8 30 0 6\n";
        let half = Some("0.5 um");
        let cases = [
            (
                trackmate,
                "x = POSITION_X, y = POSITION_Y, radius = RADIUS",
                None,
                6e-6,
            ),
            (trackmate, "x=4; y=5; radius=8", None, 6e-6),
            (
                wide,
                "x = centroid-1, y = centroid-0, diameter = equivalent_diameter_area",
                half,
                6e-6,
            ),
            (spots, "x = x, y = y", half, 5e-6),
            (
                tabs,
                "x = Centroid X \u{b5}m, y = \"Centroid Y \u{b5}m\"",
                None,
                5e-6,
            ),
            (plain, "x = 2, y = 3, d = 4", Some("um"), 6e-6),
        ];
        for (text, columns, unit, diameter) in cases {
            let rows = read(text, columns, unit).unwrap();
            let expected = [[1e-5, 0.0, 2e-6, diameter], [3e-5, 0.0, 2e-6, diameter]];
            assert_eq!(rows.len(), 2, "{columns}");
            for (found, expected) in rows.iter().flatten().zip(expected.iter().flatten()) {
                assert!(
                    (found - expected).abs() <= 1e-12 * expected,
                    "{columns}: {rows:?}"
                );
            }
        }
        // Without names, columns that are not known are named; positions in pixels need their size.
        let unnamed = |text: &str| tests::read(text).unwrap_err();
        assert!(unnamed(trackmate).contains("column \"QUALITY\" is not known"));
        assert!(unnamed(trackmate).contains("pillar_columns"));
        let error = |columns: &str| read(trackmate, columns, None).unwrap_err();
        assert!(
            error("x = POSITION_X, y = POS_Y")
                .contains("there is no column \"POS_Y\"; there are LABEL, ID")
        );
        for (columns, problem) in [
            ("x = POSITION_X", "the column of y is missing"),
            ("x = 4, y = 5, x = 6", "\"x\" is given twice"),
            (
                "x = 4, y = 5, radius = 8, diameter = 8",
                "\"diameter\" is given twice",
            ),
            ("x = 4, y = 5, z = 6", "there is no quantity \"z\""),
            ("x, y = 5", "\"x\" names no column"),
            ("x = 4, y = 4", "x and y are the same column"),
            ("x = 40, y = 5", "there is no column \"40\""),
            ("x = 0, y = 1", "columns are numbered from 1"),
        ] {
            assert!(
                error(columns).contains(problem),
                "{columns}: {}",
                error(columns)
            );
        }
        // Names are compared without case and with any micro sign; commas in them need quotes; equal names need numbers.
        let greek = "x = centroid x \u{3bc}m, y = Centroid Y \u{b5}m";
        assert!(read(tabs, greek, None).is_ok());
        let commas = "\"X, um\",\"Y, um\"\n10,0\n";
        assert!(read(commas, "x = \"X, um\", y = \"Y, um\"", None).is_ok());
        let two = "Cells,Cells,Nuclei,Nuclei\nX,Y,X,Y\n1,2,3,4\n";
        let twice = read(two, "x = X, y = Y", half).unwrap_err();
        assert!(
            twice.contains("several columns \"X\"") && twice.contains("1 or 3"),
            "{twice}"
        );
        // By number the units are those of the row of units, or of the headings.
        for text in [
            "x,y\nnm,nm\n10000,0\n",
            "x [nm],y [nm]\n\n10000,0\n",
            "x / nm,y / nm\n# here\n10000,0\n",
        ] {
            let rows = read(text, "x = 1, y = 2", None).unwrap();
            assert!((rows[0][0] - 1e-5).abs() < 1e-17, "{text}: {rows:?}");
        }
        let unused = read("x [nm],y [nm]\n1,2\n", "x = 1, y = 2", half).unwrap_err();
        assert!(unused.contains("all columns have units"), "{unused}");
        let pixels = read("x,y\n(pixel),(pixel)\n1,2\n", "x = x, y = y", None).unwrap_err();
        assert!(pixels.contains("column \"x\" is in pixels"), "{pixels}");
    }

    /// Faults of tables that nothing shows must not be read.
    #[test]
    fn tables_that_may_mean_something_else_are_refused() {
        let refused = |text: &str, problem: &str| {
            let error = read(text).unwrap_err();
            assert!(error.contains(problem), "{text}: {error}");
        };
        // Several images, statistics below the particles, and boxes in images.
        refused(
            " ,Label,X [um],Y [um],Slice\n1,a,10,0,1\n2,a,30,0,2\n",
            "2 images",
        );
        for label in [
            "StdDev",
            "Std. Dev.",
            "Average (n=7)",
            "Mean value",
            "95% CI",
            "Q1",
            "Durchschnitt",
        ] {
            let text =
                format!(" ,Label,X [um],Y [um]\n1,a.tif,10,0\n2,b.tif,30,0\n3,{label},20,0\n");
            refused(&text, &format!("line 4: \"{label}\" labels a statistic"));
        }
        refused("X,Y,Area,Width,Height\n1,2,3,4,5\n", "boxes around them");
        // A column whose every row is named so, and names of images, are no statistics.
        for text in [
            "Label,X [um],Y [um],Type\n1,10,0,Mean\n2,30,0,Mean\n",
            "Label,X [um],Y [um]\nAVG_stack.tif,10,0\nstack.tif,30,0\n",
        ] {
            assert!(read(text).is_ok(), "{text}");
        }
        let area = "x_um,y_um,area_um2\n10,0,-28\n";
        refused(
            area,
            "height_m is \"-28\""
                .replace("height_m", "diameter_m")
                .as_str(),
        );
    }

    /// Tables of R, of ImageJ and of Excel with titles, labels and empty cells.
    #[test]
    fn usual_forms_of_tables() {
        let expected = read("x_m,y_m,diameter_m\n1e-5,0,4e-6\n3e-5,0,6e-6\n").unwrap();
        for text in [
            "\"x_um\" \"y_um\" \"d_um\"\n\"1\" 10 0 4\n\"2\" 30 0 6\n",
            "No,X [um],Y [um],D [um]\n#1,10,0,4\n#2,30,0,6\n",
            "sep=;\nX [um];Y [um];D [um]\n10;0;4\n30;0;NaN\n;;\n",
            "Position X Y of pillars\nof sample 7\n\nX [um],Y [um],D [um]\n10,0,4\n30,0,n/a\n\u{1a}",
            "% X [um], Y [um], Durchmesser [um]\n10, 0, 4\n30, 0, 6\n",
            "X (um)\tY (um)\tArea (sq um)\tRadius (um)\n10\t0\t12\t2\n30\t0\t28\t3\n",
            "x_nm,y_nm,d_nm\n10000.000,0.000,4000.000\n30000.000,0.000,6000.000\n",
        ] {
            let found = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(found.pillars().len(), 2, "{text}");
            assert_alike(&found, &expected, text);
        }
        // ImageJ writes three decimals; commas separate the cells.
        let rows = read("x_um,y_um\n300,50\n600,50\n900,50\n1.125,150\n").unwrap();
        assert!((rows.pillars()[3].centre[0] - 1.125e-6).abs() < 1e-18);
        let rows = read("x_um,y_um\n300.125,110.250\n600,111.375\n1.250,310.125\n").unwrap();
        assert!((rows.pillars()[0].centre[0] - 300.125e-6).abs() < 1e-15);
    }

    #[test]
    fn errors_state_their_line() {
        let wrong = |text: &str| read(text).unwrap_err();
        assert!(
            wrong("").contains("line 1: the column x_m is missing"),
            "{}",
            wrong("")
        );
        assert!(wrong("x_m,y_m\n").contains("there are no pillars"));
        assert!(wrong("x_m,y_m,colour\n0,0,1").contains("line 1: column \"colour\" is not known"));
        assert!(wrong("x_m,y_m\n0,zero").contains("line 2: y_m is \"zero\""));
        assert!(wrong("x_m,y_m\n0,0\n1e-3").contains("line 3"));
        assert!(wrong("x_m,y_m\n0,inf").contains("line 2: y_m is inf"));
        assert!(wrong("x_m,y_m,height_m\n0,0,-1").contains("line 2: height_m is -1"));
        assert!(wrong("x_um,y\n0,0").contains("column \"y\" has no unit"));
        let pixels = wrong("x_px,y [px]\n0,0");
        assert!(
            pixels.contains("column \"x_px\" is in pixels") && pixels.contains("[0.325 um]"),
            "{pixels}"
        );
        let both = "x_um,y_um,radius_um,diameter_um\n10,0,3.0,6.05\n30,0,";
        assert!(read(&format!("{both}2.5,5\n")).is_ok());
        let error = wrong(&format!("{both}5,5\n"));
        assert!(
            error.contains("line 3: radius and diameter contradict"),
            "{error}"
        );
        assert!(wrong("x [um],y [px]\n0,0").contains("column \"y [px]\" is in pixels"));
        assert!(wrong("x [um],y [V]\n0,0").contains("\"y [V]\" is in the unknown unit \"V\""));
        let statistic = wrong(" ,Label,X [m],Y [m]\n1,a.tif,0,0\n2,a.tif,1,0\n3,Mean,0.5,0\n");
        assert!(
            statistic.contains("line 4: \"Mean\" labels a statistic"),
            "{statistic}"
        );
        let overlap = wrong("x_m,y_m\n0,0\n1,0\n# here\n4e-6,0\n");
        assert!(
            overlap.contains("line 5: this pillar overlaps with that of line 2"),
            "{overlap}"
        );
        assert!(overlap.contains("4.0000e-6 m apart"), "{overlap}");
    }
}
