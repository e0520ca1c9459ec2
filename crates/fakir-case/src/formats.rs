//! Formats that are recognised by their first bytes or by the name of the file, and are not read.

use crate::archive;
use std::path::Path;

/// A recognised format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Format {
    /// What the file is: `"a Gwyddion file"`.
    pub(crate) name: &'static str,
    /// What converts its curves or tables into text.
    table: &'static str,
    /// What converts its heights.
    pub(crate) heights: &'static str,
}

const GWYDDION: &str = "open it in Gwyddion and save it as text (ASCII data matrix)";
const NANOSCOPE: &str = "export it as text (ASCII) in NanoScope Analysis";
pub(crate) const EXPORT: &str =
    "export it as a matrix of numbers in text, or as an array of NumPy (.npy)";
const TOPOGRAPHY: &str = "read it with SurfaceTopography in Python: fakir.bem.Surface accepts its objects, and to_x3p converts them";
const CURVES: &str =
    "the Python package afmformats reads it: fakir.fit accepts its curves, or save them as text";
const TEXT: &str = "export it as text (CSV) from the program that wrote it";
const SMALL_TIFF: &str =
    "save it as TIFF with offsets of 32 bits (tifffile.imwrite with bigtiff=False)";
const NO_TABLE: &str = "give a table in text (CSV) or a spreadsheet (.xlsx)";

const fn format(name: &'static str, table: &'static str, heights: &'static str) -> Format {
    Format {
        name,
        table,
        heights,
    }
}

const NETCDF: Format = format(
    "a NetCDF file",
    "open it with xarray in Python: fakir.fit accepts its datasets",
    TOPOGRAPHY,
);

/// Formats by their first bytes.
const BY_BYTES: [(&[u8], Format); 33] = [
    (b"GWYP", format("a Gwyddion file", GWYDDION, GWYDDION)),
    (b"GWYO", format("a Gwyddion file", GWYDDION, GWYDDION)),
    (
        b"\\*File list",
        format("a NanoScope file", NANOSCOPE, GWYDDION),
    ),
    (
        b"\\*Force file list",
        format("a NanoScope force file", NANOSCOPE, GWYDDION),
    ),
    (
        b"\x93NUMPY",
        format(
            "a NumPy array",
            "save it as text with numpy.savetxt, or give its columns to fakir.fit in Python",
            EXPORT,
        ),
    ),
    (b"CDF\x01", NETCDF),
    (b"CDF\x02", NETCDF),
    (b"CDF\x05", NETCDF),
    (
        b"ARROW1",
        format(
            "a Feather file",
            "convert it with pandas: pandas.read_feather(\"FILE\").to_csv(\"FILE.csv\"), or give the table to fakir.fit in Python",
            EXPORT,
        ),
    ),
    (
        b"AliconaImaging\0",
        format("an Alicona file", NO_TABLE, GWYDDION),
    ),
    (
        b"\x89HDF",
        format(
            "an HDF5 file",
            "convert it with h5py or pandas in Python: fakir.fit accepts a dictionary of arrays; curves of AFMs are read by the Python package afmformats",
            TOPOGRAPHY,
        ),
    ),
    (
        b"MATLAB",
        format(
            "a MATLAB file",
            "save it as text with writematrix in MATLAB, or read it with scipy.io.loadmat in Python",
            "save it as text with writematrix in MATLAB, or as an array of NumPy (.npy)",
        ),
    ),
    (
        b"DIGITAL SURF",
        format("a Digital Surf file", NO_TABLE, GWYDDION),
    ),
    (
        b"DSCOMPRESSED",
        format("a Digital Surf file", NO_TABLE, GWYDDION),
    ),
    (
        b"Wyko ASCII Data File Format",
        format("a text of Wyko or Vision", NO_TABLE, GWYDDION),
    ),
    (b"DSAA", format("a Surfer grid", NO_TABLE, GWYDDION)),
    (b"DSBB", format("a Surfer grid", NO_TABLE, GWYDDION)),
    (b"DSRB", format("a Surfer grid", NO_TABLE, GWYDDION)),
    (b"bISO", format("an SDF file", NO_TABLE, EXPORT)),
    (
        b"\xff\xd8\xff",
        format(
            "a JPEG image",
            NO_TABLE,
            "JPEG changes the values of pixels: export the heights as 16-bit PNG or TIFF, or as text",
        ),
    ),
    (b"\x89PNG", format("a PNG image", NO_TABLE, EXPORT)),
    (b"II*\0", format("a TIFF image", NO_TABLE, EXPORT)),
    (b"MM\0*", format("a TIFF image", NO_TABLE, EXPORT)),
    (b"II+\0", format("a BigTIFF image", NO_TABLE, SMALL_TIFF)),
    (b"MM\0+", format("a BigTIFF image", NO_TABLE, SMALL_TIFF)),
    (b"GIF8", format("a GIF image", NO_TABLE, EXPORT)),
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        format(
            "an Excel file of the old format (.xls) or another compound file",
            "save it as .xlsx or as CSV in Excel or LibreOffice",
            EXPORT,
        ),
    ),
    (
        b"PAR1",
        format(
            "a Parquet file",
            "convert it with pandas: pandas.read_parquet(\"FILE\").to_csv(\"FILE.csv\"), or give the table to fakir.fit in Python",
            EXPORT,
        ),
    ),
    (
        b"TDSm",
        format(
            "a TDMS file of LabVIEW",
            "convert it with the Python package npTDMS, or save it as text in LabVIEW or DIAdem",
            EXPORT,
        ),
    ),
    (b"%PDF", format("a PDF file", TEXT, EXPORT)),
    (
        b"BZh",
        format(
            "packed by bzip2",
            "unpack it with bunzip2",
            "unpack it with bunzip2",
        ),
    ),
    (
        b"\x28\xb5\x2f\xfd",
        format(
            "packed by zstd",
            "unpack it with unzstd",
            "unpack it with unzstd",
        ),
    ),
    (
        b"\xfd7zXZ",
        format("packed by xz", "unpack it with unxz", "unpack it with unxz"),
    ),
];

