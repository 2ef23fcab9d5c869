//! Tables of text: CSV with a heading.

use csv_core::{ReadRecordResult, ReaderBuilder};

/// A line of the file, from 1, and the cells of the row that starts there.
type Row = (u64, Vec<String>);

/// The heading and the rows, all as long as the heading.
///
/// # Errors
/// In words: no text, no heading, or a row of another length.
pub(crate) fn read(bytes: &[u8], delimiter: u8) -> Result<(Vec<String>, Vec<Row>), String> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes); // what Excel puts in front
    let mut reader = ReaderBuilder::new().delimiter(delimiter).build();
    let mut input = bytes;
    let mut cells = vec![0; bytes.len()];
    let mut ends = vec![0; 16];
    let (mut filled, mut ended) = (0, 0);
    let mut rows: Vec<Row> = Vec::new();
    let mut line = 1;
    loop {
        let (result, read, written, found) =
            reader.read_record(input, &mut cells[filled..], &mut ends[ended..]);
        input = &input[read..];
        filled += written;
        ended += found;
        match result {
            ReadRecordResult::InputEmpty => {} // once more: the last row may lack its end
            ReadRecordResult::OutputFull => cells.resize(2 * cells.len() + 1, 0),
            ReadRecordResult::OutputEndsFull => ends.resize(2 * ends.len(), 0),
            ReadRecordResult::Record => {
                let starts = std::iter::once(0).chain(ends[..ended].iter().copied());
                let row = starts.zip(&ends[..ended]).map(|(start, &end)| {
                    String::from_utf8(cells[start..end].to_vec())
                        .map_err(|_| format!("line {line} is no UTF-8 text"))
                });
                rows.push((line, row.collect::<Result<_, _>>()?));
                (filled, ended) = (0, 0);
                line = reader.line();
            }
            ReadRecordResult::End => break,
        }
    }
    if rows.is_empty() {
        return Err("it has no heading".to_owned());
    }
    let (_, heading) = rows.remove(0);
    match rows.iter().find(|(_, row)| row.len() != heading.len()) {
        Some((line, row)) => {
            Err(format!("line {line} has {} cells and the heading {}", row.len(), heading.len()))
        }
        None => Ok((heading, rows)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_cells_and_a_last_row_without_an_end_are_read() {
        let (heading, rows) =
            read(b"\xef\xbb\xbfa,b\n\"x,\ny\",2\n\n3,\"\"\"q\"\"\"", b',').unwrap();
        assert_eq!(heading, ["a", "b"]);
        assert_eq!(rows[0], (2, vec!["x,\ny".to_owned(), "2".to_owned()]));
        assert_eq!(rows[1].1, ["3", "\"q\""]);
        let many = (0..40).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
        assert_eq!(read(many.as_bytes(), b',').unwrap().0.len(), 40);
    }

    #[test]
    fn a_row_of_another_length_is_named() {
        let error = read(b"a,b\n1,2\n3\n", b',').unwrap_err();
        assert_eq!(error, "line 3 has 1 cells and the heading 2");
        assert!(read(b"", b',').is_err());
    }
}
