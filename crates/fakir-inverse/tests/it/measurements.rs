//! Files of instruments: every text states the same rows as a plain one, or what is detected in it.

use fakir::state::Branch;
use fakir_inverse::fit::{Hints, Measurements, NamedColumn, Selection, SkipReason};

fn read(text: &str) -> Measurements {
    Measurements::from_csv("data", text.as_bytes(), &[]).unwrap()
}

fn read_by_hand(text: &str, named: &[&str], spring_constant: Option<f64>) -> Measurements {
    let named = named.iter().map(|text| NamedColumn::parse(text).unwrap());
    let hints = Hints {
        named: named.collect(),
        spring_constant,
        ..Hints::default()
    };
    Measurements::from_bytes("data", text.as_bytes(), &hints).unwrap()
}

/// Positions in um and forces in uN, rounded.
fn values(data: &Measurements) -> Vec<[f64; 2]> {
    let round = |value: f64| (value * 1e12).round() / 1e6;
    let rows = data.rows().iter();
    rows.map(|row| [row.position.unwrap().value, row.force.unwrap().value].map(round))
        .collect()
}

fn lines(data: &Measurements) -> String {
    data.layout().lines().join("\n")
}

/// A loading by 12 steps of 1 um, the first 4 out of contact, with factors of position and force.
fn loading(factors: [f64; 2], separator: &str) -> String {
    let row = |step: u32| {
        let depth = f64::from(step);
        let force = (depth - 4.0).max(0.0).powi(2);
        format!("{}{separator}{}\n", factors[0] * depth, factors[1] * force)
    };
    (0..12).map(row).collect()
}

#[test]
fn separators_units_and_numbers() {
    let expected = [[2.5, 1.5], [3.5, -2.0]];
    for text in [
        // numpy.savetxt with a header, separated by blanks or by commas in the header alone.
        "# displacement_um force_uN\n2.5 1.5\n3.5 -2.0\n",
        "# displacement_um, force_uN\n2.500e+00 1.500e+00\n3.500e+00 -2.000e+00\n",
        "Displacement (um)  Normal force (uN)\n   2.5       1.5\n   3.5      -2.0\n",
        "Time(s) Position (um) Force (uN)\n0 2.5 1.5\n1 3.5 -2\n",
        // pandas.DataFrame.to_csv with its index: the first cell is empty.
        ";displacement_um;force_uN\n0;2,5;1,5\n1;3,5;-2,0\n",
        // A row of units after an empty one.
        "Displacement,Force\n,\n[um],[uN]\n2.5,1.5\n3.5,-2\n",
        // Rows that were not measured.
        "displacement_um,force_uN\nNaN,NaN\n2.5,1.5\nBad,-\n3.5,-2\n3.6,\n",
        // Markers between rows and a footer.
        "displacement_um,force_uN\n--- hold ---\n2.5,1.5\nPoint 2\n3.5,-2\n\nMaximum,1.5\nEnd of test: 12:30\n",
        // Errors of formulas, and numbers that are none, as C and C++ write them.
        "displacement_um,force_uN\n#DIV/0!,#NV\n2.5,1.5\n3.0,#WERT!\n3.5,-2\n-nan,+NaN\n-nan(ind),-1.#IND\n",
        // Exponents of Fortran.
        "displacement_m force_N\n 2.5D-06 1.5D-06\n 3.5D-06 -2.0d-06\n",
        // A header of LabVIEW, in which a line names the same quantity for every channel.
        "X_Dimension\tTime\tTime\nX0\t0\t0\nX_Value\tDisplacement (um)\tForce (uN)\tComment\n0\t2.5\t1.5\n1\t3.5\t-2\n",
        // LabVIEW: the last cell of a row, that of the comment, is missing.
        "Time (s)\tDisplacement (um)\tForce (uN)\tComment\n0\t2.5\t1.5\tbegin\n1\t3.5\t-2\n",
        // Bluehill: headings in quotes over two lines.
        "\"Extension\n(mm)\",\"Load\n(mN)\"\n0.0025,0.0015\n0.0035,-0.002\n",
        // MTS: words of the header that are those of headings, a channel before each name, and a row of units in which another column has a number.
        "Operator Force\tKD\tTime:\t20 s\n\nTime\tCh 1 Kraft\tCh 1 Weg\tB 7\ns\tkN\tmm\t1280\n0\t1,5e-9\t0,0025\t3\n1\t-2e-9\t0,0035\t3\n",
        "Force,Displacement,Operator\n500 N range,10 mm range,KD\n\nTime (s),Displacement (um),Force (uN)\n0,2.5,1.5\n1,3.5,-2\n",
        // The letter of a channel is no unit.
        "Displacement A\tForce A\num\tuN\n2.5\t1.5\n3.5\t-2\n",
        // NanoSuite: the first cell of the row of units is empty.
        "Segment;Displacement Into Surface;Load On Sample\n;um;uN\nSurface;2,5;1,5\n;3,5;-2,0\n",
        // Thousands.
        "Displacement (nm);Force (nN)\n\"2,500.0\";\"1,500.0\"\n3 500.0;\"-2,000.0\"\n",
        "Displacement (nm);Force (nN)\n2.500,0;1.500,0\n3'500,0;-2.000,0\n",
    ] {
        assert_eq!(values(&read(text)), expected, "{text}");
    }
    let text = "Displacement (mil);Load (gf)\n10;2\n";
    assert_eq!(values(&read(text)), [[254.0, 19_613.3]]);
    let text = "Displacement [in];Load [lbf]\n0.01;0.001\n";
    assert_eq!(values(&read(text)), [[254.0, 4_448.221_615]]);
    let text = "Displacement [cm];Load [dyn]\n0.1;2\n";
    assert_eq!(values(&read(text)), [[1000.0, 20.0]]);
}

