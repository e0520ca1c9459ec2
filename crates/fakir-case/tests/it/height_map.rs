//! Height maps from files: files written by NumPy, files generated here from the definition of the
//! format (numpy.lib.format), and invalid files.

use fakir::problem::HeightMap;
use fakir_case::height_map::{
    GivenScale, HeightMapError, MapScale, MapSize, is_height_map, read_height_map, read_scaled_map,
};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Sufficient memory for all of these files, bytes.
const MEMORY: usize = 100_000_000;

const SCALE: MapScale = MapScale {
    size: MapSize::Pixel([2.0e-6, 1.0e-6]),
    height_unit: 1.0e-9,
};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/height_maps")
        .join(name)
}

/// Content of the fixtures: three rows of four columns, `10 row + column` nm.
fn check(map: &HeightMap) {
    let grid = map.grid();
    assert_eq!((grid.columns(), grid.rows()), (4, 3));
    assert!((grid.cell()[0] - 2.0e-6).abs() < 1e-20 && (grid.cell()[1] - 1.0e-6).abs() < 1e-20);
    // Centred on the lens axis.
    let [x, y] = grid.centre(0, 0);
    assert!((x + 3.0e-6).abs() < 1e-18 && (y + 1.0e-6).abs() < 1e-18);
    for (cell, height) in map.heights().iter().enumerate() {
        let expected = (10 * (cell / 4) + cell % 4) as f64 * 1.0e-9;
        assert!((height - expected).abs() < 1e-20, "{cell}: {height}");
    }
}

fn read(path: &Path) -> Result<HeightMap, HeightMapError> {
    read_height_map(path, None, &SCALE, MEMORY)
}

fn expect(path: &Path) {
    match read(path) {
        Ok(map) => check(&map),
        Err(error) => panic!("{error}"),
    }
}

/// Reads a file with the given content and name, and returns the error.
fn failure(name: &str, content: &[u8]) -> HeightMapError {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("a file for the test");
    let error = read(&path).expect_err("the file is wrong");
    assert!(error.to_string().contains(name), "{error}");
    error
}

/// A `.npy` file: magic string, version, length of the header, header, data.
fn npy(version: u8, kind: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}");
    let prefix = if version == 1 { 10 } else { 12 };
    while !(prefix + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    let length = header.len() as u32;
    let width = if version == 1 { 2 } else { 4 };
    bytes.extend(&length.to_le_bytes()[..width]);
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// Values of the fixtures, in storage order.
fn values(fortran: bool) -> Vec<i32> {
    (0..12)
        .map(|place| {
            let (row, column) = if fortran {
                (place % 3, place / 3)
            } else {
                (place / 4, place % 4)
            };
            10 * row + column
        })
        .collect()
}

#[test]
fn files_that_numpy_wrote() {
    expect(&fixture("fortran.npy"));
    expect(&fixture("single.npz"));
    expect(&fixture("savetxt.txt"));
    let named = read_height_map(&fixture("several.npz"), Some("heights"), &SCALE, MEMORY);
    check(&named.expect("the archive has heights"));
}

#[test]
fn every_version_type_and_order() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("map.npy");
    for version in [1, 2, 3] {
        for fortran in [false, true] {
            let values = values(fortran);
            let kinds: [(&str, Vec<u8>); 8] = [
                (
                    "<f8",
                    values
                        .iter()
                        .flat_map(|v| f64::from(*v).to_le_bytes())
                        .collect(),
                ),
                (
                    ">f8",
                    values
                        .iter()
                        .flat_map(|v| f64::from(*v).to_be_bytes())
                        .collect(),
                ),
                (
                    "<f4",
                    values
                        .iter()
                        .flat_map(|v| (*v as f32).to_le_bytes())
                        .collect(),
                ),
                ("|u1", values.iter().map(|v| *v as u8).collect()),
                ("|i1", values.iter().map(|v| *v as u8).collect()),
                (
                    ">u2",
                    values
                        .iter()
                        .flat_map(|v| (*v as u16).to_be_bytes())
                        .collect(),
                ),
                ("<i4", values.iter().flat_map(|v| v.to_le_bytes()).collect()),
                (
                    "<i8",
                    values
                        .iter()
                        .flat_map(|v| i64::from(*v).to_le_bytes())
                        .collect(),
                ),
            ];
            for (kind, data) in kinds {
                let bytes = npy(version, kind, fortran, "(3, 4)", &data);
                std::fs::write(&path, bytes).expect("a file for the test");
                expect(&path);
            }
        }
    }
}

#[test]
fn rows_of_numbers() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("map.asc");
    for text in [
        "0 1 2 3\n10 11 12 13\n20 21 22 23\n",
        "# heights\r\n0, 1, 2, 3\r\n\r\n10,11,12,13 # second\r\n20;21;22;2.3e1",
        // The first row of an ESRI ASCII grid has the largest y.
        "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n\
         20 21 22 23\n10 11 12 13\n0 1 2 3\n",
    ] {
        std::fs::write(&path, text).expect("a file for the test");
        expect(&path);
    }
}

/// The rows of the fixtures, as several programs write them.
#[test]
fn rows_of_other_programs() {
    let given = SCALE.into();
    let rows = "0\t1\t2\t3\n10\t11\t12\t13\n20\t21\t22\t2.3D+01\n";
    let wide = format!("\u{feff}{rows}");
    let wide = wide.encode_utf16().flat_map(u16::to_le_bytes);
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(rows.as_bytes()).unwrap();
    for text in [
        wide.collect(),
        packer.finish().unwrap(),
        format!("Height(nm)\n{rows}").into_bytes(),
        rows.replace('\n', "\r").into_bytes(),
        format!("% heights\n// of a map\n{rows}").into_bytes(),
        b";0;1;2;3\n;10;11;12;13\n;20;21;22;23\n".to_vec(),
        b"0,1,2,3,\n10,11,12,13,\n20,21,22,23,\n".to_vec(),
        b"\"0\",\"1\",\"2\",\"3\"\n\"10\",11,12,13\n20,21,22,\"23.0\"\n".to_vec(),
    ] {
        match read_text(text, &given) {
            Ok(map) => check(&map),
            Err(error) => panic!("{error}"),
        }
    }
    let error = read_text("\"1,234\",\"2,345\"\n", &given)
        .unwrap_err()
        .to_string();
    assert!(error.contains("1.234 or 1234"), "{error}");
    let thousands = read_text("1 234,5\t2 345,6\n", &given).unwrap();
    assert!((thousands.heights()[0] - 1234.5e-9).abs() < 1e-18);
    let minus = read_text("\u{2212}1.5 2.5\n", &given).unwrap();
    assert!((minus.heights()[0] + 1.5e-9).abs() < 1e-20);
}

