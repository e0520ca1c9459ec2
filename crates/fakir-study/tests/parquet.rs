//! The table of a sweep as a Parquet file, read back by the reader of another library.

#![allow(clippy::unwrap_used)]

use bytes::Bytes;
use fakir_case::{Case, Study, StudyFile};
use fakir_study::provenance::Provenance;
use fakir_study::{Existing, Options, TABLES, Table, sweep, sweep_into};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::{Value, json};

/// A case that is too large for the lens among valid ones.
fn study() -> Study {
    let tables = "[study]\nquestion = \"press\"\n[axes]\nindentation = [\"1 um\", \"1 mm\", \"2 um\"]\n\
         \"method.name\" = [\"homogenised\", \"punch\"]";
    let text = format!("{tables}\n{}", Case::example().to_toml());
    let file = StudyFile::parse("study.toml", &text).unwrap();
    file.study().unwrap()
}

/// The rows of a file as JSON objects.
fn records(reader: &SerializedFileReader<Bytes>) -> Value {
    let value = |field: &Field| match field {
        Field::Null => Value::Null,
        Field::Bool(value) => json!(value),
        Field::Long(value) => json!(value),
        Field::Double(value) => json!(value),
        Field::Str(value) => json!(value),
        other => panic!("{other}"),
    };
    let records = reader.get_row_iter(None).unwrap().map(|row| {
        let row = row.unwrap();
        let cells = row.get_column_iter();
        Value::Object(
            cells
                .map(|(name, field)| (name.clone(), value(field)))
                .collect(),
        )
    });
    Value::Array(records.collect())
}

/// A value of the metadata of a file.
fn metadata(reader: &SerializedFileReader<Bytes>, name: &str) -> String {
    let metadata = reader.metadata().file_metadata();
    let mut pairs = metadata.key_value_metadata().unwrap().iter();
    let pair = pairs.find(|pair| pair.key == name).unwrap();
    pair.value.clone().unwrap()
}

/// Columns, their order, values, empty cells and provenance.
#[test]
fn the_parquet_table_agrees_with_the_csv_table() {
    let study = study();
    let rows = sweep(&study, &mut Options::default()).unwrap();
    let table = Table::new(&study, &rows);
    let bytes = table.to_parquet(&Provenance::of_study(&study));
    let reader = SerializedFileReader::new(Bytes::from(bytes)).unwrap();
    assert!(metadata(&reader, "references").contains("10.1103/PhysRevE.104.055007"));
    assert_eq!(metadata(&reader, "case"), study.to_toml());
    assert_eq!(records(&reader), table.to_json());
    let schema = reader.metadata().file_metadata().schema_descr();
    let names: Vec<&str> = schema
        .columns()
        .iter()
        .map(|column| column.name())
        .collect();
    let csv = table.to_csv();
    assert_eq!(names.join(","), csv.lines().next().unwrap());
    // The numbers of the CSV file equal those of the Parquet file to the last bit.
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    for (line, record) in lines.records().zip(records(&reader).as_array().unwrap()) {
        for (cell, name) in line.unwrap().iter().zip(&names) {
            match &record[*name] {
                Value::Null => assert_eq!(cell, "", "{name}"),
                Value::Number(number) => {
                    assert_eq!(cell.parse::<f64>().ok(), number.as_f64(), "{name}");
                }
                Value::Bool(flag) => assert_eq!(cell, flag.to_string(), "{name}"),
                Value::String(word) => assert_eq!(cell, word, "{name}"),
                other => panic!("{name}: {other}"),
            }
        }
    }
}

/// A sweep saves both tables, lists them in its provenance, and replaces them with `--overwrite`.
#[test]
fn a_sweep_saves_the_parquet_table_in_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("results");
    let study = study();
    assert_eq!(TABLES, ["table.csv", "table.parquet"]);
    for existing in [Existing::Refuse, Existing::Overwrite] {
        sweep_into(&study, &folder, existing, &mut Options::default()).unwrap();
        let bytes = std::fs::read(folder.join("table.parquet")).unwrap();
        let reader = SerializedFileReader::new(Bytes::from(bytes)).unwrap();
        let provenance = Provenance::read(&folder.join("provenance.json")).unwrap();
        assert_eq!(metadata(&reader, "case"), provenance.case);
        assert_eq!(provenance.reference_doi, "10.1103/PhysRevE.104.055007");
        for name in TABLES {
            assert!(provenance.files.iter().any(|file| file == name), "{name}");
        }
    }
}