#[test]
fn skipped_rows_are_counted() {
    let text = "displacement_um,force_uN\nNaN,1\n2,1\nBad,-\nPoint 2\n3,2\nMean,1\n";
    let data = read(text);
    let skipped: Vec<_> = data.layout().skipped.iter().collect();
    assert_eq!(data.layout().rows_skipped(), 4);
    assert_eq!(skipped[0].reason, SkipReason::Text);
    assert_eq!(skipped[0].lines, [5, 7]);
    assert_eq!(skipped[1].lines, [2, 4]);
    assert!(
        lines(&data).contains("skipped: 2 rows without a value (lines 2 to 4)"),
        "{}",
        lines(&data)
    );
}

#[test]
fn volts_and_deflections_are_converted() {
    let expected = [[2.0, 0.05], [3.0, 0.1]];
    let text = "Z (um),Deflection [V]\n2,2\n3,4\n";
    let data = read_by_hand(text, &["force=Deflection [V]*25 nN/V"], None);
    assert_eq!(values(&data), expected);
    assert!(lines(&data).contains("in V*25 nN/V, named by hand"));
    let data = read_by_hand(text, &["deflection=Deflection [V]*125nm/V"], Some(0.2));
    assert_eq!(values(&data), expected);
    // The displacement contains the deflection: compliance of the cantilever.
    assert_eq!(data.layout().cantilever_compliance, Some(5.0));
    let text = "Z (um),Deflection (nm)\n2,250\n3,500\n";
    let data = read_by_hand(text, &[], Some(0.2));
    assert_eq!(values(&data), expected);
    let error = Measurements::from_csv("data", text.as_bytes(), &[]).unwrap_err();
    assert!(error.to_string().contains("columns are missing"), "{error}");
    let named = [NamedColumn::parse("deflection=Deflection (nm)").unwrap()];
    let error = Measurements::from_csv("data", text.as_bytes(), &named).unwrap_err();
    assert!(error.to_string().contains("--spring-constant"), "{error}");
}

#[test]
fn compression_that_is_counted_negative_is_detected() {
    let text = format!("Position [um],Load [uN]\n{}", loading([1.0, 1.0], ","));
    let plain = read(&text);
    let expected = values(&plain);
    assert!(plain.layout().notes.is_empty(), "{}", lines(&plain));
    for factors in [[1.0, -1.0], [-1.0, -1.0]] {
        let text = format!("Position [um],Load [uN]\n{}", loading(factors, ","));
        let data = read(&text);
        assert_eq!(values(&data), expected);
        assert!(lines(&data).contains("compression is counted negative"));
        assert!(lines(&data).contains("in uN, with the opposite sign"));
    }
    // Heights of an AFM decrease, and the deflection has an offset.
    let text = format!("Height (um);Deflection (uN)\n{}", loading([-1.0, 1.0], ";"));
    assert_eq!(values(&read(&text)), expected);
    // Names that define the sign, and columns named by hand, are left as they are.
    for heading in ["displacement_m,force_N", "displacement_um,force_mN"] {
        let text = format!("{heading}\n{}", loading([1.0, -1.0], ","));
        assert!(read(&text).rows()[11].force.unwrap().value < 0.0);
    }
    let text = format!("Position [um],Load [uN]\n{}", loading([1.0, -1.0], ","));
    let data = read_by_hand(&text, &["force=Load [uN]"], None);
    assert!(data.rows()[11].force.unwrap().value < 0.0);
}