/// Texts of points that were not measured, also where a number would be if `#` began a comment, and empty cells.
#[test]
fn texts_of_missing_points() {
    let given = SCALE.into();
    for (text, place) in [
        ("0 1 2 -1.#IND\n10 11 12 13\n", "column 3, row 0"),
        ("0,1,2,3\n10,11,12,1.#QNAN\n", "column 3, row 1"),
        ("0;1;2;3\n10;;12;13\n", "column 1, row 1"),
        (",1,2,3\n10,11,12,13\n", "column 0, row 0"),
        ("0\t1\t\t3\n10\t11\t12\t13\n", "column 2, row 0"),
        ("1,2,3,\n4,5,6,7\n", "column 3, row 0"),
        ("0 1 N/A 3 # note\n10 11 12 13\n", "column 2, row 0"),
        ("0,5 *** 2,5\n", "column 1, row 0"),
    ] {
        let error = read_text(text, &given).expect_err(text).to_string();
        assert!(
            error.contains("1 of ") && error.contains(place),
            "{text}: {error}"
        );
    }
    let points = "0 0 1\n1 0 2\n2 0 3\n0 1 1\n1 1 -1.#IND\n2 1 3\n";
    let empty = points.replace("-1.#IND", "").replace(' ', ",");
    for text in [points, &empty, &points.replace("-1.#IND", "No Data")] {
        let error = read_text(text, &given).expect_err(text).to_string();
        assert!(
            error.contains("1 of 6 heights are missing"),
            "{text}: {error}"
        );
    }
}

/// Coordinates, numbers of rows, profiles, and lists of points with further columns.
#[test]
fn numbers_that_are_no_matrix_of_heights() {
    let given = SCALE.into();
    let height = |row: i32, column: i32| f64::from((7 * row + 3 * column * column) % 10);
    let matrix = |corner: &str, axes: [bool; 2]| -> String {
        let row = |row: i32| {
            let cells = (-i32::from(axes[0])..9).map(|column| match (row, column) {
                (-1, -1) => corner.to_owned(),
                (-1, k) | (k, -1) => format!("{}", 0.5 * f64::from(k)),
                _ => height(row, column).to_string(),
            });
            cells.collect::<Vec<String>>().join(",")
        };
        let rows = (-i32::from(axes[1])..9).map(row);
        rows.collect::<Vec<String>>().join("\n")
    };
    let numbered: String = (1..9)
        .map(|row| format!("{row} {} {}\n", height(row, 1), height(row, 2)))
        .collect();
    let profile: String = (0..9)
        .map(|k| format!("{} {}\n", 0.5 * f64::from(k), height(k, 0)))
        .collect();
    let four: String = (0..12)
        .map(|k| format!("{} {} {} 255\n", k % 4, k / 4, 10 * (k / 4) + k % 4))
        .collect();
    for (text, problem) in [
        (
            matrix("0", [true, true]),
            "its first row and its first column are coordinates",
        ),
        (
            matrix("", [true, true]),
            "its first row and its first column are coordinates",
        ),
        (numbered, "numbers of rows"),
        (profile, "it is a profile of a line, not a map"),
        (four.clone(), "with 4 columns: name them"),
    ] {
        let error = read_text(&text, &given).expect_err(&text).to_string();
        assert!(error.contains(problem), "{text}: {error}");
    }
    let sentence = format!("# scan along x and y with z\n{}", matrix("", [false; 2]));
    assert!(read_text(sentence, &given).is_ok());
    let error = read_text(format!("x y z\n{four}"), &given)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("its headings name 3 columns, and its rows have 4"),
        "{error}"
    );
    check(&read_text(format!("x y z intensity\n{four}"), &given).unwrap());
    let list: Vec<u8> = (0..12)
        .flat_map(|k| [k % 4, k / 4, 10 * (k / 4) + k % 4])
        .flat_map(|value| f64::from(value).to_le_bytes())
        .collect();
    let error = failure("list.npy", &npy(1, "<f8", false, "(12, 3)", &list)).to_string();
    assert!(error.contains("a list of 12 points x, y, z"), "{error}");
}

/// Reads a text with the given part of its scale.
fn read_text(text: impl AsRef<[u8]>, scale: &GivenScale) -> Result<HeightMap, HeightMapError> {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("map.txt");
    std::fs::write(&path, text).expect("a file for the test");
    read_scaled_map(&path, None, scale, MEMORY)
}

/// Commas are decimal commas if blanks or semicolons separate the numbers; otherwise they are separators.
#[test]
fn decimal_commas() {
    let given = SCALE.into();
    for text in [
        "0,0 1,0 2,0 3,0\n10,0 11,0 12,0 13,0\n20,0 21,0 22,0 2,3e1\n",
        "0;1,0;2;3,00\n10;11;12;13\n20,0;21;22;23\n",
        "0,0\t1,0\t2,0\t3,0\r\n10\t11\t12\t13\r\n20\t21\t22\t23\r\n",
        "\u{feff}0,1,2,3\n10,11,12,13\n20.0,21,22,23,\n",
    ] {
        check(&read_text(text, &given).expect(text));
    }
    for (text, line) in [
        ("0,1, 0,2\n", 1),
        ("1,2,3;4,5,6\n", 1),
        ("1,234.5 2,5\n", 1),
        ("0 1\n0,5 1,5\n1,2\n", 3),
        ("1,2\n1,5;2,5\n", 2),
        ("1,5\t2,5\n1.885\t2.001\n", 2),
    ] {
        let error = read_text(text, &given).expect_err(text);
        assert!(
            matches!(error, HeightMapError::AmbiguousComma { line: at, .. } if at == line),
            "{text}: {error}"
        );
    }
}

/// A mark before three digits separates thousands beside whole numbers of hundreds, and beside the other decimal mark; otherwise it is a decimal mark.
#[test]
fn separators_of_thousands_are_refused() {
    let given = SCALE.into();
    for (text, number) in [
        ("856\t1,885\t911\t870\n", "1,885"),
        ("856\t1.885\t911\t870\n", "1.885"),
    ] {
        let error = read_text(text, &given).expect_err(text).to_string();
        assert!(error.contains(number), "{text}: {error}");
        assert!(error.contains("thousands"), "{text}: {error}");
    }
    let read = |text: &str| read_text(text, &given).expect(text);
    let plain = read("1.885 2.001\n3.125 4.250\n");
    assert_eq!(
        plain.heights(),
        read("1,885;2,001\n3,125;4,250\n").heights()
    );
    // Places are whole numbers, and heights have three digits.
    let rows = (0..400).map(|k| format!("{} {} {}\n", k % 20, k / 20, 1.125 + f64::from(k)));
    read(&rows.collect::<String>());
}

/// What pandas writes over a table of numbers without names.
#[test]
fn numbers_of_columns_are_no_heights() {
    let given = SCALE.into();
    let heights = "5,5,5,5,5,5,5,5,5\n".repeat(3);
    let error = read_text(format!("0,1,2,3,4,5,6,7,8\n{heights}"), &given).unwrap_err();
    assert!(
        matches!(error, HeightMapError::NumberedColumns { .. }),
        "{error}"
    );
    // A ramp.
    assert!(read_text("0,1,2,3,4,5,6,7,8\n".repeat(3), &given).is_ok());
}

