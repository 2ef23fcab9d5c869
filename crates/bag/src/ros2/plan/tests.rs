use super::*;
use crate::ros2::{cdr::Writer, definition::parse};

fn compiled(text: &str, wanted: &[&str]) -> Plan {
    let definitions = parse("p/M", text, Dialect::Ros2).unwrap();
    Plan::compile(&definitions, wanted, Dialect::Ros2).unwrap()
}

fn rows(plan: &Plan, bytes: &[u8]) -> Result<(Vec<Vec<f64>>, usize), CdrError> {
    let mut rows = Vec::new();
    let left = plan.run(bytes, &mut Vec::new(), &mut |r| rows.push(r.to_vec()))?;
    Ok((rows, left))
}

const NESTED: &str = "string name\nuint8 a\nfloat64[3] skipped\nP[] rows\nint32 last\n\
    ================================================================================\n\
    MSG: p/P\nuint8 id\nfloat64[<=3] size";

#[test]
fn wanted_numbers_are_taken_and_the_rest_is_passed_over() {
    let plan = compiled(NESTED, &["a", "rows[].id", "rows[].size[1]", "rows[].colour?"]);
    let mut writer = Writer::new();
    writer.string("hello");
    writer.u8(9);
    writer.f64s(&[0.0; 3]);
    writer.u32(2);
    for (id, size) in [(1, &[4.0, 2.0][..]), (2, &[4.0][..])] {
        writer.u8(id);
        writer.u32(size.len() as u32);
        writer.f64s(size);
    }
    writer.u32(5);
    let (seen, left) = rows(&plan, writer.bytes()).unwrap();
    assert_eq!(left, 4, "the last field is not walked");
    assert_eq!(seen[0][..3], [9.0, 1.0, 2.0]);
    assert_eq!(seen[1][..2], [9.0, 2.0]);
    assert!(seen[1][2].is_nan() && seen[1][3].is_nan());
}

#[test]
fn numbers_after_strings_of_any_length_are_aligned() {
    let plan =
        compiled("string s\nuint8 a\nuint16 b\nfloat64 c\nuint8 d\nint64 e", &["b", "c", "e"]);
    for length in 0..12 {
        let mut writer = Writer::new();
        writer.string(&"x".repeat(length));
        writer.u8(1);
        writer.u8(0);
        while !(writer.bytes().len() - 4).is_multiple_of(2) {
            writer.u8(0);
        }
        // b follows a at the next even place.
        let mut bytes = writer.bytes().to_vec();
        let at = 4 + 4 + length + 1 + 1;
        bytes.truncate(at);
        let pad = |bytes: &mut Vec<u8>, n: usize| {
            while !(bytes.len() - 4).is_multiple_of(n) {
                bytes.push(0xee);
            }
        };
        pad(&mut bytes, 2);
        bytes.extend(300_u16.to_le_bytes());
        pad(&mut bytes, 8);
        bytes.extend(1.25_f64.to_le_bytes());
        bytes.push(9);
        pad(&mut bytes, 8);
        bytes.extend((-5_i64).to_le_bytes());
        let mut row = Vec::new();
        assert_eq!(plan.run(&bytes, &mut row, &mut |_| {}), Ok(0), "{length}");
        assert_eq!(row, [300.0, 1.25, -5.0]);
    }
}

/// Two rows as XCDR2 writes them: 4-byte alignment, and sizes before what is not a number.
fn xcdr2(kind: u8, structures: bool) -> Vec<u8> {
    let mut inner = Vec::new();
    for (id, size) in [(1_u8, [4.0_f64, 2.0]), (2, [5.0, 3.0])] {
        let mut one = vec![id, 0, 0, 0];
        one.extend(2_u32.to_le_bytes());
        one.extend(size.iter().flat_map(|v| v.to_le_bytes()));
        if structures {
            inner.extend((one.len() as u32).to_le_bytes());
        }
        inner.extend(one);
    }
    let mut sequence = 2_u32.to_le_bytes().to_vec();
    sequence.extend(inner);
    let mut body = 1_u32.to_le_bytes().to_vec();
    body.extend([0, 9, 0, 0]);
    body.extend([0; 24]);
    body.extend((sequence.len() as u32).to_le_bytes());
    body.extend(sequence);
    body.extend(5_u32.to_le_bytes());
    if structures {
        // A field that this definition does not know yet.
        body.extend([1, 2, 3, 4]);
        let size = (body.len() as u32).to_le_bytes();
        body.splice(0..0, size);
    }
    let mut message = vec![0, kind, 0, 0];
    message.extend(body);
    message
}