const NANOSURF: Format = format(
    "a Nanosurf file",
    "export it as text in the software of Nanosurf",
    GWYDDION,
);

const AGILENT: Format = format("a file of Agilent or Molecular Imaging", NO_TABLE, GWYDDION);

const WSXM: Format = format("a WSxM file", "export it as text (ASCII) in WSxM", GWYDDION);

/// Formats whose first lines are text, by a part of them and the end of the name of the file.
const BY_FIRST_LINES: [(&str, &str, Format); 3] = [
    (".nid", "[DataSet]", NANOSURF),
    (".mi", "fileType", AGILENT),
    ("", "Image header size:", WSXM),
];

/// Formats by the ends of names, for files that are not text.
const BY_NAME: [(&str, Format); 10] = [
    (".ibw", format("an Igor binary wave", CURVES, GWYDDION)),
    (
        ".pxp",
        format(
            "an Igor experiment",
            "save the waves as text in Igor Pro",
            GWYDDION,
        ),
    ),
    (".nid", NANOSURF),
    (".mi", AGILENT),
    (".stp", WSXM),
    (".spm", format("a NanoScope file", NANOSCOPE, GWYDDION)),
    (
        ".tdms",
        format(
            "a TDMS file of LabVIEW",
            "convert it with the Python package npTDMS",
            EXPORT,
        ),
    ),
    (
        ".is_tens",
        format(
            "a Bluehill file",
            "export raw data as CSV in Bluehill",
            EXPORT,
        ),
    ),
    (
        ".zs2",
        format(
            "a testXpert file",
            "export raw data as text (ASCII) in testXpert",
            EXPORT,
        ),
    ),
    (
        ".tri",
        format(
            "a TRIOS file",
            "export it as text or .xlsx in TRIOS",
            EXPORT,
        ),
    ),
];

/// Formats that are ZIP archives, by the beginning of the name of a member.
const BY_MEMBER: [(&str, Format); 6] = [
    ("xl/workbook.xml", SPREADSHEET),
    (
        "header.properties",
        format(
            "a JPK file",
            "export it as text in JPK Data Processing; or the Python package afmformats reads it, and fakir.fit accepts its curves",
            GWYDDION,
        ),
    ),
    (
        "content.xml",
        format(
            "an OpenDocument spreadsheet",
            "save it as .xlsx or as CSV in LibreOffice",
            EXPORT,
        ),
    ),
    ("word/", format("a Word document", TEXT, EXPORT)),
    (
        "xl/workbook.bin",
        format(
            "an Excel file of the binary format (.xlsb)",
            "save it as .xlsx or as CSV in Excel",
            EXPORT,
        ),
    ),
    ("main.xml", format("an X3P file", NO_TABLE, EXPORT)),
];

const ARRAYS: Format = format(
    "an archive of NumPy arrays (.npz)",
    "give its arrays to fakir.fit in Python: fakir.fit(numpy.load(\"FILE\"), ...)",
    EXPORT,
);

const SPREADSHEET: Format = format("a spreadsheet (.xlsx)", "", EXPORT);

const ZIP: Format = format("a ZIP archive", "unpack it first", EXPORT);

/// Number of bytes in which texts of formats are searched.
const FIRST_LINES: usize = 256;

/// The format of a file that is not read as text, by its first bytes, the members of an archive, and its name.
pub(crate) fn recognised(path: &Path, bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"PK\x03\x04") {
        let names = archive::names(bytes);
        let has = |start: &str| names.iter().any(|name| name.starts_with(start));
        if !names.is_empty() && names.iter().all(|name| name.ends_with(".npy")) {
            return Some(ARRAYS);
        }
        let found = BY_MEMBER.iter().find(|(member, _)| has(member));
        return Some(found.map_or(ZIP, |(_, format)| *format));
    }
    let by_bytes = BY_BYTES.iter().find(|(start, _)| bytes.starts_with(start));
    if let Some((_, format)) = by_bytes {
        return Some(*format);
    }
    let name = path.to_string_lossy().to_ascii_lowercase();
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(FIRST_LINES)]);
    let mut by_lines = BY_FIRST_LINES.iter();
    if let Some((_, _, format)) =
        by_lines.find(|(end, part, _)| name.ends_with(end) && start.contains(part))
    {
        return Some(*format);
    }
    let is_wide = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    if is_wide || !bytes.contains(&0) {
        return None;
    }
    let by_name = BY_NAME.iter().find(|(end, _)| name.ends_with(end));
    by_name.map(|(_, format)| *format)
}

impl Format {
    /// Whether it is a spreadsheet, whose tables are read.
    pub(crate) fn is_spreadsheet(self) -> bool {
        self == SPREADSHEET
    }

    /// That a table is not read from it, and what converts it.
    pub(crate) fn no_table(self) -> String {
        format!("it is {}, which is not read: {}", self.name, self.table)
    }
}