/// All points of a grid in any order, with a spacing of 2 um along x and 1 um along y, as in the
/// scale.
#[test]
fn lists_of_points() {
    let given = SCALE.into();
    let points = |unit: f64| -> Vec<String> {
        let cells = (0..12).map(|place| (7 * place) % 12);
        let point = |cell: i32| {
            let [x, y] = [2 * (cell % 4), cell / 4].map(|place| f64::from(place) * unit + unit);
            format!("{x:.7e} {y:.7e} {}", 10 * (cell / 4) + cell % 4)
        };
        cells.map(point).collect()
    };
    for unit in [1.0, 1e-3, 1e-6, 1e3] {
        check(&read_text(points(unit).join("\n"), &given).unwrap());
    }
    let headed = format!("X Y Z\n{}", points(1.0).join("\n"));
    check(&read_text(headed, &given).unwrap());
    // With units, which have to agree with what is given.
    let named = |unit: &str| {
        format!(
            "X ({unit}),Y ({unit}),Z (nm)\n{}",
            points(1.0).join("\n").replace(' ', ",")
        )
    };
    check(&read_text(named("um"), &given).unwrap());
    let error = read_text(named("mm"), &given).unwrap_err();
    assert!(
        matches!(error, HeightMapError::Contradiction { .. }),
        "{error}"
    );
    // Other names and another order.
    for heading in ["Y [\u{b5}m];X [\u{b5}m];Height [nm]", "y_um,x_um,height_nm"] {
        let swapped = points(1.0).into_iter().map(|point| {
            let cells: Vec<&str> = point.split(' ').collect();
            format!("{};{};{}", cells[1], cells[0], cells[2])
        });
        let rows = swapped.collect::<Vec<String>>().join("\n");
        check(&read_text(format!("{heading}\n{rows}"), &GivenScale::default()).unwrap());
    }
    // Zygo: heights in um, and points that are counted, at a distance in the header.
    let counted = |k: i32| {
        format!(
            "{} {} {}\n",
            k % 4,
            k / 4,
            1e-3 * f64::from(10 * (k / 4) + k % 4)
        )
    };
    let counted: String = (0..12).map(counted).collect();
    let zygo = |distance: &str| {
        let lines = "0 0 0 0\n".repeat(6);
        format!(
            "Zygo XYZ Data File - Format 1\n{lines}0 0.5 0 0 1 0 {distance} 0\n\"x\"\n#\n{counted}"
        )
    };
    let square = GivenScale {
        size: Some(MapSize::Pixel([2e-6; 2])),
        ..GivenScale::default()
    };
    for (scale, distance) in [
        (&square, "2e-06"),
        (&square, "0"),
        (&GivenScale::default(), "2e-06"),
    ] {
        let map = read_text(zygo(distance), scale).unwrap();
        assert!((map.grid().cell()[1] - 2e-6).abs() < 1e-18);
        assert!((map.highest() - 23e-9).abs() < 1e-18, "{}", map.highest());
    }
    // Columns and rows that are counted.
    let counted =
        (0..12).map(|cell| format!("{} {} {}\n", cell % 4, cell / 4, 10 * (cell / 4) + cell % 4));
    check(&read_text(counted.collect::<String>(), &given).unwrap());
    // The distance of the outermost points is accepted as the width, as is that of the cells.
    for width in [8.0e-6, 6.0e-6] {
        let scale = GivenScale {
            size: Some(MapSize::Width(width)),
            ..given
        };
        check(&read_text(points(1.0).join("\n"), &scale).unwrap());
    }
    let error = read_text(points(1.5).join("\n"), &given).unwrap_err();
    assert!(
        matches!(error, HeightMapError::Contradiction { .. }),
        "{error}"
    );
    let unknown = GivenScale::default();
    let error = read_text(points(1.0).join("\n"), &unknown).unwrap_err();
    assert!(matches!(error, HeightMapError::NoSize { .. }), "{error}");
    // One point is missing: three columns, which are a map only if they are short.
    let error = read_text(points(1.0)[1..].join("\n"), &given);
    assert_eq!(error.unwrap().grid().rows(), 11);
    let scattered = (0..200).map(|point| format!("{} {} 1\n", point, (point * point) % 97));
    let error = read_text(scattered.collect::<String>(), &given).unwrap_err();
    assert!(
        matches!(error, HeightMapError::NotAGrid { rows: 200, .. }),
        "{error}"
    );
}

