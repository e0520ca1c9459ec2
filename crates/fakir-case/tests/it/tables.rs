//! Tables in compressed files and spreadsheets, and formats that are recognised.

use fakir_case::input::LARGEST_TABLE;
use fakir_case::table_text::read_table;
use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder};
use rawzip::{CompressionMethod, ZipArchiveWriter};
use std::io::Write;

/// A ZIP archive with deflated members.
pub(crate) fn zip(members: &[(&str, &[u8])]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    for (name, content) in members {
        let new = archive.new_file(name);
        let (mut entry, config) = new
            .compression_method(CompressionMethod::DEFLATE)
            .start()
            .unwrap();
        let encoder = DeflateEncoder::new(&mut entry, Compression::default());
        let mut writer = config.wrap(encoder);
        writer.write_all(content).unwrap();
        let (encoder, descriptor) = writer.finish().unwrap();
        encoder.finish().unwrap();
        entry.finish(descriptor).unwrap();
    }
    archive.finish().unwrap();
    bytes
}

fn read(name: &str, content: &[u8]) -> Result<String, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    let read = read_table(&path, LARGEST_TABLE);
    read.map(|bytes| String::from_utf8(bytes).unwrap())
        .map_err(|error| error.to_string())
}

#[test]
fn packed_tables_and_spreadsheets_are_text() {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    packer.write_all(b"z_um,force_uN\n1,2\n").unwrap();
    let packed = packer.finish().unwrap();
    assert_eq!(
        read("data.csv.gz", &packed).unwrap(),
        "z_um,force_uN\n1,2\n"
    );
    let cell = |text: &str| format!("<c t=\"inlineStr\"><is><t>{text}</t></is></c>");
    let sheet = format!(
        "<worksheet><sheetData><row r=\"1\">{}{}</row><row r=\"3\"><c><v>1.5</v></c><c r=\"B3\"><f>A3</f><v>2</v></c></row></sheetData></worksheet>",
        cell("z [um]"),
        cell("Load [&#181;N]")
    );
    let workbook = "<workbook><sheets><sheet name=\"empty\" r:id=\"r1\"/><sheet name=\"data\" r:id=\"r2\"/></sheets></workbook>";
    let relations = "<Relationships><Relationship Id=\"r1\" Target=\"worksheets/sheet1.xml\"/><Relationship Id=\"r2\" Target=\"/xl/worksheets/sheet2.xml\"/></Relationships>";
    let book = zip(&[
        ("[Content_Types].xml", b"<Types/>"),
        ("xl/workbook.xml", workbook.as_bytes()),
        ("xl/_rels/workbook.xml.rels", relations.as_bytes()),
        (
            "xl/worksheets/sheet1.xml",
            b"<worksheet><sheetData/></worksheet>",
        ),
        ("xl/worksheets/sheet2.xml", sheet.as_bytes()),
    ]);
    assert_eq!(
        read("data.xlsx", &book).unwrap(),
        "z [um]\tLoad [\u{b5}N]\n\n1.5\t2\n"
    );
}

#[test]
fn one_of_several_sheets() {
    let sheet = |rows: &[[f64; 2]]| {
        let rows = rows
            .iter()
            .map(|[a, b]| format!("<row><c><v>{a}</v></c><c><v>{b}</v></c></row>"));
        let rows: String = rows.collect();
        format!("<worksheet><sheetData>{rows}</sheetData></worksheet>")
    };
    let book = |sheets: &[(&str, &[[f64; 2]])]| {
        let number = |place: usize| format!("xl/worksheets/sheet{place}.xml");
        let (mut names, mut relations) = (String::new(), String::new());
        let mut members = Vec::new();
        for (place, (name, rows)) in sheets.iter().enumerate() {
            names += &format!("<sheet name=\"{name}\" r:id=\"r{place}\"/>");
            relations += &format!(
                "<Relationship Id=\"r{place}\" Target=\"/{}\"/>",
                number(place)
            );
            members.push((number(place), sheet(rows)));
        }
        members.push((
            "xl/workbook.xml".to_owned(),
            format!("<workbook>{names}</workbook>"),
        ));
        members.push(("xl/_rels/workbook.xml.rels".to_owned(), relations));
        let members = members.iter();
        let members = members.map(|(name, content)| (&name[..], content.as_bytes()));
        zip(&members.collect::<Vec<_>>())
    };
    let curve = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
    // The results of the specimens are on a sheet before their curves.
    let results = book(&[("Results", &[[7.0, 8.0]]), ("Specimen 1", &curve)]);
    assert_eq!(read("a.xlsx", &results).unwrap(), "1\t2\n3\t4\n5\t6\n");
    let both = book(&[("Specimen 1", &curve[..2]), ("Specimen 2", &curve)]);
    assert_eq!(
        read("a.xlsx", &both).unwrap_err(),
        "it has 2 sheets with tables, \"Specimen 1\", \"Specimen 2\": name one of them after the file, as \"FILE.xlsx#Specimen 1\""
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xlsx");
    std::fs::write(&path, &both).unwrap();
    let of_sheet = |name: &str| {
        let named = folder.path().join(format!("a.xlsx#{name}"));
        read_table(&named, LARGEST_TABLE).map_err(|error| error.to_string())
    };
    assert_eq!(of_sheet("Specimen 1").unwrap(), b"1\t2\n3\t4\n");
    assert_eq!(
        of_sheet("Specimen 3").unwrap_err(),
        "it has no sheet \"Specimen 3\"; there are \"Specimen 1\", \"Specimen 2\""
    );
}

#[test]
fn formats_that_are_not_read_name_what_converts_them() {
    let book = |member: &str| zip(&[(member, b"<a/>")]);
    for (name, content, words) in [
        (
            "a.jpk-force",
            book("header.properties"),
            "a JPK file, which is not read: export it as text in JPK Data Processing",
        ),
        (
            "a.ods",
            book("content.xml"),
            "save it as .xlsx or as CSV in LibreOffice",
        ),
        (
            "a.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".to_vec(),
            "save it as .xlsx or as CSV",
        ),
        (
            "a.h5",
            b"\x89HDF\r\n".to_vec(),
            "convert it with h5py or pandas",
        ),
        (
            "a.ibw",
            b"\x05\0\0\0".to_vec(),
            "an Igor binary wave, which is not read: the Python package afmformats",
        ),
        ("a.tdms", b"TDSm".to_vec(), "npTDMS"),
        (
            "a.000",
            b"\\*Force file list\r\n".to_vec(),
            "NanoScope Analysis",
        ),
    ] {
        let problem = read(name, &content).unwrap_err();
        assert!(problem.contains(words), "{name}: {problem}");
    }
    let broken = zip(&[("xl/workbook.xml", b"<workbook/>")]);
    assert_eq!(
        read("a.xlsx", &broken).unwrap_err(),
        "no sheet has any cells"
    );
}
