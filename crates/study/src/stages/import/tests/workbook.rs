//! Workbooks, written for tests.

/// A workbook of sheets: what a spreadsheet writes at least (ECMA-376, part 1: 18.2 and 18.3), numbers as numbers and texts in line. `=1+2` is a
/// formula without its value, `=1+2#3` one with it.
#[expect(clippy::format_push_string, reason = "a small file, put together")]
pub(crate) fn workbook(sheets: &[(&str, &[&[&str]])]) -> Vec<u8> {
    let mut zip: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, text: String| zip.push((name.to_owned(), text));
    let mut types = String::new();
    let (mut list, mut relations) = (String::new(), String::new());
    for (at, (name, rows)) in sheets.iter().enumerate() {
        let n = at + 1;
        let mut cells = String::new();
        for (row, line) in rows.iter().enumerate() {
            cells += &format!("<row r=\"{}\">", row + 1);
            for (column, word) in line.iter().enumerate().filter(|(_, word)| !word.is_empty()) {
                let place = format!("{}{}", letters(column), row + 1);
                cells += &match (word.strip_prefix('='), word.parse::<f64>()) {
                    (Some(formula), _) => {
                        let (formula, value) = formula.split_once('#').unwrap_or((formula, ""));
                        format!("<c r=\"{place}\"><f>{formula}</f><v>{value}</v></c>")
                    }
                    (None, Ok(number)) => format!("<c r=\"{place}\"><v>{number}</v></c>"),
                    (None, Err(_)) => format!(
                        "<c r=\"{place}\" t=\"inlineStr\"><is><t>{}</t></is></c>",
                        word.replace('&', "&amp;").replace('"', "&quot;")
                    ),
                };
            }
            cells += "</row>";
        }
        add(
            &format!("xl/worksheets/sheet{n}.xml"),
            format!(
                "<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData>{cells}</sheetData></worksheet>"
            ),
        );
        types += &format!(
            "<Override PartName=\"/xl/worksheets/sheet{n}.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml\"/>"
        );
        list += &format!("<sheet name=\"{name}\" sheetId=\"{n}\" r:id=\"rId{n}\"/>");
        relations += &format!(
            "<Relationship Id=\"rId{n}\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet\" Target=\"worksheets/sheet{n}.xml\"/>"
        );
    }
    add(
        "[Content_Types].xml",
        format!(
            "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Override PartName=\"/xl/workbook.xml\" ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml\"/>{types}</Types>"
        ),
    );
    add("_rels/.rels", "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Id=\"rId1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>".to_owned());
    add(
        "xl/workbook.xml",
        format!(
            "<workbook xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\" xmlns:r=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships\"><sheets>{list}</sheets></workbook>"
        ),
    );
    add(
        "xl/_rels/workbook.xml.rels",
        format!(
            "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">{relations}</Relationships>"
        ),
    );
    stored(&zip)
}

/// What a column is called: A to Z, AA to ZZ.
fn letters(column: usize) -> String {
    let letter = |n: usize| char::from(b'A' + n as u8);
    let first = (column / 26).checked_sub(1).map(letter);
    first.into_iter().chain([letter(column % 26)]).collect()
}

/// Files as a ZIP archive without compression (PKWARE's APPNOTE, 4.3).
fn stored(files: &[(String, String)]) -> Vec<u8> {
    let (mut body, mut index) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let crc = crc32(text.as_bytes());
        let sizes = [crc, text.len() as u32, text.len() as u32];
        let head = |bytes: &mut Vec<u8>| {
            bytes.extend([20, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
            bytes.extend(sizes.iter().flat_map(|n| n.to_le_bytes()));
            bytes.extend((name.len() as u16).to_le_bytes());
            bytes.extend([0, 0]);
        };
        index.extend(b"PK\x01\x02\x14\x00");
        head(&mut index);
        index.extend([0; 10]);
        index.extend((body.len() as u32).to_le_bytes());
        index.extend(name.as_bytes());
        body.extend(b"PK\x03\x04");
        head(&mut body);
        body.extend(name.as_bytes());
        body.extend(text.as_bytes());
    }
    let (start, length, n) = (body.len() as u32, index.len() as u32, files.len() as u16);
    body.extend(index);
    body.extend(b"PK\x05\x06\0\0\0\0");
    body.extend([n.to_le_bytes(), n.to_le_bytes()].concat());
    body.extend([length.to_le_bytes(), start.to_le_bytes()].concat());
    body.extend([0, 0]);
    body
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 }
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}