/// The heading of Gwyddion before a matrix is used if nothing is given; otherwise it must agree.
#[test]
fn sizes_that_a_file_states() {
    let rows = "0\t1\t2\t3\n10\t11\t12\t13\n20\t21\t22\t23\n";
    let stated = |width: &str, unit: &str| {
        format!(
            "# Channel: Height\n# Width: {width}\n# Height: 3.0 \u{b5}m\n# Value units: {unit}\n{rows}"
        )
    };
    let nothing = GivenScale::default();
    let given = SCALE.into();
    for scale in [&nothing, &given] {
        for width in ["8.0 \u{b5}m", "8,0 um", "8000 nm"] {
            check(&read_text(stated(width, "nm"), scale).unwrap());
        }
        // A micro sign in Latin-1.
        let mut bytes = stated("8.0 @m", "nm").into_bytes();
        let sign = bytes.iter().position(|byte| *byte == b'@').unwrap();
        bytes[sign] = 0xb5;
        check(&read_text(bytes, scale).unwrap());
    }
    for (width, unit, what) in [
        ("10.0 um", "nm", "a width of 10 um, and 8 um is given"),
        ("8.0 um", "m", "a unit of heights of 1 m, and 1 nm is given"),
    ] {
        let error = read_text(stated(width, unit), &given).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
    let error = read_text(stated("8.0 um", "V"), &nothing).unwrap_err();
    assert!(
        matches!(error, HeightMapError::NotHeights { .. }),
        "{error}"
    );
    check(&read_text(stated("8.0 um", "V"), &given).unwrap());
    // Other languages, and SPIP.
    for heading in [
        "# Kanal: H\u{f6}he\n# Breite: 8,0 \u{b5}m\n# H\u{f6}he: 3,0 \u{b5}m\n# Value units: nm\n",
        "# Largeur : 8,0 um\n# Hauteur : 3,0 um\n# Unit\u{e9}s : nm\n",
        "# x-length = 8000\n# y-length = 3000\n# Bit2nm = 1\n",
    ] {
        for scale in [&nothing, &given] {
            check(&read_text(format!("{heading}{rows}"), scale).unwrap());
        }
        let other = GivenScale {
            size: Some(MapSize::Width(9e-6)),
            ..nothing
        };
        let error = read_text(format!("{heading}{rows}"), &other).unwrap_err();
        assert!(error.to_string().contains("a width of 8 um"), "{error}");
    }
    // An ESRI ASCII grid has cells of an unknown unit.
    let esri = |cell| format!("ncols 4\nnrows 3\ncellsize {cell}\n{rows}");
    let squares = |size: f64| GivenScale {
        size: Some(MapSize::Pixel([size; 2])),
        ..given
    };
    assert!(read_text(esri("0.5"), &squares(0.5e-6)).is_ok());
    let upside_down = "20 21 22 23\n10 11 12 13\n0 1 2 3\n";
    let oblong = format!("ncols 4\nnrows 3\ndx 2\ndy 1\n{upside_down}");
    for scale in [&squares(2e-6), &given] {
        check(&read_text(&oblong, scale).unwrap());
    }
    let error = read_text(&oblong, &squares(1e-6)).unwrap_err().to_string();
    assert!(error.contains("a distance of points of 2"), "{error}");
    let error = read_text(esri("0.5"), &squares(1e-6)).unwrap_err();
    assert!(
        matches!(error, HeightMapError::Contradiction { .. }),
        "{error}"
    );
}

/// Gwyddion writes several channels into one text, each below its header.
#[test]
fn several_maps_in_one_text_are_refused() {
    let given = SCALE.into();
    let rows = "0 1 2 3\n10 11 12 13\n20 21 22 23\n";
    let channel = |name: &str, unit: &str| {
        format!("# Channel: {name}\n# Width: 8 um\n# Height: 3 um\n# Value units: {unit}\n{rows}")
    };
    let refused = |text: &str, line: usize| {
        let error = read_text(text, &given).expect_err(text);
        assert!(
            matches!(error, HeightMapError::SeveralMaps { line: at, .. } if at == line),
            "{text}: {error}"
        );
        assert!(error.to_string().contains("save one map alone"), "{error}");
    };
    let both = format!("{}\n{}", channel("Height", "nm"), channel("Phase", "deg"));
    refused(&both, 9);
    refused(&both.replace("# ", "% "), 9);
    refused(&format!("{rows}\n{rows}"), 5);
    refused(&format!("{rows}# New slice\n{rows}# New slice\n{rows}"), 5);
    // Empty lines between all rows, and at both ends.
    let spaced = format!("\n{}\n", rows.replace('\n', "\n\n"));
    check(&read_text(spaced, &given).unwrap());
    // Lists of points of gnuplot have an empty line between their rows.
    let point = |k: i32| {
        let end = if k % 4 == 3 { "\n\n" } else { "\n" };
        format!("{} {} {}{end}", k % 4, k / 4, 10 * (k / 4) + k % 4)
    };
    check(&read_text((0..12).map(point).collect::<String>(), &given).unwrap());
}

/// The headers of programs of microscopes. Those of Attocube, SPIP and Nova are described in the modules `attocube.c`, `spip-asc.c` and `nova-asc.c`
/// of Gwyddion; those of Gwyddion in other languages and of Nova are tested in `SurfaceTopography` (`test_asc.py`); those of Keyence are read by
/// `Kcsv2Bcr`.
#[test]
fn headers_of_programs_of_microscopes() {
    let nothing = GivenScale::default();
    let given = SCALE.into();
    let rows = "0 1 2 3\n10 11 12 13\n20 21 22 23\n";
    let spip = "# File Format = ASCII\n# x-pixels = 4\n# y-pixels = 3\n# x-length = 8000\n# y-length = 3000\n# z-unit = [nm]\n\
                # description =\n# 3 scans\nOperator:\n# Start of Data:\n";
    let attocube = "# x-length: 8\n# y-length: 3\n# x-unit: um\n# y-unit: um\n# z-unit: nm\n";
    let nova = "File Format = ASCII\nCreated by Nova\nNX = 4\nNY = 3\nScale X = 2\nScale Y = 1\nUnit X = um\nUnit Data = nm\nScale Data = 1\n\
                DataScaleNeeded = no\nStart of Data :\n";
    for header in [
        spip,
        attocube,
        "# x-unit: mm\n# y-unit: um\n# x-length: 0.008\n# y-length: 3\n# z-unit: nm\n",
        nova,
        "% Width: 8 um\n% Height: 3 um\n% Value units: nm\n",
        "// Width: 8 um\n// Height: 3 um\n// Value units: nm\n",
        "# Kanal: Topo\n# Breite: 8 um\n# H\u{f6}he: 3 um\n# Einheiten: nm\n",
        "# Canal: Topo\n# Anchura: 8 um\n# Altura: 3 um\n# Unidades de valor: nm\n",
        "# Canale: Topo\n# Larghezza: 8 um\n# Altezza: 3 um\n# unit\u{e0} valore: nm\n",
        "# Kan\u{e1}l: Topo\n# \u{160}\u{ed}\u{159}ka: 8 um\n# V\u{fd}\u{161}ka: 3 um\n# Jednotky hodnot: nm\n",
    ] {
        let text = format!("{header}{rows}");
        for scale in [&nothing, &given] {
            match read_text(&text, scale) {
                Ok(map) => check(&map),
                Err(error) => panic!("{text}: {error}"),
            }
        }
        let larger = GivenScale {
            height_unit: Some(1e-6),
            ..nothing
        };
        let error = read_text(&text, &larger).expect_err(&text).to_string();
        assert!(error.contains("a unit of heights of 1 nm"), "{error}");
        let wider = GivenScale {
            size: Some(MapSize::Extent([9e-6, 3e-6])),
            ..nothing
        };
        let error = read_text(&text, &wider).expect_err(&text).to_string();
        assert!(error.contains("a width of 8 um"), "{error}");
    }
    let error = |header: String| {
        let error = read_text(format!("{header}{rows}"), &nothing);
        error.expect_err(&header).to_string()
    };
    let volts = error(spip.replace("z-unit = [nm]", "z-unit = V"));
    assert!(volts.contains("values in \"V\""), "{volts}");
    for header in [
        spip.replace("y-pixels = 3", "y-pixels = 5"),
        nova.replace("NY = 3", "NY = 5"),
    ] {
        let size = error(header);
        assert!(size.contains("its header states 4 and 5"), "{size}");
    }
    // SPIP writes a mask below the heights.
    let mask = error(format!("{spip}{rows}"));
    assert!(mask.contains("and remove the mask"), "{mask}");
    // All numbers in one line, and one in each.
    for between in [" ", "\n"] {
        let rows = rows.replace([' ', '\n'], between);
        check(&read_text(format!("{spip}{rows}"), &nothing).unwrap());
    }
    let scaled = error(nova.replace("= no", "= Yes"));
    assert!(scaled.contains("Gwyddion"), "{scaled}");
}

/// Tables of the microscopes VK and VR of Keyence. The name of one cell has a line break.
#[test]
fn tables_of_keyence() {
    let table = |unit: &str, data: &str| {
        format!(
            "\"Measured date\",\"2025-01-02 10:00:00\"\r\n\"Model\",\"VK-X3000 Series\"\r\n\"Data type\n\",\"ImageDataCsv\"\r\n\"File version\",\"1000\"\r\n\
             \"XY Calibration\",\"1389.000\",\"nm\"\r\n\"Z calibration\",\"0.1\",\"nm\"\r\n\"Output image data\",\"{data}\"\r\n\"Horizontal\",\"3\"\r\n\
             \"Vertical\",\"2\"\r\n\"Minimum value\",\"0.000\"\r\n\"Unit\",\"{unit}\"\r\n\"Reference data name\",\"\"\r\n\r\n\"{data}\"\r\n\
             \"0.000\",\"1.250\",\"2.500\"\r\n\"10.125\",\"11.250\",\"12.375\"\r\n"
        )
    };
    let text = table("um", "Height");
    let nothing = GivenScale::default();
    let german = text
        .replace("Measured date", "Gemessenes Datum")
        .replace("XY Calibration", "XY-Justierung")
        .replace("\"Unit\"", "\"Einheit\"")
        .replace("Output image data", "Bilddatenausg.")
        .replace("\"Height\"", "\"H\u{f6}he\"");
    for text in [&text, &german, &text.replace('"', "")] {
        let map = read_text(text, &nothing).expect(text);
        assert_eq!((map.grid().columns(), map.grid().rows()), (3, 2));
        for side in map.grid().cell() {
            assert!((side - 1.389e-6).abs() < 1e-18, "{side}");
        }
        assert!((map.heights()[5] - 12.375e-6).abs() < 1e-18);
    }
    let error = |text: &str| read_text(text, &nothing).expect_err(text).to_string();
    let laser = error(&table("um", "Laser"));
    assert!(laser.contains("\"Laser\", not heights"), "{laser}");
    let unit = error(&table("%", "Height"));
    assert!(unit.contains("values in \"%\""), "{unit}");
    let size = error(&text.replace("\"Vertical\",\"2\"", "\"Vertical\",\"768\""));
    assert!(size.contains("its header states 3 and 768"), "{size}");
    // A column that was not measured is part of the map.
    let hole = text.replace("\"0.000\",\"1", "\"\",\"1");
    let hole = error(&hole.replace("\"10.125\"", "\"\""));
    assert!(hole.contains("2 of 6 heights are missing"), "{hole}");
    // The same in Chinese, in GBK.
    let chinese = b"\"\xb2\xe2\xc1\xbf\xc8\xd5\xc6\xda\",\"2025-01-02\"\n\"\xce\xc4\xbc\xfe\xc0\xe0\xd0\xcd\",\"ImageDataCsv\"\n";
    let chinese = read_text(chinese, &nothing).unwrap_err().to_string();
    assert!(chinese.contains("surface.cell_size"), "{chinese}");
    let path = Path::new("map.csv");
    assert!(is_height_map(path, text.as_bytes()));
    let other = GivenScale {
        size: Some(MapSize::Pixel([1e-6; 2])),
        ..nothing
    };
    let error = read_text(&text, &other).unwrap_err().to_string();
    assert!(error.contains("a width of 4.167 um"), "{error}");
}

/// NanoScope writes the heights of an image as one column.
#[test]
fn one_column_is_no_map() {
    for title in ["Height(nm)\n", ""] {
        let text = format!("{title}1.5\n2.5\n3.5\n4.5\n");
        let error = read_text(text, &SCALE.into()).unwrap_err().to_string();
        assert!(error.contains("one column of 4 numbers"), "{error}");
        assert!(error.contains("reshape it"), "{error}");
    }
}

#[test]
fn files_of_other_formats_are_named() {
    for (start, format, advice) in [
        (&b"GWYPsomething"[..], "Gwyddion", "save it as text"),
        (b"MATLAB 5.0", "MATLAB", "as text with writematrix"),
        (
            b"CDF\x01",
            "a NetCDF file",
            "fakir.bem.Surface accepts its objects",
        ),
        (b"II+\0", "a BigTIFF image", "bigtiff=False"),
        (
            b"WSxM file copyright UAM\nSxM Image file\nImage header size: 4607\n\0",
            "a WSxM file",
            "Gwyddion",
        ),
        // The first line as in the module `opdfile.c` of Gwyddion.
        (
            b"Wyko ASCII Data File Format 0\t0\t1\nX Size\t736\n",
            "a text of Wyko",
            "Gwyddion",
        ),
        (
            b"\"\\*File list\"\n\"\\Version: 0x09300202\"\n",
            "a text of NanoScope",
            "Gwyddion",
        ),
        (b"\x01\0\x02", "an unknown format", "as an array of NumPy"),
        (b"\xff\xfe\0\xd8", "UTF-16", "save it as text in UTF-8"),
    ] {
        let error = read_text(start, &SCALE.into()).unwrap_err().to_string();
        assert!(error.contains(format), "{error}");
        assert!(error.contains(advice), "{error}");
    }
}

/// The map of the fixtures, of 8 by 3 um, as SDF in ASCII.
fn sdf(rows: &str) -> String {
    format!(
        "aISO-1.0\nManufacID = fakir\nNumPoints = 4\nNumProfiles = 3\nXscale = 2.0E-6\nYscale = 1.0E-6\nZscale = 1.0E-9\n\
         Zresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n{rows}\n*\n"
    )
}

#[test]
fn files_of_iso_25178() {
    let nothing = GivenScale::default();
    let rows = "0 1 2 3\n10 11 12 13 20 21\n22 23";
    check(&read_text(sdf(rows), &nothing).unwrap());
    check(&read_text(sdf(rows), &SCALE.into()).unwrap());
    let other = GivenScale {
        size: Some(MapSize::Width(9.0e-6)),
        ..nothing
    };
    let error = read_text(sdf(rows), &other).unwrap_err().to_string();
    assert!(
        error.contains("a width of 8 um, and 9 um is given"),
        "{error}"
    );
    let error = read_text(sdf("0 1"), &nothing).unwrap_err().to_string();
    assert!(
        error.contains("4 by 3 points, and it has 2 heights"),
        "{error}"
    );
    let error = read_text(sdf("0 high"), &nothing).unwrap_err().to_string();
    assert!(error.contains("\"high\" is no height"), "{error}");
    // Binary SDF: 42 bytes of texts, counts, scales, and the type of the heights.
    let binary = |kind: u8, heights: &[u8]| {
        let mut bytes = format!("{:<42}", "bISO-1.0").into_bytes();
        bytes.extend([4, 0, 3, 0]);
        bytes.extend(
            [2e-6, 1e-6, 1e-9, -1.0]
                .into_iter()
                .flat_map(f64::to_le_bytes),
        );
        bytes.extend([0, kind, 0]);
        bytes.extend(heights);
        bytes
    };
    let short = values(false);
    let short = short.iter().flat_map(|v| (*v as i16).to_le_bytes());
    let mut short: Vec<u8> = short.collect();
    check(&read_text(binary(5, &short), &nothing).unwrap());
    let error = read_text(binary(5, &short[1..]), &nothing).unwrap_err();
    assert!(
        error.to_string().contains("24 bytes, and 23 are left"),
        "{error}"
    );
    let error = read_text(binary(0, &short), &nothing).unwrap_err();
    assert!(error.to_string().contains("heights of type 0"), "{error}");
    short[..2].copy_from_slice(&i16::MIN.to_le_bytes());
    let error = read_text(binary(5, &short), &nothing).unwrap_err();
    assert!(
        error.to_string().contains("1 of 12 heights are missing"),
        "{error}"
    );
    // X3P with whole numbers, with floating-point numbers, and with heights in its description.
    let description = |kind: &str, increment: &str, data: &str| {
        let axis = |name: &str, kind: &str, increment: &str| {
            format!(
                "<{name}><AxisType>I</AxisType><DataType>{kind}</DataType><Increment>{increment}</Increment></{name}>"
            )
        };
        format!(
            "<?xml version=\"1.0\"?><p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\"><Record1><Axes>{}{}{}</Axes></Record1>\
             <Record3><MatrixDimension><SizeX>4</SizeX><SizeY>3</SizeY><SizeZ>1</SizeZ></MatrixDimension>{data}</Record3></p:ISO5436_2>",
            axis("CX", "D", "2.0e-6"),
            axis("CY", "D", "1.0e-6"),
            axis("CZ", kind, increment),
        )
    };
    let link = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";
    let whole: Vec<u8> = values(false)
        .iter()
        .flat_map(|v| (*v as i16).to_le_bytes())
        .collect();
    let double = values(false);
    let double = double
        .iter()
        .flat_map(|v| (1e-9 * f64::from(*v)).to_le_bytes());
    let double: Vec<u8> = double.collect();
    let listed = values(false);
    let listed = listed.iter().map(|v| format!("<Datum>0;0;{v}e-9</Datum>"));
    let listed = format!("<DataList>{}</DataList>", listed.collect::<String>());
    let of = |document: String, data: &[u8]| {
        let members = [
            ("main.xml", document.as_bytes()),
            ("bindata/data.bin", data),
        ];
        crate::tables::zip(&members)
    };
    // Whole numbers with an offset of 5 nm.
    let lower: Vec<u8> = values(false)
        .iter()
        .flat_map(|v| (*v as i16 - 5).to_le_bytes())
        .collect();
    let raised = description("I", "1e-9", link).replace(
        "<DataType>I</DataType>",
        "<DataType>I</DataType><Offset>5e-9</Offset>",
    );
    for archive in [
        of(description("I", "1e-9", link), &whole),
        of(raised, &lower),
        of(description("D", "1", link), &double),
        of(description("D", "1", &listed), &[]),
    ] {
        check(&read_text(archive, &nothing).unwrap());
    }
    let error = read_text(of(description("I", "1e-9", link), &[1]), &nothing).unwrap_err();
    assert!(
        error.to_string().contains("and it has 0 heights"),
        "{error}"
    );
}

#[test]
fn grey_images_have_the_largest_y_on_top() {
    // Grey values of 1000 for 1 nm: white is at 65.535 nm.
    let scale = GivenScale {
        size: Some(SCALE.size),
        height_range: Some(65.535e-9),
        ..GivenScale::default()
    };
    let from_top: Vec<u16> = values(false)
        .chunks(4)
        .rev()
        .flatten()
        .map(|value| 1000 * *value as u16)
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4, 3);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let big: Vec<u8> = from_top
        .iter()
        .flat_map(|grey| grey.to_be_bytes())
        .collect();
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&big)
        .unwrap();
    let check_nm = |bytes: &[u8], scale: &GivenScale| match read_text(bytes, scale) {
        Ok(map) => check(&map),
        Err(error) => panic!("{error}"),
    };
    check_nm(&bytes, &scale);
    let by_unit = GivenScale {
        height_range: None,
        height_unit: Some(1e-12),
        ..scale
    };
    check_nm(&bytes, &by_unit);
    let without = GivenScale {
        height_range: None,
        ..scale
    };
    let error = read_text(&bytes, &without).unwrap_err();
    assert!(
        matches!(error, HeightMapError::NoHeightRange { .. }),
        "{error}"
    );
    let error = read_text("1 2\n3 4\n", &scale).unwrap_err();
    assert!(
        matches!(error, HeightMapError::HeightRange { .. }),
        "{error}"
    );
    for big_endian in [false, true] {
        let tiff = |bits: u16, format: u16, compression: u16, data: &[u8]| {
            tiff(big_endian, [bits, format, compression], data)
        };
        let order = |grey: &u16| {
            if big_endian {
                grey.to_be_bytes()
            } else {
                grey.to_le_bytes()
            }
        };
        let pixels: Vec<u8> = from_top.iter().flat_map(order).collect();
        check_nm(&tiff(16, 1, 1, &pixels), &scale);
        let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), Compression::default());
        packer.write_all(&pixels).unwrap();
        check_nm(&tiff(16, 1, 8, &packer.finish().unwrap()), &scale);
        // Heights in nm.
        let order = |grey: &u16| {
            let height = f32::from(*grey) / 1000.0;
            if big_endian {
                height.to_be_bytes()
            } else {
                height.to_le_bytes()
            }
        };
        let pixels: Vec<u8> = from_top.iter().flat_map(order).collect();
        check_nm(&tiff(32, 3, 1, &pixels), &SCALE.into());
        let error = read_text(tiff(8, 1, 1, &pixels), &scale)
            .unwrap_err()
            .to_string();
        assert!(error.contains("a grey image of 16 bits"), "{error}");
    }
}

