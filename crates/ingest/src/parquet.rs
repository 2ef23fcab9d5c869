//! Parquet with a checksum over the whole file: the one place where it is written and read.

use maveric_bag::caught;
use polars::prelude::{
    ArrowDataType, DataFrame, KeyValueMetadata, ParallelStrategy, ParquetCompression,
    ParquetReader, ParquetWriter, SerReader,
};
use std::io::Cursor;

/// How Parquet begins, and ends.
const MAGIC: &[u8] = b"PAR1";
/// The entry of a file's own metadata that holds its checksum.
const CHECKSUM: &str = "maveric.checksum";
/// How the checksum's text begins.
const BLAKE3: &str = "blake3:";
/// Length of the checksum itself, in hexadecimal digits.
const DIGITS: usize = 64;

/// Cells that any file may hold; a larger file may hold [`CELLS_PER_BYTE`] for each of its bytes on top. A few bytes can announce
/// any number of equal cells, and all of them would have to be in memory.
const MOST_CELLS: u64 = 100_000_000;
/// Numbers that differ take more than a byte each, packed as well as they can be.
const CELLS_PER_BYTE: u64 = 16;

/// What was read from Parquet.
#[derive(Debug, Clone)]
pub struct ParquetFile {
    /// The columns that were wanted.
    pub frame: DataFrame,
    /// The file's own metadata, in its order, without the checksum.
    pub metadata: Vec<(String, String)>,
    /// Whether the file carries a checksum; if so it fits.
    pub checked: bool,
}

