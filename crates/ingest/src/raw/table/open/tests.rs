//! Tables of any kind are opened, and what is wrong with them is named.

use super::*;

/// A file such as other programs write, with every type that their tables have.
fn foreign_parquet() -> Vec<u8> {
    use polars::prelude::{IntoColumn as _, NamedFrom as _, ParquetWriter, Series, TimeUnit};
    let column = |name: &str, values: Series, kind: DataType| {
        let mut values = values.cast(&kind).unwrap();
        values.rename(name.into());
        values.into_column()
    };
    let whole =
        |name: &str, kind: DataType| column(name, Series::new("".into(), [1_i64, 2, 3]), kind);
    let us = DataType::Datetime(TimeUnit::Microseconds, None);
    let stamps = Series::new(
        "".into(),
        [1_562_235_693_100_000_i64, 1_562_235_693_200_000, 1_562_235_693_300_000],
    );
    let zoned = |name: &str, zone: &str| {
        let zone = polars_core::prelude::TimeZone::opt_try_new(Some(zone)).unwrap();
        let mut values = stamps.clone().into_datetime(TimeUnit::Microseconds, zone);
        values.rename(name.into());
        values.into_column()
    };
    let words = Series::new("".into(), ["a", "b", "a"]);
    let lists = Series::new("".into(), [1_i64, 2]);
    let lists = Series::new("lists".into(), vec![lists; 3]);
    let columns = vec![
        zoned("when_utc", "UTC"),
        zoned("when_berlin", "Europe/Berlin"),
        column("when", stamps, us),
        whole("day", DataType::Date),
        whole("i8", DataType::Int8),
        whole("u8", DataType::UInt8),
        whole("i16", DataType::Int16),
        whole("u16", DataType::UInt16),
        whole("f32", DataType::Float32),
        whole("decimal", DataType::Decimal(10, 2)),
        whole("duration", DataType::Duration(TimeUnit::Milliseconds)),
        column(
            "kind",
            words,
            DataType::from_categories(polars_core::prelude::Categories::global()),
        ),
        whole("valid", DataType::Boolean),
        lists.into_column(),
    ];
    let mut bytes = Vec::new();
    let mut frame = DataFrame::new(3, columns).unwrap();
    ParquetWriter::new(&mut bytes).finish(&mut frame).unwrap();
    bytes
}

fn open(text: &str, wanted: &[(&str, Kind)]) -> Result<Table, IngestError> {
    Table::open(Path::new("t.csv"), text.into(), Style::default(), wanted)
}

#[test]
fn a_header_is_found_below_other_lines_and_with_any_separator() {
    let text = "Freq;10\nDate;today\n Time ;Speed1\r\n0,5;1\r\n0,6;2\r\n";
    let style = Style { separator: None, decimal_comma: true, ..Style::default() };
    let wanted = [("time", Kind::Number), ("Speed1", Kind::Number)];
    let table = Table::open(Path::new("t.csv"), text.into(), style, &wanted).unwrap();
    assert_eq!(table.numbers("time").unwrap(), [0.5, 0.6]);
    assert_eq!(table.numbers("Speed1").unwrap(), [1.0, 2.0]);
}

#[test]
fn a_word_among_numbers_is_named_by_row_and_empty_cells_are_missing() {
    let wanted = [("t", Kind::Number), ("v", Kind::Number), ("w?", Kind::Number)];
    let table = open("t,v\n0,1\n1,fast\n", &wanted).unwrap();
    let error = table.numbers("v").unwrap_err().to_string();
    assert!(error.contains("row 2") && error.contains("`fast`"), "{error}");
    assert!(!table.has("w?"));
    let table = open("t,v\n0,NaN\n1,\n2,NA\n3,4\n", &wanted).unwrap();
    let missing: Vec<bool> = table.numbers("v").unwrap().iter().map(|v| v.is_nan()).collect();
    assert_eq!(missing, [true, true, true, false]);
}

#[test]
fn a_row_of_too_many_cells_and_a_doubled_name_are_refused() {
    let error = open("t,v\n0,1\n0,1,2\n", &[("t", Kind::Number)]);
    let error = error.unwrap_err().to_string();
    assert!(error.contains("row 2 has 3 cells, expected 2"), "{error}");
    // The cell that is too many stands behind the columns that are read, or holds what looks like a number.
    for text in ["t,v\n0,1\n0,19,5\n", "t,\"v\"\n0,1\n0,\"1\",5\n"] {
        let error = open(text, &[("t", Kind::Number), ("v", Kind::Number)]).unwrap_err();
        assert!(error.to_string().contains("row 2 has 3 cells, expected 2"), "{error}");
    }
    assert_eq!(
        open("t,v\n0,1,\n2,3,\n", &[("v", Kind::Number)]).unwrap().numbers("v").unwrap(),
        [1.0, 3.0]
    );
    let error = open("t,t\n0,1\n", &[("t", Kind::Number)]).unwrap_err();
    assert!(error.to_string().contains("twice: columns 1 and 2"));
}

