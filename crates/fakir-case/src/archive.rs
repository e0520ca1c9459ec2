//! ZIP archives in memory: the members of an XLSX or X3P file.

use crate::input;
use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive};

/// Unpacks a member of an archive by its name. `None` if there is no such member.
///
/// # Errors
/// A description of what is wrong with the archive, or that the member has more than `most` bytes.
pub(crate) fn member(bytes: &[u8], name: &str, most: u64) -> Result<Option<Vec<u8>>, String> {
    let words = |error: rawzip::Error| format!("the ZIP archive is damaged: {error}");
    let archive = ZipArchive::from_slice(bytes).map_err(words)?;
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(words)? {
        if entry.file_path().as_bytes() != name.as_bytes() {
            continue;
        }
        if entry.flags().is_encrypted() {
            return Err(format!("{name} is encrypted: save it without a password"));
        }
        let method = entry.compression_method();
        let packed = archive.get_entry(entry.wayfinder()).map_err(words)?;
        let unpacked = match method {
            CompressionMethod::STORE => {
                input::read_all(packed.verifying_reader(packed.data()), most)
            }
            CompressionMethod::DEFLATE => {
                let unpacker = DeflateDecoder::new(packed.data());
                input::read_all(packed.verifying_reader(unpacker), most)
            }
            _ => {
                return Err(format!(
                    "{name} is packed by method {} of the ZIP format: stored and deflated members are read",
                    method.as_u16()
                ));
            }
        };
        return unpacked
            .map(Some)
            .map_err(|error| format!("{name}: {error}"));
    }
    Ok(None)
}

/// Names of the members of an archive; none if it is damaged.
pub(crate) fn names(bytes: &[u8]) -> Vec<String> {
    let Ok(archive) = ZipArchive::from_slice(bytes) else {
        return Vec::new();
    };
    let mut names = Vec::new();
    let mut entries = archive.entries();
    while let Ok(Some(entry)) = entries.next_entry() {
        names.push(String::from_utf8_lossy(entry.file_path().as_bytes()).into_owned());
    }
    names
}
