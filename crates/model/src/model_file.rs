//! A model as bytes: one header line, then JSON.
//!
//! `maveric-model <version> <bytes after this line> <FNV-1a 64 of them, hexadecimal>\n`, then the model with every
//! number written so that it reads back to the same bits. Reading and writing files is the caller's.

use crate::{error::ModelError, model::Model};

/// Version of the format; a file of another one is refused.
pub const VERSION: u32 = 5;

const MAGIC: &str = "maveric-model";
/// The header is shorter than this.
const HEADER_LIMIT: usize = 128;

/// FNV-1a: one changed byte always changes it, since every step is a bijection.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// The model as bytes; equal models give equal bytes.
///
/// # Errors
/// [`ModelError::BadModelFile`] if the model cannot be written, which no model that exists should cause.
pub fn to_bytes(model: &Model) -> Result<Vec<u8>, ModelError> {
    let body = serde_json::to_vec(model).map_err(|e| ModelError::bad_file(e.to_string()))?;
    let header = format!("{MAGIC} {VERSION} {} {:016x}\n", body.len(), checksum(&body));
    Ok([header.as_bytes(), &body].concat())
}

/// The model that [`to_bytes`] wrote.
///
/// # Errors
/// [`ModelError::NotAModelFile`], [`ModelError::OtherVersion`], [`ModelError::WrongLength`],
/// [`ModelError::Damaged`] or [`ModelError::BadModelFile`].
pub fn from_bytes(bytes: &[u8]) -> Result<Model, ModelError> {
    let newline = bytes.iter().take(HEADER_LIMIT).position(|&b| b == b'\n');
    let end = newline.ok_or(ModelError::NotAModelFile)?;
    let header = std::str::from_utf8(&bytes[..end]).map_err(|_| ModelError::NotAModelFile)?;
    let words: Vec<&str> = header.split(' ').collect();
    let [first, version, rest @ ..] = words.as_slice() else {
        return Err(ModelError::NotAModelFile);
    };
    let version: u32 = match version.parse() {
        Ok(version) if *first == MAGIC => version,
        _ => return Err(ModelError::NotAModelFile),
    };
    if version != VERSION {
        return Err(ModelError::OtherVersion { found: version, expected: VERSION });
    }
    let [length, sum] = rest else {
        return Err(ModelError::NotAModelFile);
    };
    let expected: usize = length.parse().map_err(|_| ModelError::NotAModelFile)?;
    let body = &bytes[end + 1..];
    if body.len() != expected {
        return Err(ModelError::WrongLength { found: body.len(), expected });
    }
    let expected = u64::from_str_radix(sum, 16).map_err(|_| ModelError::NotAModelFile)?;
    let computed = checksum(body);
    if computed != expected {
        return Err(ModelError::Damaged { found: computed, expected });
    }
    serde_json::from_slice(body).map_err(|e| ModelError::bad_file(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        heads_kind::HeadsKind, params::TrainSettings, test_drives::drivers, train::tests::trained,
    };

    fn model() -> Model {
        let drives = drivers(2, 40.0);
        let settings = TrainSettings {
            epochs: 1,
            heads: HeadsKind::Paper,
            hidden_units: 6,
            encoder_units: 5,
            ..TrainSettings::default()
        };
        trained(&drives, &settings)
    }

    #[test]
    fn a_model_survives_its_bytes() {
        let model = model();
        let bytes = to_bytes(&model).unwrap();
        let again = from_bytes(&bytes).unwrap();
        assert_eq!(again, model);
        assert_eq!(to_bytes(&again).unwrap(), bytes);
    }

    #[test]
    fn damage_is_noticed_wherever_it_is() {
        let bytes = to_bytes(&model()).unwrap();
        for at in (0..bytes.len()).step_by(97).chain(0..40) {
            let mut bad = bytes.clone();
            bad[at] ^= 0x04;
            assert!(from_bytes(&bad).is_err(), "byte {at}");
            assert!(from_bytes(&bytes[..at]).is_err(), "cut at {at}");
        }
        let text = String::from_utf8(bytes.clone()).unwrap();
        let other = text.replacen("maveric-model 5 ", "maveric-model 1 ", 1);
        assert!(matches!(
            from_bytes(other.as_bytes()),
            Err(ModelError::OtherVersion { found: 1, .. })
        ));
        let end = bytes.len() - 1;
        assert!(matches!(from_bytes(&bytes[..end]), Err(ModelError::WrongLength { .. })));
        let mut bad = bytes.clone();
        bad[end] ^= 1;
        assert!(matches!(from_bytes(&bad), Err(ModelError::Damaged { .. })));
        assert!(matches!(from_bytes(b"PK\x03\x04"), Err(ModelError::NotAModelFile)));
    }

    #[test]
    fn a_file_that_contradicts_itself_is_refused() {
        let bytes = to_bytes(&model()).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let (_, body) = text.split_once('\n').unwrap();
        let body = body.replacen("\"hidden_units\":6", "\"hidden_units\":7", 1);
        let header =
            format!("{MAGIC} {VERSION} {} {:016x}\n", body.len(), checksum(body.as_bytes()));
        let error = from_bytes(format!("{header}{body}").as_bytes()).unwrap_err();
        assert!(error.to_string().contains("sizes"), "{error}");
    }
}
