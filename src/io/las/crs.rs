//! The coordinate reference system of a file: records of the user `LASF_Projection` (LAS 1.4, section 3).

use super::header::{Header, all_records};
use crate::io::ReadReport;

const WKT: u16 = 2112;
const KEY_DIRECTORY: u16 = 34735;
const DOUBLES: u16 = 34736;
const ASCII: u16 = 34737;

/// A longer text is no coordinate reference system: a stream would have it before the first triangle.
const MAX_TEXT_BYTES: usize = u16::MAX as usize;

/// The records as pairs of a key and a text, each key once (`format/SPEC.md`, section 4.9).
pub(super) fn metadata(header: &Header, bytes: &[u8], report: &mut ReadReport) -> Vec<(String, String)> {
    let mut pairs: Vec<(String, String)> = Vec::new();
    for record in all_records(header, bytes).filter(|record| record.is_of(b"LASF_Projection")) {
        if record.is_cut {
            report.ignore(&format!("record {} of LASF_Projection, in which the file ends", record.id));
            continue;
        }
        let Some((key, text)) = described(record.id, record.data) else {
            report.ignore(&format!("record {} of LASF_Projection", record.id));
            continue;
        };
        if text.len() > MAX_TEXT_BYTES {
            report.ignore(&format!("{key} of {} bytes", text.len()));
        } else if !pairs.iter().any(|(known, _)| known == key) {
            pairs.push((key.to_owned(), text));
        }
    }
    pairs
}

fn described(id: u16, data: &[u8]) -> Option<(&'static str, String)> {
    Some(match id {
        WKT => ("crs.wkt", text(data)),
        KEY_DIRECTORY => ("crs.geokeys", joined(data, |bytes| u16::from_le_bytes(bytes).to_string())),
        DOUBLES => ("crs.geokeys.doubles", joined(data, |bytes| f64::from_le_bytes(bytes).to_string())),
        ASCII => ("crs.geokeys.ascii", text(data)),
        _ => return None,
    })
}

/// Texts may end in zeros.
fn text(data: &[u8]) -> String {
    let num_zeros = data.iter().rev().take_while(|&&byte| byte == 0).count();
    String::from_utf8_lossy(&data[..data.len() - num_zeros]).replace('\0', "\u{fffd}")
}

/// Numbers separated by blanks, no more of them than a text may have.
fn joined<const N: usize>(data: &[u8], written: impl Fn([u8; N]) -> String) -> String {
    let (numbers, _) = data.as_chunks::<N>();
    numbers.iter().take(MAX_TEXT_BYTES).map(|&number| written(number)).collect::<Vec<_>>().join(" ")
}