/// A load cell that was not set to zero, and a stage that counts down: the lens turns where the force changes.
#[test]
fn signs_are_found_in_spite_of_an_offset() {
    let depths = (-10..=10).chain((-10..10).rev()).map(f64::from);
    let rows = depths.map(|depth: f64| {
        let force = depth.max(0.0).powf(1.5) - 20.0;
        format!("{},{force}\n", 5000.0 - depth)
    });
    let data = read(&format!(
        "Position [um],Load [uN]\n{}",
        rows.collect::<String>()
    ));
    assert!(lines(&data).contains("the position decreases as the lens moves down"));
    assert!(data.rows()[20].position.unwrap().value > data.rows()[0].position.unwrap().value);
}

/// What other instruments write: MTI (a comma behind every row), `WinTest` (a zero behind the first line), Shimadzu (a row of units), `LabVIEW`
/// (units in the header), loading and unloading side by side below a line with their names, and UTF-16 without a mark.
#[test]
fn files_of_other_instruments() {
    let expected = [[1.0, 0.1], [2.0, 0.3], [3.0, 0.6]];
    let plain = "Disp (um), Load (uN)\n1, 0.1\n2, 0.3\n3, 0.6\n";
    let commas = "Disp (um), Load (uN), Time (s)\n1.0, 0.1, 0.5,\n2.0, 0.3, 1.0,\n3.0, 0.6, 1.5,\n";
    let zero = format!("WinTest\0\r\n{plain}");
    let labview = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\nChannels\t2\nY_Unit_Label\tum\tuN\n\
                   X_Dimension\tTime\tTime\n***End_of_Header***\nX_Value\tStage position\tLoad cell\tComment\n\
                   0.0\t1\t0.1\n0.1\t2\t0.3\n0.2\t3\t0.6\n";
    for text in [plain, commas, &zero, labview] {
        assert_eq!(values(&read(text)), expected, "{text}");
    }
    assert_eq!(read(labview).rows()[2].time, Some(0.2));
    let wide: Vec<u8> = plain.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let data = Measurements::from_csv("data", &wide, &[]).unwrap();
    assert_eq!(values(&data), expected);
    let text = "Loading\t\tUnloading\t\nPosition\tForce\tPosition\tForce\num\tuN\tum\tuN\n1\t0.1\t3\t0.6\n2\t0.3\t1\t0.1\n";
    let data = read(text);
    assert_eq!(
        values(&data),
        [[1.0, 0.1], [2.0, 0.3], [3.0, 0.6], [1.0, 0.1]]
    );
    assert_eq!(data.rows()[2].branch, Some(Branch::Unloading));
    // Steps of a motor.
    for factor in ["40 nm", "40 nm/step", "0.04 um/count"] {
        let named = format!("displacement=steps*{factor}");
        let data = read_by_hand(
            "steps,Force (uN)\n25,0.1\n50,0.3\n75,0.6\n",
            &[&named],
            None,
        );
        for (found, expected) in values(&data)
            .iter()
            .flatten()
            .zip(expected.iter().flatten())
        {
            assert!((found - expected).abs() < 1e-9, "{factor}");
        }
    }
    // A unit by hand that the row of units contradicts.
    let text = "\"Time\",\"Force\",\"Stroke\"\n\"sec\",\"N\",\"mm\"\n0,1,1\n1,2,2\n";
    let named = [NamedColumn::parse("force=Force (mN)").unwrap()];
    let error = Measurements::from_csv("data", text.as_bytes(), &named).unwrap_err();
    assert!(
        error.to_string().contains("its unit in the row below is N"),
        "{error}"
    );
    let data = read_by_hand(text, &["force=Force (N)"], None);
    assert_eq!(data.rows().len(), 2);
}