#[test]
fn xcdr2_plain_and_delimited_are_read() {
    let plan = compiled(NESTED, &["a", "rows[].id", "rows[].size[1]"]);
    let expected = vec![vec![9.0, 1.0, 2.0], vec![9.0, 2.0, 3.0]];
    for (kind, structures) in [(7, false), (9, true)] {
        let (seen, _) = rows(&plan, &xcdr2(kind, structures)).unwrap();
        assert_eq!(seen, expected, "{kind} {structures}");
    }
    let parameters = rows(&plan, &xcdr2(3, false)).unwrap_err();
    assert_eq!(parameters, CdrError::Encapsulation(0, 3));
}

#[test]
fn the_width_of_wide_characters_is_found_by_what_fits() {
    let plan = compiled("wstring w\nuint32 x\nuint32 y", &["x", "y"]);
    for wide in [2_usize, 4] {
        let mut bytes = vec![0, 1, 0, 0, 2, 0, 0, 0];
        bytes.extend(vec![0x41; 2 * wide]);
        bytes.extend(7_u32.to_le_bytes());
        bytes.extend(8_u32.to_le_bytes());
        let mut row = Vec::new();
        plan.run(&bytes, &mut row, &mut |_| {}).unwrap();
        assert_eq!(row, [7.0, 8.0], "{wide}");
    }
}

#[test]
fn numbers_of_the_first_element_of_a_sequence_are_taken() {
    let text = "P[] rows\nint32 last\n\
        ================================================================================\n\
        MSG: p/P\nuint8 id\nstring s";
    let plan = compiled(text, &["rows[0].id?", "last"]);
    let mut writer = Writer::new();
    writer.u32(2);
    for id in [5, 6] {
        writer.u8(id);
        writer.string("abc");
    }
    writer.u32(1);
    let mut row = Vec::new();
    assert_eq!(plan.run(writer.bytes(), &mut row, &mut |_| {}), Ok(0));
    assert_eq!(row, [5.0, 1.0]);
    plan.run(&[0, 1, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0], &mut row, &mut |_| {}).unwrap();
    assert!(row[0].is_nan());
}

#[test]
fn ros_1_is_packed() {
    let definitions = parse(
        "p/M",
        "uint8 a\nfloat64 b\ntime t\nEmpty e\nint32 c\n\
        ================================================================================\n\
        MSG: p/Empty\n",
        Dialect::Ros1,
    )
    .unwrap();
    let plan = Plan::compile(&definitions, &["b", "t.sec", "c"], Dialect::Ros1).unwrap();
    let mut bytes = vec![1];
    bytes.extend(2.5_f64.to_le_bytes());
    bytes.extend([3, 0, 0, 0, 4, 0, 0, 0, 9, 0, 0, 0]);
    let mut row = Vec::new();
    assert_eq!(plan.run(&bytes, &mut row, &mut |_| {}), Ok(0));
    assert_eq!(row, [2.5, 3.0, 9.0]);
}

#[test]
fn a_type_that_contains_itself_and_a_missing_field_are_refused() {
    let of = |text: &str, wanted: &[&str]| {
        let definitions = parse("p/A", text, Dialect::Ros2).unwrap();
        Plan::compile(&definitions, wanted, Dialect::Ros2).unwrap_err()
    };
    assert!(of("p/A[] a\nint32 x", &[]).contains("itself"));
    assert!(of("int32 x", &["y|z"]).contains("`y` or `z`"));
    assert!(of("float64[18446744073709551615] x\nint32 y", &["y"]).contains("too large"));
}

