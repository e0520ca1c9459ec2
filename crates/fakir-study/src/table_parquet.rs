//! A table as a Parquet file.

use crate::provenance::Provenance;
use crate::table::{Column, Table, Values};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

impl Table {
    /// As a Parquet file with its provenance as metadata. Needs the feature `parquet`.
    ///
    /// # Panics
    /// If columns have different lengths.
    #[must_use]
    pub fn to_parquet(&self, provenance: &Provenance) -> Vec<u8> {
        self.try_parquet(provenance)
            .expect("memory takes a table of columns of equal length")
    }

    fn try_parquet(&self, provenance: &Provenance) -> Result<Vec<u8>, ParquetError> {
        let fields = self.columns.iter().map(Column::parquet_type);
        let schema = Type::group_type_builder("fakir")
            .with_fields(fields.collect::<Result<_, _>>()?)
            .build()?;
        let pairs = provenance.attributes().into_iter();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(
                pairs
                    .map(|(name, text)| KeyValue::new(name.to_owned(), text))
                    .collect(),
            ))
            .build();
        let mut writer =
            SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for column in &self.columns {
            if let Some(mut writer) = group.next_column()? {
                column.values.write_parquet(&mut writer)?;
                writer.close()?;
            }
        }
        group.close()?;
        writer.into_inner()
    }
}

impl Values {
    fn write_parquet(&self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        match (self, writer.untyped()) {
            (Self::Numbers(values), ColumnWriter::DoubleColumnWriter(writer)) => {
                let (values, levels) = present(values);
                writer.write_batch(&values, Some(&levels), None)
            }
            (Self::Counts(values), ColumnWriter::Int64ColumnWriter(writer)) => {
                let (values, levels) = present(values);
                writer.write_batch(&values, Some(&levels), None)
            }
            (Self::Flags(values), ColumnWriter::BoolColumnWriter(writer)) => {
                let (values, levels) = present(values);
                writer.write_batch(&values, Some(&levels), None)
            }
            (Self::Words(values), ColumnWriter::ByteArrayColumnWriter(writer)) => {
                let (values, levels) = present(values);
                let values: Vec<ByteArray> = values
                    .iter()
                    .map(|word| ByteArray::from(word.as_str()))
                    .collect();
                writer.write_batch(&values, Some(&levels), None)
            }
            _ => unreachable!("columns are written with the types of the schema"),
        }
        .map(|_| ())
    }
}

/// The present values, and for every row whether it has one (definition levels of Parquet).
fn present<V: Clone>(values: &[Option<V>]) -> (Vec<V>, Vec<i16>) {
    let levels = values.iter().map(|value| i16::from(value.is_some()));
    (values.iter().flatten().cloned().collect(), levels.collect())
}

impl Column {
    fn parquet_type(&self) -> Result<TypePtr, ParquetError> {
        let (physical, logical) = match &self.values {
            Values::Numbers(_) => (Physical::DOUBLE, None),
            Values::Counts(_) => (Physical::INT64, None),
            Values::Flags(_) => (Physical::BOOLEAN, None),
            Values::Words(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let built = Type::primitive_type_builder(&self.name, physical)
            .with_logical_type(logical)
            .with_repetition(Repetition::OPTIONAL)
            .build()?;
        Ok(Arc::new(built))
    }
}