#[test]
fn limits_of_a_load_cell_and_repeated_rows_are_noted() {
    let force = |depth: f64| depth.powf(1.5).min(20.0);
    let rows = (1..=20).map(|k| format!("{k},{}\n", force(f64::from(k))));
    let rows: Vec<String> = rows.collect();
    let data = read(&format!("z_um,force_uN\n{}", rows.concat()));
    assert!(
        lines(&data).contains("13 rows (lines 9 to 21) have the same extreme force of 20 uN"),
        "{}",
        lines(&data)
    );
    let twice: String = rows[..8].iter().map(|row| row.repeat(2)).collect();
    let data = read(&format!("z_um,force_uN\n{twice}"));
    assert!(
        lines(&data).contains("8 rows repeat the row before them"),
        "{}",
        lines(&data)
    );
    let plain = read(&format!("z_um,force_uN\n{}", rows[..7].concat()));
    assert!(plain.layout().notes.is_empty(), "{}", lines(&plain));
}

/// Two cycles of 8 rows, in um and uN.
fn cycles() -> String {
    let cycle = [0, 1, 2, 3, 4, 3, 2, 1];
    let rows = cycle
        .iter()
        .chain(&cycle)
        .map(|z| format!("{z},{}\n", z * z));
    format!("z_um,force_uN\n{}", rows.collect::<String>())
}

#[test]
fn rows_are_selected() {
    let data = read(&cycles());
    // The row of the smallest load ends the first cycle.
    assert_eq!(data.cycles(), [0..9, 9..16]);
    assert!(lines(&data).contains("2 cycles of loading and unloading: all of them are used"));
    let count = |selection: &Selection| {
        let data = data.clone().select(selection).unwrap();
        let left = data.layout().skipped.iter().map(|it| it.lines.len());
        assert_eq!(left.sum::<usize>() + data.rows().len(), 16);
        (data.rows()[0].line, data.rows().len())
    };
    let all = Selection::default();
    let second = Selection {
        cycle: Some(2),
        ..all
    };
    assert_eq!(count(&second), (11, 7));
    let unloading = Selection {
        branch: Some(Branch::Unloading),
        ..second
    };
    assert_eq!(count(&unloading), (15, 3));
    let chosen = data.clone().select(&unloading).unwrap();
    assert_eq!(chosen.unloading_point(), Some(4e-6));
    assert!(lines(&chosen).contains("the unloading begins at 4 um, the load of line 14"));
    let rows = Selection {
        rows: Selection::parse_rows("3:5").unwrap(),
        ..all
    };
    assert_eq!(count(&rows), (4, 3));
    let range = Selection {
        from: Some(2.5e-6),
        to: Some(3.5e-6),
        ..all
    };
    assert_eq!(count(&range), (5, 4));
    let chosen = data.clone().select(&second).unwrap();
    assert!(lines(&chosen).contains("cycle 2 of 2 is used: lines 11 to 17"));
    assert!(lines(&chosen).contains("skipped: 9 rows not selected (lines 2 to 10)"));
    let error = |selection: Selection| data.clone().select(&selection).unwrap_err().to_string();
    let third = error(Selection {
        cycle: Some(3),
        ..all
    });
    assert!(
        third.contains("there is no cycle 3: the data have 2"),
        "{third}"
    );
    let none = error(Selection {
        from: Some(1.0),
        ..all
    });
    assert!(
        none.contains("16 rows and loads from 0 m to 4 um"),
        "{none}"
    );
    for text in ["5", "5:3", "0:3", "a:b"] {
        assert!(Selection::parse_rows(text).is_err(), "{text}");
    }
}