#[test]
fn a_huge_claimed_count_ends_with_the_bytes() {
    let plan = compiled("string[] s", &[]);
    let found = rows(&plan, &[0, 1, 0, 0, 255, 255, 255, 255]);
    assert_eq!(found, Err(CdrError::End));
}

#[test]
fn every_kind_of_number_is_read_in_both_byte_orders_and_aligned_to_its_size() {
    let text = "uint8 p0\nint8 a\nuint8 p1\nuint16 b\nint16 c\nuint8 p2\nuint32 d\nint32 e\nfloat32 f\n\
        uint8 p3\nuint64 g\nint64 h\nfloat64 i";
    let wanted = ["a", "b", "c", "d", "e", "f", "g", "h", "i"];
    let values = [-5.0, 40_000.0, -300.0, 4e9, -7e4, 0.5, 1e18, -9e15, -0.1];
    let plan = compiled(text, &wanted);
    for (kind, big, most) in [(0, true, 8), (1, false, 8), (6, true, 4), (7, false, 4)] {
        let mut bytes = Vec::new();
        let mut put = |number: &[u8]| {
            let align = number.len().min(most);
            bytes.resize(bytes.len().next_multiple_of(align), 0xee);
            let mut number = number.to_vec();
            if big {
                number.reverse();
            }
            bytes.extend(number);
        };
        put(&[1]);
        put(&(-5_i8).to_le_bytes());
        put(&[1]);
        put(&40_000_u16.to_le_bytes());
        put(&(-300_i16).to_le_bytes());
        put(&[1]);
        put(&4_000_000_000_u32.to_le_bytes());
        put(&(-70_000_i32).to_le_bytes());
        put(&0.5_f32.to_le_bytes());
        put(&[1]);
        put(&1_000_000_000_000_000_000_u64.to_le_bytes());
        put(&(-9_000_000_000_000_000_i64).to_le_bytes());
        put(&(-0.1_f64).to_le_bytes());
        let message = [&[0, kind, 0, 0][..], &bytes].concat();
        let mut row = Vec::new();
        assert_eq!(plan.run(&message, &mut row, &mut |_| {}), Ok(0), "{kind}");
        assert_eq!(row, values, "{kind}");
        let cut = plan.run(&message[..message.len() - 1], &mut row, &mut |_| {});
        assert_eq!(cut, Err(CdrError::End), "{kind}");
    }
}

#[test]
fn elements_of_arrays_and_sequences_are_taken_by_their_place() {
    let text = "uint8 a\nfloat64[3] fixed\nint16[] some\nstring[2] names\nP[2] pairs\nstring who\nuint8 z\n\
        ================================================================================\n\
        MSG: p/P\nuint8 id\nint32 v";
    let wanted = ["fixed[2]", "fixed[0]", "some[1]?", "pairs[0].v", "who#", "z", "some[7]?"];
    let plan = compiled(text, &wanted);
    let mut writer = Writer::new();
    writer.u8(1);
    writer.f64s(&[1.5, 2.5, 3.5]);
    writer.u32(3);
    for v in [7_u8, 0, 9, 0, 11, 0] {
        writer.u8(v);
    }
    writer.string("x");
    writer.string("long name");
    for (id, v) in [(1, 100), (2, 200)] {
        writer.u8(id);
        writer.u32(v);
    }
    writer.string("car/ego");
    writer.u8(5);
    let mut row = Vec::new();
    assert_eq!(plan.run(writer.bytes(), &mut row, &mut |_| {}), Ok(0));
    let ego = wanted::name_number(b"ego");
    assert_eq!(row[..6], [3.5, 1.5, 9.0, 100.0, ego, 5.0]);
    assert!(row[6].is_nan());
    let many = compiled("float64[1000] x\nuint8 y", &["y", "x[999]"]);
    let mut writer = Writer::new();
    writer.f64s(&(0..1000).map(f64::from).collect::<Vec<_>>());
    writer.u8(3);
    many.run(writer.bytes(), &mut row, &mut |_| {}).unwrap();
    assert_eq!(row, [3.0, 999.0]);
}

