//! A [`FieldMap`] as netCDF.

use super::{FieldMap, Values, Variable};
use crate::provenance::Provenance;
use netcdf3::error::{InvalidDataSet, WriteError};
use netcdf3::{DataSet, FileWriter, NC_FILL_F64, Version};
use std::cell::RefCell;
use std::io::{Cursor, Seek, SeekFrom, Write};
use std::rc::Rc;

/// The whole file.
pub(super) fn write(map: &FieldMap, provenance: &Provenance) -> Vec<u8> {
    let set = definition(map, provenance).expect("names and dimensions are valid");
    let memory = Memory::default();
    write_data(map, &set, memory.clone()).expect("memory takes every byte");
    memory.0.take().into_inner()
}

fn definition(map: &FieldMap, provenance: &Provenance) -> Result<DataSet, InvalidDataSet> {
    let mut set = DataSet::new();
    set.add_global_attr_string("Conventions", "CF-1.8")?;
    for (name, text) in provenance.attributes() {
        set.add_global_attr_string(name, &text)?;
    }
    set.add_global_attr_f64("force_N", vec![map.force])?;
    set.add_global_attr_f64("indentation_m", vec![map.indentation])?;
    let what = if map.around_axis {
        "distance from the lens axis"
    } else {
        "place"
    };
    for (name, axis) in [("y", map.y), ("x", map.x)] {
        let long_name = format!("{what} along {name}");
        set.add_fixed_dim(name, axis.count)?;
        set.add_var_f64(name, &[name])?;
        set.add_var_attr_string(name, "units", "m")?;
        set.add_var_attr_string(name, "long_name", &long_name)?;
        set.add_var_attr_string(name, "axis", name.to_uppercase())?;
    }
    for variable in &map.variables {
        define(&mut set, variable)?;
    }
    Ok(set)
}

fn define(set: &mut DataSet, variable: &Variable) -> Result<(), InvalidDataSet> {
    let name = variable.name;
    match &variable.values {
        Values::Numbers(unit, values) => {
            set.add_var_f64(name, &["y", "x"])?;
            set.add_var_attr_string(name, "units", unit)?;
            if !values.iter().all(|value| value.is_finite()) {
                set.add_var_attr_f64(name, "_FillValue", vec![NC_FILL_F64])?;
            }
        }
        // No flag_values: the library pads bytes in the header in a way that readers refuse.
        Values::Flags(_) => {
            set.add_var_i8(name, &["y", "x"])?;
        }
    }
    set.add_var_attr_string(name, "long_name", variable.long_name)?;
    set.add_var_attr_string(name, "comment", &variable.comment)?;
    Ok(())
}

fn write_data(map: &FieldMap, set: &DataSet, memory: Memory) -> Result<(), WriteError> {
    let mut writer = FileWriter::open_seek_write("fields.nc", Box::new(memory))?;
    writer.set_def(set, Version::Offset64Bit, 0)?;
    writer.write_var_f64("y", &map.y.coordinates())?;
    writer.write_var_f64("x", &map.x.coordinates())?;
    for variable in &map.variables {
        match &variable.values {
            Values::Numbers(_, values) => {
                let finite = |value: &f64| {
                    if value.is_finite() {
                        *value
                    } else {
                        NC_FILL_F64
                    }
                };
                let values: Vec<f64> = values.iter().map(finite).collect();
                writer.write_var_f64(variable.name, &values)?;
            }
            Values::Flags(flags) => writer.write_var_i8(variable.name, flags)?,
        }
    }
    writer.close()
}

/// Bytes that can be looked at after the writer, which owns what it writes to, is gone.
#[derive(Debug, Clone, Default)]
struct Memory(Rc<RefCell<Cursor<Vec<u8>>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Seek for Memory {
    fn seek(&mut self, position: SeekFrom) -> std::io::Result<u64> {
        self.0.borrow_mut().seek(position)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use netcdf3::FileReader;
    use std::io::Cursor;

    /// The values of a variable, as the library reads them.
    pub(in crate::fields) fn numbers(contents: &[u8], name: &str) -> Vec<f64> {
        let input = Box::new(Cursor::new(contents.to_vec()));
        let mut reader = FileReader::open_seek_read("fields.nc", input).unwrap();
        assert_eq!(
            reader
                .data_set()
                .get_global_attr_as_string("Conventions")
                .unwrap(),
            "CF-1.8"
        );
        reader.read_var_f64(name).unwrap()
    }
}