/// Whether bytes begin as Parquet does.
pub fn is_parquet(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Writes a data frame with named texts, and a BLAKE3 checksum over every other byte of the file. The same frame and texts
/// give the same bytes.
///
/// # Errors
/// What polars says of the frame.
pub fn parquet_bytes(
    frame: &mut DataFrame,
    mut metadata: Vec<(String, String)>,
) -> Result<Vec<u8>, String> {
    let blank = format!("{BLAKE3}{}", "0".repeat(DIGITS));
    metadata.push((CHECKSUM.to_owned(), blank));
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .with_compression(ParquetCompression::Zstd(None))
        .with_key_value_metadata(Some(KeyValueMetadata::from_static(metadata)))
        .set_parallel(false)
        .finish(frame)
        .map_err(|e| e.to_string())?;
    let start = checksum_at(&bytes).ok_or("its checksum has no place in the file")?;
    let sum = blake3::hash(&bytes).to_hex();
    bytes[start..start + DIGITS].copy_from_slice(sum.as_bytes());
    Ok(bytes)
}

/// Where the digits of the checksum stand: behind their key, the marks of the next text, and its beginning.
fn checksum_at(bytes: &[u8]) -> Option<usize> {
    let mut mark = CHECKSUM.as_bytes().to_vec();
    // A text in the compact protocol: field 1 behind the last, then its length.
    mark.extend([0x18, (BLAKE3.len() + DIGITS) as u8]);
    mark.extend(BLAKE3.as_bytes());
    let last = bytes.len().checked_sub(mark.len() + DIGITS)?;
    let start = (0..=last).rev().find(|&i| bytes[i..].starts_with(&mark))?;
    Some(start + mark.len())
}

/// Holds bytes against the checksum that they carry; false where they carry none.
///
/// # Errors
/// A sentence, where it does not fit.
fn checked(bytes: &[u8]) -> Result<bool, String> {
    let Some(at) = checksum_at(bytes) else {
        return Ok(false);
    };
    let (before, rest) = bytes.split_at(at);
    let (claimed, after) = rest.split_at(DIGITS);
    let mut hasher = blake3::Hasher::new();
    hasher.update(before).update(&[b'0'; DIGITS]).update(after);
    if hasher.finalize().to_hex().as_bytes() == claimed {
        Ok(true)
    } else {
        Err("its checksum does not match: it was changed or damaged after it was written"
            .to_owned())
    }
}

/// Reads Parquet: its checksum first, where it carries one; then `columns`, or all that hold numbers, words, times, or yes and no.
///
/// # Errors
/// A sentence, where the bytes are damaged or no Parquet; polars' own panics on damaged files among them.
pub fn read_parquet(bytes: Vec<u8>, columns: Option<&[String]>) -> Result<ParquetFile, String> {
    if !is_parquet(&bytes) {
        return Err("it does not start with PAR1".to_owned());
    }
    if bytes.len() < 12 || !bytes.ends_with(MAGIC) {
        return Err("it does not end with PAR1: its end is missing".to_owned());
    }
    let checked = checked(&bytes)?;
    let most = MOST_CELLS + CELLS_PER_BYTE * bytes.len() as u64;
    let read = move || -> Result<ParquetFile, String> {
        let mut reader = ParquetReader::new(Cursor::new(bytes));
        let footer = reader.get_metadata().map_err(|e| first_line(&e))?;
        let entries = footer.key_value_metadata().iter().flatten();
        let metadata = entries
            .filter(|kv| kv.key != CHECKSUM)
            .filter_map(|kv| Some((kv.key.clone(), kv.value.clone()?)));
        let metadata = metadata.collect();
        let groups = footer.row_groups.iter();
        let rows = groups.map(|group| group.num_rows() as u64).sum::<u64>();
        let rows = rows.max(footer.num_rows as u64);
        // Of other types polars may know nothing, not even that it does not.
        let schema = reader.schema().map_err(|e| first_line(&e))?;
        let readable = schema.iter().filter(|(_, field)| is_readable(&field.dtype));
        let readable = readable.map(|(name, _)| name.to_string());
        let columns = columns.map_or_else(|| readable.collect(), <[String]>::to_vec);
        let width = columns.len() as u64;
        if rows.saturating_mul(width) > most {
            return Err(format!(
                "it announces {rows} rows of {width} column{}: expected at most {most} cells in a file of this size; write it in several files, or only the rows of the drive",
                if width == 1 { "" } else { "s" }
            ));
        }
        let frame = reader
            // On this thread, where a panic can be caught without a word.
            .read_parallel(ParallelStrategy::None)
            .with_columns(Some(columns))
            .finish()
            .map_err(|e| first_line(&e))?;
        Ok(ParquetFile { frame, metadata, checked })
    };
    caught(read)
}

/// The columns in their order: a name, and the type of one that holds neither numbers, words, dates nor yes and no.
pub(crate) fn parquet_columns(bytes: &[u8]) -> Result<Vec<(String, Option<String>)>, String> {
    caught(|| {
        let schema = ParquetReader::new(Cursor::new(bytes)).schema();
        let schema = schema.map_err(|e| first_line(&e))?;
        let columns = schema.iter().map(|(name, field)| {
            let type_name = (!is_readable(&field.dtype)).then(|| format!("{:?}", field.dtype));
            (name.to_string(), type_name)
        });
        Ok(columns.collect())
    })
}

/// Whether cells are numbers, words, times, or yes and no.
fn is_readable(kind: &ArrowDataType) -> bool {
    use ArrowDataType as T;
    match kind {
        T::Boolean
        | T::Int8
        | T::Int16
        | T::Int32
        | T::Int64
        | T::UInt8
        | T::UInt16
        | T::UInt32
        | T::UInt64
        | T::Float32
        | T::Float64
        | T::Decimal(..)
        | T::Timestamp(..)
        | T::Date32
        | T::Date64
        | T::Time32(_)
        | T::Time64(_)
        | T::Duration(_)
        | T::Utf8
        | T::LargeUtf8
        | T::Utf8View => true,
        T::Dictionary(_, values, _) => is_readable(values),
        _ => false,
    }
}

pub(crate) fn first_line(error: &impl ToString) -> String {
    let text = error.to_string();
    text.lines().next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use polars::prelude::Column;

    fn frame() -> DataFrame {
        let values: Vec<f64> = (0..2000).map(|i| f64::from(i).sin()).collect();
        let words: Vec<String> = (0..2000).map(|i| format!("w{}", i % 7)).collect();
        let columns = vec![Column::new("x".into(), values), Column::new("word".into(), words)];
        DataFrame::new(2000, columns).unwrap()
    }

    #[test]
    fn what_is_written_comes_back_with_its_texts_and_a_checksum() {
        let texts = vec![("maveric.a".to_owned(), "b".to_owned())];
        let bytes = parquet_bytes(&mut frame(), texts.clone()).unwrap();
        assert_eq!(bytes, parquet_bytes(&mut frame(), texts.clone()).unwrap());
        let read = read_parquet(bytes, None).unwrap();
        assert!(read.checked && read.frame.equals(&frame()));
        let own = read.metadata.into_iter().filter(|e| e.0.starts_with("maveric."));
        assert_eq!(own.collect::<Vec<_>>(), texts);
    }

    #[test]
    fn every_single_bit_that_changes_is_noticed_unless_it_hides_the_checksum_itself() {
        let bytes = parquet_bytes(&mut frame(), Vec::new()).unwrap();
        let step = bytes.len() / 997 + 1;
        for at in (0..bytes.len()).step_by(step) {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            match read_parquet(changed, None) {
                Err(_) => {}
                // The mark of the checksum was hit: the file is as one without, and its numbers are right.
                Ok(read) => assert!(!read.checked && read.frame.equals(&frame()), "byte {at}"),
            }
        }
        for length in [0, 4, 11, bytes.len() / 2, bytes.len() - 1] {
            assert!(read_parquet(bytes[..length].to_vec(), None).is_err());
        }
    }

    #[test]
    fn a_small_file_of_very_many_equal_rows_is_refused_before_they_are_in_memory() {
        let rows = 104_000_000;
        let column = Column::new_scalar("valid".into(), true.into(), rows);
        let mut bytes = Vec::new();
        ParquetWriter::new(&mut bytes)
            .finish(&mut DataFrame::new(rows, vec![column]).unwrap())
            .unwrap();
        assert!(bytes.len() < 200_000, "{}", bytes.len());
        let error = read_parquet(bytes, None).unwrap_err();
        assert!(error.contains("104000000 rows of 1 column"), "{error}");
    }

    #[test]
    fn other_programs_parquet_is_read_and_a_damaged_one_is_an_error_and_no_panic() {
        let mut bytes = Vec::new();
        ParquetWriter::new(&mut bytes).finish(&mut frame()).unwrap();
        assert!(!read_parquet(bytes.clone(), None).unwrap().checked);
        let columns = [("x".to_owned(), None), ("word".to_owned(), None)];
        assert_eq!(parquet_columns(&bytes).unwrap(), columns);
        let mut refused = 0;
        for at in (4..bytes.len()).step_by(bytes.len() / 499 + 1) {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            refused += usize::from(read_parquet(changed, None).is_err());
        }
        assert!(refused > 10, "{refused}");
    }
}