#[test]
fn a_message_gives_so_many_rows_and_no_more_and_elements_of_no_bytes_none() {
    let plan = compiled(
        "P[] rows\n================================================================================\nMSG: p/P\nuint8 id",
        &["rows[].id"],
    );
    let of = |n: usize| {
        let mut bytes = vec![0, 1, 0, 0];
        bytes.extend((n as u32).to_le_bytes());
        bytes.resize(8 + n, 4);
        rows(&plan, &bytes).map(|(rows, left)| (rows.len(), left))
    };
    assert_eq!(of(wanted::MOST_ROWS), Ok((wanted::MOST_ROWS, 0)));
    let n = wanted::MOST_ROWS + 1;
    assert_eq!(of(n), Err(CdrError::TooMany(n as u64)));
    // ROS 1 gives a message without fields no byte: four thousand million of them are none.
    let text = "Empty[] e\nuint8 z\n================================================================================\nMSG: p/Empty\n";
    let definitions = parse("p/M", text, Dialect::Ros1).unwrap();
    let plan = Plan::compile(&definitions, &["z"], Dialect::Ros1).unwrap();
    let mut row = Vec::new();
    plan.run(&[255, 255, 255, 255, 6], &mut row, &mut |_| {}).unwrap();
    assert_eq!(row, [6.0]);
    // In ROS 2 each has one.
    let plan = compiled(text, &["z"]);
    plan.run(&[0, 1, 0, 0, 2, 0, 0, 0, 0, 0, 6], &mut row, &mut |_| {}).unwrap();
    assert_eq!(row, [6.0]);
}

#[test]
fn what_is_nested_in_rows_and_arrays_is_passed_over_in_every_layout() {
    let text = "P[] rows\nuint8 z\n\
        ================================================================================\n\
        MSG: p/P\nQ[2] two\nwstring w\nuint16[] s\nuint8 id\n\
        ================================================================================\n\
        MSG: p/Q\nstring[] names\nfloat64 x";
    let plan = compiled(text, &["rows[].id", "z"]);
    let mut writer = Writer::new();
    writer.u32(2);
    for id in [5, 6] {
        for _ in 0..2 {
            writer.u32(1);
            writer.string("abcde");
            writer.f64(1.0);
        }
        writer.u32(3);
        for _ in 0..3 {
            writer.u32(0x41);
        }
        writer.u32(1);
        writer.u8(9);
        writer.u8(9);
        writer.u8(id);
    }
    writer.u8(7);
    let mut ids = Vec::new();
    let mut row = Vec::new();
    let left = plan.run(writer.bytes(), &mut row, &mut |r| ids.push(r[0]));
    assert_eq!((left, ids, row[1]), (Ok(0), vec![5.0, 6.0], 7.0));
}

#[test]
fn the_width_that_fits_whole_is_taken_before_one_that_fits_at_all() {
    // With four bytes a character the message ends just as early as with two and eight bytes left over.
    let plan = compiled("wstring w\nuint8 x", &[]);
    let message = |bytes: usize| [&[0, 1, 0, 0, 4, 0, 0, 0][..], &vec![1; bytes]].concat();
    assert_eq!(rows(&plan, &message(17)).map(|r| r.1), Ok(0), "four times four");
    assert_eq!(rows(&plan, &message(9)).map(|r| r.1), Ok(0), "four times two");
    // Neither is whole: the first that fits.
    assert_eq!(rows(&plan, &message(40)).map(|r| r.1), Ok(23));
    assert_eq!(rows(&plan, &message(8)).map(|r| r.1), Err(CdrError::End));
    assert_eq!(rows(&plan, &message(9 + MOST_PADDING)).map(|r| r.1), Ok(7));
    assert_eq!(rows(&plan, &message(17 + MOST_PADDING)).map(|r| r.1), Ok(7));
}