#[test]
fn rows_that_lack_a_wanted_cell_are_told_and_a_last_one_that_is_cut_is_left_out() {
    let told = |text: &str| {
        let table = open(text, &[("t", Kind::Number), ("v", Kind::Number)]).unwrap();
        let warnings = table.warnings().iter().map(|w| (w.count, w.what.clone()));
        (table.rows(), warnings.collect::<Vec<_>>())
    };
    let (rows, warnings) = told("t,v,w\n0,1,a\n1\n2,3,b\n3\n");
    assert_eq!((rows, warnings.len(), warnings[0].0), (4, 1, 2));
    assert!(warnings[0].1.contains("row 2 after 1 of 3 cells"), "{warnings:?}");
    let (rows, warnings) = told("t,v,w\n0,19.4,a\n1,1");
    assert_eq!((rows, warnings.len(), warnings[0].0), (1, 1, 1));
    assert!(warnings[0].1.contains("row, 2, ends after 2 of 3 cells"), "{warnings:?}");
    // Every wanted cell is there, or the last row is as wide as the one above it.
    for text in ["t,v,w\n0,1,a\n1,2\n", "t,v,w\n0,1,a\n1,2,b", "t,v,w\n0,1\n1,2"] {
        assert_eq!(told(text), (2, Vec::new()), "{text:?}");
    }
    let error = open("t,v\n0", &[("v", Kind::Number)]).unwrap_err();
    assert!(error.to_string().contains("no rows"), "{error}");
}

#[test]
fn a_text_in_another_encoding_or_with_other_line_ends_says_so_with_its_line() {
    let refused = |text: &[u8]| {
        let wanted = [("t", Kind::Number), ("w", Kind::Word)];
        let found = Table::open(Path::new("t.csv"), text.into(), Style::default(), &wanted);
        found.unwrap_err().to_string()
    };
    let error = refused(b"t,w\n0,a\n1,K\xf6ln\n");
    assert!(error.contains("line 3 holds the byte f6") && error.contains("UTF-8"), "{error}");
    let error = refused(b"t,w\r0,a\r1,b\r");
    assert!(error.contains("carriage return alone"), "{error}");
}

#[test]
fn names_become_codes_of_a_sorted_list() {
    let table = open("id\nb\na\n\n2.0\n", &[("id", Kind::Word)]).unwrap();
    let (codes, names) = table.codes("id").unwrap();
    assert_eq!(names, ["2", "a", "b"]);
    assert_eq!(codes.iter().flatten().copied().collect::<Vec<_>>(), [2, 1, 0]);
}

#[test]
fn parquet_of_other_programs_is_read_whatever_its_types_and_yes_and_no_are_no_speeds() {
    let read = |wanted: &[(&str, Kind)]| {
        Table::open(Path::new("t.parquet"), foreign_parquet(), Style::default(), wanted)
    };
    for name in ["i8", "u8", "i16", "u16", "f32", "decimal"] {
        let table = read(&[(name, Kind::Number)]).unwrap();
        assert_eq!(table.numbers(name).unwrap(), [1.0, 2.0, 3.0], "{name}");
    }
    let table = read(&[("kind", Kind::Word), ("when", Kind::Word)]).unwrap();
    let word = |text: &str| Some(text.to_owned());
    assert_eq!(table.words("kind").unwrap(), [word("a"), word("b"), word("a")]);
    let clock = crate::raw::table::time::Clock {
        unit: crate::mapping::TimeUnit::Iso8601,
        pattern: None,
        frames_per_s: 1.0,
        hole_ns: 0,
    };
    // An instant is the same one in every zone.
    for name in ["when", "when_utc", "when_berlin"] {
        let table = read(&[(name, Kind::Word)]).unwrap();
        let stamps = crate::raw::table::time::as_written(&table, name, clock).unwrap();
        assert_eq!(stamps[0], Some(1_562_235_693_100_000_000), "{name}");
        assert_eq!(stamps[2], Some(1_562_235_693_300_000_000), "{name}");
    }
    for (name, found) in [
        ("valid", "column `valid` holds yes and no (bool): expected a finite number"),
        ("when", "`time = \"iso8601\"`"),
        ("when_utc", "`time = \"iso8601\"`"),
        ("day", "column `day` holds times (date)"),
        ("duration", "column `duration` holds times (duration[ms])"),
        ("kind", "`a`"),
    ] {
        let table = read(&[(name, Kind::Number)]).unwrap();
        let error = table.numbers(name).unwrap_err().to_string();
        assert!(error.contains(found), "{error}");
    }
    let error = read(&[("lists", Kind::Number)]).unwrap_err().to_string();
    assert!(error.contains("column `lists` is of type"), "{error}");
}