#[test]
fn tiff_in_tiles_and_packed() {
    // Heights in nm, from the top. Tiles of 16 by 16 pixels are larger than the image; PackBits with literal bytes alone.
    let heights: Vec<f32> = values(false)
        .chunks(4)
        .rev()
        .flatten()
        .map(|value| *value as f32)
        .collect();
    let literal = |bytes: &[u8]| -> Vec<u8> {
        let parts = bytes.chunks(128);
        parts
            .flat_map(|part| [&[part.len() as u8 - 1][..], part].concat())
            .collect()
    };
    let mut tile = vec![0.0_f32; 256];
    for (place, height) in heights.iter().enumerate() {
        tile[place / 4 * 16 + place % 4] = *height;
    }
    for big_endian in [false, true] {
        let bytes = |heights: &[f32]| -> Vec<u8> {
            let of = |height: &f32| match big_endian {
                true => height.to_be_bytes(),
                false => height.to_le_bytes(),
            };
            heights.iter().flat_map(of).collect()
        };
        let strips = tiff(big_endian, [32, 3, 32_773], &literal(&bytes(&heights)));
        check(&read_text(strips, &SCALE.into()).unwrap());
        let data = literal(&bytes(&tile));
        let length = data.len() as u32;
        let fields = [(322, 16), (323, 16), (324, 8), (325, length)];
        let tiles = tiff_with(big_endian, [32, 3, 32_773], &data, &fields);
        check(&read_text(tiles, &SCALE.into()).unwrap());
        let short = tiff_with(big_endian, [32, 3, 1], &data, &[(322, 16), (323, 16)]);
        let error = read_text(short, &SCALE.into()).unwrap_err().to_string();
        assert!(error.contains("it is damaged"), "{error}");
        let error = read_text(tiff(big_endian, [32, 3, 50_000], &data), &SCALE.into());
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("packed by method 50000: save it without"),
            "{error}"
        );
    }
}