#[test]
fn branches_side_by_side_and_segments() {
    let text = "Z_um_Ex\tZ_um_Rt\tForce_uN_Ex\tForce_uN_Rt\n1\t2\t3\t4\n2\t1\t5\t2\n";
    let data = read(text);
    assert_eq!(
        values(&data),
        [[1.0, 3.0], [2.0, 5.0], [2.0, 4.0], [1.0, 2.0]]
    );
    let branches: Vec<_> = data.rows().iter().map(|row| row.branch.unwrap()).collect();
    use Branch::{Loading, Unloading};
    assert_eq!(branches, [Loading, Loading, Unloading, Unloading]);
    // The text of JPK: comments name columns, units and segments.
    let header = |segment: &str| {
        format!(
            "# segment: {segment}\n# springConstant: 0.05\n# columns: height vDeflection measuredHeight time\n\
             # fancyNames: \"Height\" \"Vertical deflection\" \"Height (measured)\" \"Segment Time\"\n# units: m N m s\n"
        )
    };
    let rows = |range: &mut dyn Iterator<Item = i32>| -> String {
        let row = |step: i32| {
            let force = 1e-9 * f64::from((step - 6).max(0)) + 5e-8;
            let height = 1e-5 - 1e-7 * f64::from(step);
            format!("0 {force:e} {height:e} 0.1\n")
        };
        range.map(row).collect()
    };
    let text = format!(
        "# jpk\n{}{}\n{}{}",
        header("extend"),
        rows(&mut (0..12)),
        header("retract"),
        rows(&mut (0..12).rev())
    );
    let data = read(&text);
    assert_eq!(data.rows().len(), 24);
    assert_eq!(data.rows()[0].branch, Some(Loading));
    assert_eq!(data.rows()[23].branch, Some(Unloading));
    assert!(
        lines(&data).contains("displacement: column 3 \"Height  measured\""),
        "{}",
        lines(&data)
    );
    assert!(data.rows()[11].position.unwrap().value > data.rows()[0].position.unwrap().value);
    assert_eq!(data.layout().cantilever_compliance, Some(20.0));
}

/// As `export_data` of afmformats 0.18 writes it: units are SI, and the height contains the deflection of the cantilever.
#[test]
fn one_branch_named_by_hand_keeps_its_own_columns() {
    let text = "Z_approach (um),F_approach (uN),Z_retract (um),F_retract (uN)\n2,1,3,2\n4,3,1,-1\n";
    let whole = read(text);
    let named = read_by_hand(text, &["force=F_approach (uN)"], None);
    assert_eq!(values(&named), values(&whole));
    assert_eq!(
        values(&named),
        [[2.0, 1.0], [4.0, 3.0], [3.0, 2.0], [1.0, -1.0]]
    );
    // Of the other branch no force is understood, until it is named too.
    let text = "Extend Z (um),Extend T-B (V),Retract Z (um),Retract T-B (V)\n2,1,3,2\n4,3,1,-1\n";
    let extend = "force=Extend T-B (V)*1 uN/V";
    let one = read_by_hand(text, &[extend], None);
    assert_eq!(values(&one), [[2.0, 1.0], [4.0, 3.0]]);
    assert!(
        lines(&one).contains("only the columns of loading are used"),
        "{}",
        lines(&one)
    );
    let both = read_by_hand(text, &[extend, "force=Retract T-B (V)*1 uN/V"], None);
    assert_eq!(values(&both), values(&whole));
    assert!(
        both.rows()
            .iter()
            .map(|row| row.branch)
            .eq(whole.rows().iter().map(|row| row.branch))
    );
}

#[test]
fn pauses_belong_to_viscoelastic_bodies() {
    let of_jpk = "# segment: extend\n# columns: z f\n# units: um uN\n1 1\n2 2\n\n# segment: pause\n# columns: z f\n2 1.5\n\n# segment: retract\n# columns: z f\n1 0.5\n";
    let of_column =
        "segment,z_um,force_uN\napproach,1,1\napproach,2,2\ndwell,2,1.5\nretract,1,0.5\n";
    for text in [of_jpk, of_column] {
        let data = read(text);
        assert_eq!(
            values(&data),
            [[1.0, 1.0], [2.0, 2.0], [1.0, 0.5]],
            "{text}"
        );
        let skipped = &data.layout().skipped[0];
        assert_eq!(
            (skipped.reason, skipped.lines.len()),
            (SkipReason::Pause, 1)
        );
        let hints = Hints {
            has_pauses: true,
            ..Hints::default()
        };
        let whole = Measurements::from_bytes("data", text.as_bytes(), &hints).unwrap();
        assert_eq!(whole.rows().len(), 4, "{text}");
    }
}

