//! Archives of NumPy arrays (`.npz`): ZIP files of `.npy` files, stored or deflated.

use flate2::bufread::DeflateDecoder;
use rawzip::{
    CompressionMethod, FileReader, RECOMMENDED_BUFFER_SIZE, ZipArchive, ZipArchiveEntryWayfinder,
};
use std::fs::File;
use std::io::{BufReader, Read};

/// An archive and the arrays in it.
pub(crate) struct Archive {
    archive: ZipArchive<FileReader>,
    pub(crate) arrays: Vec<PackedArray>,
}

/// An array of an archive.
pub(crate) struct PackedArray {
    /// Name, without `.npy`.
    pub(crate) name: String,
    place: ZipArchiveEntryWayfinder,
    method: CompressionMethod,
    is_encrypted: bool,
}

impl Archive {
    /// Lists the arrays of an archive.
    pub(crate) fn open(file: File) -> Result<Self, rawzip::Error> {
        let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
        let archive = ZipArchive::from_file(file, &mut buffer)?;
        let mut arrays = Vec::new();
        let mut entries = archive.entries(&mut buffer);
        while let Some(entry) = entries.next_entry()? {
            let path = entry.file_path();
            let name = std::str::from_utf8(path.as_bytes());
            if let Some(name) = name.ok().and_then(|name| name.strip_suffix(".npy")) {
                arrays.push(PackedArray {
                    name: name.to_owned(),
                    place: entry.wayfinder(),
                    method: entry.compression_method(),
                    is_encrypted: entry.flags().is_encrypted(),
                });
            }
        }
        Ok(Self { archive, arrays })
    }

    /// The `.npy` file of an array, unpacked while it is read. At its end, length and checksum are compared with
    /// those in the archive.
    ///
    /// # Errors
    /// A description of the error.
    pub(crate) fn unpacked(&self, array: &PackedArray) -> Result<Box<dyn Read + '_>, String> {
        if array.is_encrypted {
            return Err("it is encrypted: only arrays without a password are read".to_owned());
        }
        let entry = self.archive.get_entry(array.place);
        let entry = entry.map_err(|error| error.to_string())?;
        let packed = BufReader::new(entry.reader());
        match array.method {
            CompressionMethod::STORE => Ok(Box::new(entry.verifying_reader(packed))),
            CompressionMethod::DEFLATE => Ok(Box::new(
                entry.verifying_reader(DeflateDecoder::new(packed)),
            )),
            _ => Err(format!(
                "it is packed by method {} of the ZIP format: stored and deflated arrays are read",
                array.method.as_u16()
            )),
        }
    }
}