/// Pages of reduced resolution are skipped; of several others, none is chosen.
#[test]
fn tiff_of_several_pages() {
    let heights = values(false);
    let rows = heights.chunks(4).rev().flatten();
    let pixels: Vec<u8> = rows
        .flat_map(|height| (*height as f32).to_le_bytes())
        .collect();
    let blocks = [(273, 8), (279, pixels.len() as u32)];
    let reduced = |kind| [&blocks[..], &[(254, kind)]].concat();
    // The second directory is that of the first one, moved behind it.
    let pages = |first: &[(u16, u32)], second: &[(u16, u32)]| {
        let [mut file, other] =
            [first, second].map(|fields| tiff_with(false, [32, 3, 1], &pixels, fields));
        let end = file.len();
        file[end - 4..].copy_from_slice(&(end as u32).to_le_bytes());
        file.extend(&other[8 + pixels.len()..]);
        file
    };
    for file in [pages(&blocks, &reduced(1)), pages(&reduced(1), &blocks)] {
        check(&read_text(file, &SCALE.into()).unwrap());
    }
    let error = read_text(pages(&blocks, &reduced(2)), &SCALE.into()).unwrap_err();
    assert!(
        error.to_string().contains("it has 2 pages: save the page"),
        "{error}"
    );
    // A directory that points to itself.
    let mut endless = tiff(false, [32, 3, 1], &pixels);
    let (start, end) = (8 + pixels.len() as u32, endless.len());
    endless[end - 4..].copy_from_slice(&start.to_le_bytes());
    assert!(read_text(endless, &SCALE.into()).is_err());
}

