//! Columns of numbers for the page: little-endian, compressed, in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// One column.
pub enum Packed {
    F64(Vec<f64>),
    /// Values that are shown to six digits only.
    F32(Vec<f32>),
    U32(Vec<u32>),
    /// Design indices, which a page shows to the last digit.
    U64(Vec<u64>),
}

impl Packed {
    pub fn kind(&self) -> &'static str {
        match self {
            Self::F64(_) => "f64",
            Self::F32(_) => "f32",
            Self::U32(_) => "u32",
            Self::U64(_) => "u64",
        }
    }

    pub fn bytes(&self) -> Vec<u8> {
        match self {
            Self::F64(values) => values.iter().flat_map(|it| it.to_le_bytes()).collect(),
            Self::F32(values) => values.iter().flat_map(|it| it.to_le_bytes()).collect(),
            Self::U32(values) => values.iter().flat_map(|it| it.to_le_bytes()).collect(),
            Self::U64(values) => values.iter().flat_map(|it| it.to_le_bytes()).collect(),
        }
    }
}

/// All parts, one after the other.
pub fn packed(parts: impl IntoIterator<Item = Vec<u8>>) -> String {
    const IN_MEMORY: &str = "writing into memory does not fail";
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    parts.into_iter().for_each(|part| encoder.write_all(&part).expect(IN_MEMORY));
    STANDARD.encode(encoder.finish().expect(IN_MEMORY))
}