#[test]
fn rows_below_those_selected_may_contain_anything() {
    let text = "displacement_um,force_uN\n2.5,1.5\n3.5,-2\n1,2,3\n";
    let hints = |last_row| Hints {
        last_row,
        ..Hints::default()
    };
    let read = |last_row| Measurements::from_bytes("data", text.as_bytes(), &hints(last_row));
    assert_eq!(values(&read(Some(2)).unwrap()), [[2.5, 1.5], [3.5, -2.0]]);
    for last_row in [None, Some(3)] {
        let problem = read(last_row).unwrap_err().to_string();
        assert!(
            problem.contains("data:4: 3 cells, but 2 in the heading"),
            "{problem}"
        );
    }
}

#[test]
fn a_sign_defined_by_hand_that_contradicts_the_data_is_named() {
    let text = format!("Weg um;Kraft uN\n{}", loading([-1.0, -1.0], ";"));
    let named = ["displacement=Weg um", "force=Kraft uN"];
    let found = lines(&read_by_hand(&text, &named, None));
    assert!(
        found.contains("did you mean displacement=\"-Weg um\" and force=\"-Kraft uN\"?"),
        "{found}"
    );
}

#[test]
fn columns_by_number_below_a_row_of_units() {
    let text = "Test 1\t\t\tTest 2\t\t\nForce\tDistance\tTime\tForce\tDistance\tTime\nmN\tmm\tsec\tmN\tmm\tsec\n1\t2\t0\t3\t4\t0\n";
    let data = read_by_hand(text, &["force=#4", "displacement=#5"], None);
    assert_eq!(values(&data), [[4000.0, 3000.0]]);
}

#[test]
fn text_of_afmformats() {
    let text = "# afmformats 0.18.7\r\n#\r\n# BEGIN METADATA\r\n# {\r\n#   \"spring constant\": 0.05,\r\n#   \"z range\": 1e-06\r\n# }\r\n\
                # END METADATA\r\n#\r\n# force\theight (measured)\tsegment\r\n1.5e-06\t-2.5e-06\t0\r\n-2e-06\t-3.5e-06\t1\r\n";
    let data = read(text);
    assert_eq!(values(&data), [[2.5, 1.5], [3.5, -2.0]]);
    assert_eq!(data.layout().cantilever_compliance, Some(20.0));
    let tip = read(&text.replace("height (measured)", "tip position"));
    assert_eq!(tip.layout().cantilever_compliance, None);
}

#[test]
fn factors_in_headings_are_not_dropped() {
    for heading in [
        "1000*Load (N)",
        "Load/1000 (N)",
        "Load^2 (N)",
        "Load 10^-3 (N)",
    ] {
        let text = format!("Depth (um),{heading}\n2.5,1.5\n3.5,-2\n");
        let error = Measurements::from_csv("data", text.as_bytes(), &[]).unwrap_err();
        let error = error.to_string();
        assert!(
            error.starts_with(&format!("data:1: {heading}: a factor")),
            "{error}"
        );
        assert!(error.contains("*0.001\""), "{error}");
        let data = read_by_hand(&text, &[&format!("force={heading}*0.000001")], None);
        assert_eq!(values(&data), [[2.5, 1.5], [3.5, -2.0]]);
    }
    // Beside a column without a factor it is not used.
    let text = "Depth (um),Load (uN),1000*Load (N)\n2.5,1.5,0.0015\n3.5,-2,-0.002\n";
    assert_eq!(values(&read(text)), [[2.5, 1.5], [3.5, -2.0]]);
}

#[test]
fn contradictory_units_are_refused() {
    for (headings, units) in [
        ("Depth (um),Load (N)", "um,mN"),
        ("displacement_um,force_N", "um,mN"),
        ("Height (um),Load (N)", "um,mN"),
        ("Depth (um),Load (N)", "um,nm"),
    ] {
        let text = format!("{headings}\n{units}\n2.5,1.5\n3.5,-2\n");
        let error = Measurements::from_csv("data", text.as_bytes(), &[]).unwrap_err();
        let error = error.to_string();
        let below = &units[3..];
        assert!(
            error.starts_with("data:1: ")
                && error.contains(&format!("says N, the row of units below {below}")),
            "{error}"
        );
    }
    // The same units in other words are no contradiction.
    let text = "Depth (\u{b5}m),Load (uN)\n[micron],[\u{3bc}N]\n2.5,1.5\n3.5,-2\n";
    assert_eq!(values(&read(text)), [[2.5, 1.5], [3.5, -2.0]]);
    let text = "Depth (um),Load (uN)\n(um),(N)\n2.5,1.5\n3.5,-2\n";
    let data = read_by_hand(text, &["force=Load (uN)"], None);
    assert_eq!(values(&data), [[2.5, 1.5], [3.5, -2.0]]);
}