/// A TIFF image of 4 by 3 pixels in one strip, with bits, sample format and compression.
fn tiff(big_endian: bool, kind: [u16; 3], data: &[u8]) -> Vec<u8> {
    tiff_with(
        big_endian,
        kind,
        data,
        &[(273, 8), (279, data.len() as u32)],
    )
}

/// The same with the fields of tiles or strips.
fn tiff_with(big_endian: bool, kind: [u16; 3], data: &[u8], blocks: &[(u16, u32)]) -> Vec<u8> {
    let short = |value: u16| {
        if big_endian {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    let long = |value: u32| {
        if big_endian {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    let [bits, format, compression] = kind;
    let start = 8 + data.len() as u32;
    let mut bytes = if big_endian {
        b"MM".to_vec()
    } else {
        b"II".to_vec()
    };
    bytes.extend(short(42));
    bytes.extend(long(start));
    bytes.extend(data);
    let fields: [(u16, u32); 7] = [
        (256, 4),
        (257, 3),
        (258, bits.into()),
        (259, compression.into()),
        (262, 1),
        (277, 1),
        (339, format.into()),
    ];
    let fields = [&fields[..], blocks].concat();
    bytes.extend(short(fields.len() as u16));
    for (tag, value) in fields {
        bytes.extend(short(tag));
        bytes.extend(short(4));
        bytes.extend(long(1));
        bytes.extend(long(value));
    }
    bytes.extend(long(0));
    bytes
}

#[test]
fn missing_points_are_counted_or_filled() {
    let nothing = GivenScale::default();
    let filled = GivenScale {
        fill_missing: true,
        ..nothing
    };
    // The heights are a plane, which the interpolation continues.
    let rows = "0 1 2 3\n10 BAD BAD 13\n20 21 22 23";
    let error = read_text(sdf(rows), &nothing).unwrap_err().to_string();
    let message = "2 of 12 heights are missing, the first in column 1, row 1 (counted from 0)";
    assert!(error.contains(message), "{error}");
    let map = read_text(sdf(rows), &filled).unwrap();
    let height = map.heights()[5];
    assert!((height - 11e-9).abs() < 1e-17, "{height}");
    let error = read_text(sdf(&"BAD ".repeat(12)), &filled).unwrap_err();
    assert!(matches!(error, HeightMapError::Empty { .. }), "{error}");
    // More than half of the heights.
    let error = read_text(
        "1 nan\nnan nan\n",
        &GivenScale {
            fill_missing: true,
            ..SCALE.into()
        },
    );
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("3 of 4 heights are missing, more than half"),
        "{error}"
    );
    // A list of points that states its units, with one missing point.
    let point = |k: i32| format!("{} {} {}\n", f64::from(k % 15) * 0.5, k / 15, k % 15);
    let points: String = (0..150).filter(|k| *k != 31).map(point).collect();
    let list = format!("# Lateral units: um\n# Value units: nm\n{points}");
    let error = read_text(&list, &nothing).unwrap_err().to_string();
    assert!(error.contains("1 of 150 heights are missing"), "{error}");
    let map = read_text(&list, &filled).unwrap();
    assert_eq!((map.grid().columns(), map.grid().rows()), (15, 10));
    let [width, height] = map.grid().cell();
    assert!((width - 0.5e-6).abs() < 1e-18 && (height - 1e-6).abs() < 1e-18);
    assert!(
        (map.heights()[31] - 1e-9).abs() < 1e-17,
        "{}",
        map.heights()[31]
    );
}

#[test]
fn size_and_unit_are_the_callers() {
    let scale = MapScale {
        size: MapSize::Extent([8.0e-6, 3.0e-6]),
        height_unit: -1.0e-9,
    };
    let map = read_height_map(&fixture("fortran.npy"), None, &scale, MEMORY).expect("a height map");
    assert!((map.grid().cell()[0] - 2.0e-6).abs() < 1e-20);
    assert!((map.lowest() + 23.0e-9).abs() < 1e-20 && map.highest().abs() < 1e-20);
    for height_unit in [0.0, f64::NAN] {
        let scale = MapScale {
            height_unit,
            ..SCALE
        };
        let error = read_height_map(&fixture("fortran.npy"), None, &scale, MEMORY);
        assert!(matches!(error, Err(HeightMapError::HeightUnit(_))));
    }
    let scale = MapScale {
        size: MapSize::Pixel([1.0e-6, -1.0]),
        ..SCALE
    };
    let error = read_height_map(&fixture("fortran.npy"), None, &scale, MEMORY);
    assert!(matches!(error, Err(HeightMapError::Grid(_))));
}

#[test]
fn errors_of_archives_list_their_arrays() {
    let several = fixture("several.npz");
    let error = read(&several).expect_err("two arrays").to_string();
    assert!(
        error.contains("the arrays \"heights\", \"mask\""),
        "{error}"
    );
    let error =
        read_height_map(&several, Some("height"), &SCALE, MEMORY).expect_err("no such array");
    let HeightMapError::NoSuchArray { available, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(*available, ["heights", "mask"]);
    let error = read_height_map(&several, Some("mask"), &SCALE, MEMORY).expect_err("booleans");
    assert!(matches!(error, HeightMapError::ElementType { .. }));
    assert!(error.to_string().contains("array \"mask\""), "{error}");
    assert!(matches!(
        failure("map.npz", b"PK"),
        HeightMapError::NotNumpy { .. }
    ));
}

#[test]
fn wrong_arrays_are_named() {
    let doubles = |count: usize| vec![0; 8 * count];
    let error = failure("line.npy", &npy(1, "<f8", false, "(12,)", &doubles(12)));
    assert!(matches!(error, HeightMapError::Dimensions { shape, .. } if shape == [12]));
    let error = failure("short.npy", &npy(1, "<f8", false, "(3, 4)", &doubles(11)));
    assert!(
        error
            .to_string()
            .contains("96 bytes of data expected, 88 found"),
        "{error}"
    );
    let huge = "(4294967296, 4294967295)";
    let error = failure("huge.npy", &npy(1, "<f8", false, huge, &doubles(1)));
    assert!(matches!(error, HeightMapError::NotNumpy { .. }));
    let error = failure("none.npy", &npy(1, "<f8", false, "(0, 4)", &[]));
    assert!(matches!(error, HeightMapError::Empty { .. }));
    let error = failure(
        "complex.npy",
        &npy(1, "<c16", false, "(3, 4)", &doubles(24)),
    );
    assert!(
        matches!(error, HeightMapError::ElementType { .. }),
        "{error}"
    );
    assert!(matches!(
        failure("text.npy", b"1 2 3"),
        HeightMapError::NotNumpy { .. }
    ));
    let mut data = doubles(12);
    data[8 * 6..8 * 7].copy_from_slice(&f64::NAN.to_le_bytes());
    let error = failure("nan.npy", &npy(1, "<f8", false, "(3, 4)", &data)).to_string();
    assert!(
        error.contains("1 of 12 heights are missing, the first in column 2, row 1"),
        "{error}"
    );
}

#[test]
fn wrong_texts_are_named() {
    let error = failure("ragged.txt", b"1 2 3\n\n4 5\n");
    let HeightMapError::RaggedRow {
        line,
        found,
        expected,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!((line, found, expected), (3, 2, 3));
    let error = failure("word.txt", b"1 2 3\n4 five 6\n").to_string();
    assert!(error.contains("line 2, column 2: \"five\""), "{error}");
    assert!(matches!(
        failure("empty.txt", b"# nothing\n"),
        HeightMapError::Empty { .. }
    ));
    let header = "ncols 2\nnrows 2\ncellsize 1\nnodata_value -9999\n";
    let error = failure("hole.asc", format!("{header}1 2\n-9999 3\n").as_bytes());
    assert!(matches!(
        error,
        HeightMapError::NoData {
            line: 6,
            column: 1,
            ..
        }
    ));
    let usual = header.replace("nodata_value -9999\n", "");
    let error = failure("usual.asc", format!("{usual}1 2\n-9999 3\n").as_bytes());
    assert!(matches!(error, HeightMapError::NoData { line: 5, .. }));
    let error = failure("size.asc", format!("{header}1 2\n3 4\n5 6\n").as_bytes());
    assert!(matches!(
        error,
        HeightMapError::HeaderSize {
            rows: 2,
            found_rows: 3,
            ..
        }
    ));
    let missing = fixture("missing.npy");
    assert!(matches!(read(&missing), Err(HeightMapError::Read { .. })));
}

/// An archive of one array of zeros: the header contains `shape`, and `doubles` follow, which are
/// compressed to almost nothing.
fn packed_zeros(shape: &str, doubles: usize) -> Vec<u8> {
    archive(CompressionMethod::DEFLATE, |file| {
        file.write_all(&npy(1, "<f8", false, shape, &[])).unwrap();
        let zeros = vec![0; 1 << 20];
        for _ in 0..(8 * doubles).div_ceil(zeros.len()) {
            file.write_all(&zeros).unwrap();
        }
    })
}

/// An archive of one file.
fn archive(method: CompressionMethod, write: impl Fn(&mut dyn Write)) -> Vec<u8> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    let (mut entry, config) = archive
        .new_file("heights.npy")
        .compression_method(method)
        .start()
        .unwrap();
    let descriptor = if method == CompressionMethod::STORE {
        let mut file = config.wrap(&mut entry);
        write(&mut file);
        file.finish().unwrap().1
    } else {
        let mut file = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
        write(&mut file);
        let (encoder, descriptor) = file.finish().unwrap();
        encoder.finish().unwrap();
        descriptor
    };
    entry.finish(descriptor).unwrap();
    archive.finish().unwrap()
}

/// Whether this process runs a single test; if not, runs the test in a separate process. Memory is measured for a
/// whole process, and other tests run at the same time.
fn runs_alone(test: &str) -> bool {
    if std::env::var_os("FAKIR_ONE_TEST").is_some() {
        return true;
    }
    let status = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", test])
        .env("FAKIR_ONE_TEST", "1")
        .status();
    assert!(status.unwrap().success(), "{test}");
    false
}

/// Peak memory of this process, bytes, if available.
fn most_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}

/// An archive of 0.5 MB that unpacks to 512 MB is refused because of its header. If the header
/// states a small size, only that much is read, and the archive is refused too.
#[test]
fn what_does_not_fit_the_memory_is_refused_before_it_is_unpacked() {
    if !runs_alone("height_map::what_does_not_fit_the_memory_is_refused_before_it_is_unpacked") {
        return;
    }
    let before = most_memory();
    let error = failure("map.npz", &packed_zeros("(8192, 8192)", 1 << 26));
    let HeightMapError::TooLarge {
        points,
        bytes,
        limit,
        ..
    } = &error
    else {
        panic!("{error}");
    };
    assert_eq!((points.as_str(), *limit), ("8192 by 8192 points", MEMORY));
    assert!((bytes - 64.0 * 8192.0 * 8192.0).abs() < 1.0);
    let error = failure("map.npz", &packed_zeros("(3, 4)", 1 << 26)).to_string();
    assert!(
        error.contains("it contains data after its last element"),
        "{error}"
    );
    // A fifth of the unpacked size.
    if let (Some(before), Some(after)) = (before, most_memory()) {
        assert!(after < before + 100_000_000, "{before} {after}");
    }
    let error = failure("map.npy", &npy(1, "<f4", true, "(100000, 1000)", &[0; 64]));
    assert!(matches!(error, HeightMapError::TooLarge { .. }), "{error}");
    let mut header = npy(2, "<f8", false, "(3, 4)", &[]);
    header[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = failure("header.npy", &header).to_string();
    assert!(error.contains("its header is longer"), "{error}");
    // Two bytes a height, 64 in memory.
    let error = failure("map.txt", &b"1 2 3 4 5 6 7 8\n".repeat(250_000));
    let HeightMapError::TooLarge { points, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(points, "1562504 points or more");
}

/// Archives have a checksum of every array.
#[test]
fn a_byte_changed_in_an_archive_is_noticed() {
    let data: Vec<u8> = values(false).iter().flat_map(|v| v.to_le_bytes()).collect();
    let array = npy(1, "<i4", false, "(3, 4)", &data);
    let mut bytes = archive(CompressionMethod::STORE, |file| {
        file.write_all(&array).unwrap();
    });
    let start = bytes
        .windows(array.len())
        .position(|window| window == array);
    bytes[start.unwrap() + array.len() - 3] ^= 1;
    let error = failure("map.npz", &bytes);
    assert!(matches!(error, HeightMapError::NotNumpy { .. }), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_without_end_is_refused_by_its_first_bytes() {
    let error = read(Path::new("/dev/zero")).expect_err("it has no end");
    assert!(
        matches!(error, HeightMapError::OtherFormat { .. }),
        "{error}"
    );
}

#[test]
fn a_line_without_end_is_read_no_further_than_the_longest_one() {
    // Digits, and zeros in a sparse file.
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(&[b'1'; 1000]).unwrap();
    file.as_file().set_len(1_000_000_000).unwrap();
    let error = read(file.path()).expect_err("one line");
    assert!(
        matches!(error, HeightMapError::LongLine { line: 1, .. }),
        "{error}"
    );
}