#[test]
fn rows_of_statistics_are_skipped() {
    let expected = [[2.5, 1.5], [3.5, -2.0]];
    for (text, skipped) in [
        (
            "Nr,Depth (um),Load (uN)\n0,2.5,1.5\n1,3.5,-2\nMean,3,-0.25\nSD,0.5,1.75\n",
            [4, 5],
        ),
        // ImageJ numbers these rows too.
        (
            " ,Label,Depth (um),Load (uN)\n1,a.tif,2.5,1.5\n2,a.tif,3.5,-2\n3,Min,2.5,-2\n4,Max,3.5,1.5\n",
            [4, 5],
        ),
        // The label is above its numbers.
        (
            "Depth (um),Load (uN)\n2.5,1.5\n3.5,-2\nMean\n3,-0.25\n",
            [4, 5],
        ),
        // A table of a spreadsheet has tabs; the words need not be known.
        (
            "Nr\tDepth (um)\tLoad (uN)\n0\t2.5\t1.5\n1\t3.5\t-2\n2\t\t\n3\t\t\nMitte\t3\t-0.25\n",
            [6, 6],
        ),
    ] {
        let data = read(text);
        assert_eq!(values(&data), expected, "{text}");
        let found = data.layout().skipped.iter();
        let mut found = found.filter(|skipped| skipped.reason == SkipReason::Text);
        let lines = &found.next().unwrap().lines;
        assert_eq!([lines[0], lines[lines.len() - 1]], skipped, "{text}");
    }
    // Names of samples and of segments beside the values are no statistics.
    for text in [
        "Sample,Depth (um),Load (uN)\nMax,2.5,1.5\nMax,3.5,-2\n",
        "Depth (um),Load (uN),Event\n2.5,1.5,start\n3.5,-2,max\n",
    ] {
        assert_eq!(values(&read(text)), expected, "{text}");
    }
}

#[test]
fn another_heading_between_the_rows_is_refused() {
    let message = |text: &str| {
        let error = Measurements::from_csv("data", text.as_bytes(), &[]);
        error.unwrap_err().to_string()
    };
    for second in [
        "Load (uN),Depth (um)",
        "Depth (nm),Load (uN)",
        "Time (s),Temperature (C)",
        "Time (s),Depth (um),Load (uN)",
        "Height (um),Deflection (uN)",
    ] {
        let text = format!("Depth (um),Load (uN)\n2.5,1.5\n{second}\n3.5,-2\n");
        let error = message(&text);
        assert!(
            error.starts_with("data:3: another heading that differs from that of line 1: save"),
            "{error}"
        );
    }
    let text = "Depth,Load\num,uN\n2.5,1.5\nDepth,Load\num,mN\n3.5,-2\n";
    assert!(
        message(text).starts_with("data:5: a row of units that differs"),
        "{}",
        message(text)
    );
    let text = "Depth (um) Load (uN)\n2.5 1.5\nDepth (nm) Load (uN)\n3.5 -2\n";
    assert!(
        message(text).starts_with("data:3: another heading"),
        "{}",
        message(text)
    );
    // The same heading again, and markers with words of headings.
    for between in [
        "Depth (um),Load (uN)",
        "depth  (um),Load (uN),",
        "Load",
        "Segment 2,load",
        "Load,hold",
    ] {
        let text = format!("Depth (um),Load (uN)\n2.5,1.5\n{between}\n3.5,-2\n");
        assert_eq!(values(&read(&text)), [[2.5, 1.5], [3.5, -2.0]], "{text}");
    }
}

#[test]
fn thousands_are_recognised_or_refused() {
    // Depths in nm every 100 nm and forces in uN, as instruments and spreadsheets write them.
    let file = |headings: &str, write: &dyn Fn(i32) -> [String; 2], separator: &str| {
        let rows = (0..40).map(|k| write(100 * k - 100).join(separator) + "\n");
        format!("{headings}\n{}", rows.collect::<String>())
    };
    let force = |depth: i32| (depth / 100) * (depth / 100);
    let grouped = |value: i32, mark: &str| match value {
        value if value.abs() < 1000 => value.to_string(),
        value => format!("{}{mark}{:03}", value / 1000, value % 1000),
    };
    let fixed = |value: f64, mark: &str| format!("{value:.3}").replace('.', mark);
    let expected: Vec<[f64; 2]> = (0..40)
        .map(|k| 100 * k - 100)
        .map(|depth| [f64::from(depth) / 1000.0, f64::from(force(depth))])
        .collect();
    let nm = "Depth (nm);Load (uN)";
    let semicolons = |mark: &str| file(nm, &|z| [grouped(z, mark), grouped(force(z), mark)], ";");
    let quoted = |z| [grouped(z, ","), grouped(force(z), ",")].map(|cell| format!("\"{cell}\""));
    let um = "Depth (um);Load (uN)";
    let in_um = |z: i32| f64::from(z) / 1000.0;
    for text in [
        // From 900 to 1.000: a jump, unless they are thousands.
        semicolons(","),
        semicolons("."),
        file("\"Depth (nm)\",\"Load (uN)\"", &quoted, ","),
        // The other column has the other mark.
        file(
            nm,
            &|z| [grouped(z, "."), fixed(f64::from(force(z)), ",")],
            ";",
        ),
        file(
            nm,
            &|z| [grouped(z, ","), fixed(f64::from(force(z)), ".")],
            ";",
        ),
        // Three decimals, with a number below 1 or a whole number above 1000.
        file(
            um,
            &|z| [fixed(in_um(z), "."), fixed(f64::from(force(z)), ".")],
            ";",
        ),
        file(
            um,
            &|z| [fixed(in_um(z), ","), fixed(f64::from(force(z)), ",")],
            ";",
        ),
        file(um, &|z| [fixed(in_um(z), "."), force(z).to_string()], ";"),
        file(um, &|z| [fixed(in_um(z), ","), force(z).to_string()], ";"),
    ] {
        assert_eq!(values(&read(&text)), expected, "{text}");
    }
    let message = |text: &str| {
        let error = Measurements::from_csv("data", text.as_bytes(), &[]);
        error.unwrap_err().to_string()
    };
    // All depths are from 1000 on: nothing decides.
    let far = |z: i32| {
        [
            format!("\"{}\"", grouped(z + 20_800, ",")),
            (z / 10).to_string(),
        ]
    };
    let text = file("\"Depth (nm)\",\"Load (uN)\"", &far, ",");
    let error = message(&text);
    assert!(
        error.starts_with("data:2: Depth (nm): \"20,700\" may be 20.700 or 20700"),
        "{error}"
    );
    assert!(
        error.contains("displacement=\"Depth (nm)*1000\" if it is 20700"),
        "{error}"
    );
    let data = read_by_hand(&text, &["displacement=Depth (nm)*1000"], None);
    assert_eq!(values(&data)[..1], [[20.7, -10.0]]);
    let data = read_by_hand(&text, &["displacement=Depth (nm)"], None);
    assert_eq!(values(&data)[..1], [[0.0207, -10.0]]);
    // A curve of radii over loads.
    let error = message("Load (mN);Contact radius (nm)\n7;17,380\n8;18,120\n");
    assert!(
        error.starts_with("data:2: Contact radius (nm): \"17,380\" may be"),
        "{error}"
    );
    // Decimal commas in all numbers of a file with semicolons are usual; it is said.
    let data = read("Depth (um);Load (uN)\n1,071;1,019\n1,156;1,029\n");
    assert_eq!(values(&data), [[1.071, 1.019], [1.156, 1.029]]);
    assert!(lines(&data).contains("\"1,071\" in line 2 is read with a decimal comma"));
    // Points with three decimals are decimal points, also beside some whole numbers.
    for text in [
        "Depth (um),Load (uN)\n1.071,1.019\n1.156,1.029\n",
        "Depth (um),Load (uN)\n1.071,1.019\n2,3.500\n",
        "Time (s);Depth (um);Load (uN)\n1;1,071;1,019\n2;2,000;3,500\n",
    ] {
        assert_eq!(values(&read(text))[..1], [[1.071, 1.019]], "{text}");
    }
}
