//! Files that are no logs but are often taken for one: what they are, and what makes a log of them.

/// First bytes, what a file is that begins so, and what to do with it.
type Known = (&'static [u8], &'static str, &'static str);

const KNOWN: [Known; 13] = [
    (
        b"#ROSBAG",
        "it is a ROS 1 bag",
        "convert it with the mcap tool: `mcap convert FILE.bag FILE.mcap`",
    ),
    (
        b"SQLite format 3\0",
        "it is an SQLite file, as older ROS 2 rigs record",
        "convert it with the mcap tool: `mcap convert FILE.db3 FILE.mcap`, or with `ros2 bag convert`",
    ),
    (&[0x1f, 0x8b], "it is packed with gzip", "unpack it first: `gunzip FILE.gz`"),
    (
        &[0x28, 0xb5, 0x2f, 0xfd],
        "it is packed with zstd as a whole",
        "unpack it first: `zstd -d FILE.zstd`",
    ),
    (
        &[0x04, 0x22, 0x4d, 0x18],
        "it is packed with lz4 as a whole",
        "unpack it first: `lz4 -d FILE.lz4`",
    ),
    (b"BZh", "it is packed with bzip2", "unpack it first: `bunzip2 FILE.bz2`"),
    (b"PK\x03\x04", "it is a ZIP archive, or a spreadsheet", "unpack it, or save the sheet as CSV"),
    (b"\x89HDF\r\n\x1a\n", "it is an HDF5 file", "export its signals as CSV or Parquet first"),
    (
        b"MATLAB 5.0 MAT-file",
        "it is a MATLAB file",
        "export its signals as CSV or Parquet first (`writetable`)",
    ),
    (b"\x89PNG", "it is a picture", PLAIN),
    (b"\xff\xd8\xff", "it is a picture", PLAIN),
    (b"\xff\xfe", "it is a text in UTF-16", UTF_8),
    (b"\xfe\xff", "it is a text in UTF-16", UTF_8),
];

/// What to do with a file of which nothing is known.
pub(crate) const PLAIN: &str =
    "logs are MCAP recordings, or CSV, TSV or Parquet with a mapping; convert others first";

/// What a file that starts like this is, where it is known to be no log: a sentence, and what to do with it.
pub(crate) fn foreign(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let known = KNOWN.iter().find(|(start, ..)| head.starts_with(start));
    known.map(|&(_, what, advice)| (what, advice))
}

/// What to do with a text in another encoding.
const UTF_8: &str = "save it again as CSV in UTF-8 (spreadsheets call it `CSV UTF-8`)";

/// Why a text, or its beginning, cannot be read: what is wrong with its bytes, and what to do.
pub(crate) fn foreign_text(text: &[u8]) -> Option<(String, &'static str)> {
    let line = |offset: usize| 1 + memchr::memchr_iter(b'\n', &text[..offset]).count();
    if let Some(offset) = memchr::memchr(0, text) {
        let flaw = format!("its line {} holds a zero byte, expected text", line(offset));
        return Some((flaw, UTF_8));
    }
    if let Err(e) = std::str::from_utf8(text)
        && e.error_len().is_some()
    {
        let offset = e.valid_up_to();
        let flaw = format!(
            "its line {} holds the byte {:02x}, which is not UTF-8",
            line(offset),
            text[offset]
        );
        return Some((flaw, UTF_8));
    }
    let returns = || memchr::memchr(b'\r', text.trim_ascii_end()).is_some();
    (memchr::memchr(b'\n', text).is_none() && returns()).then(|| {
        let flaw = "its lines end in a carriage return alone, expected a line feed";
        (flaw.to_owned(), "save it again as CSV")
    })
}

/// Why bytes are no table of text: another kind of file, or a text that cannot be read. A sentence, and what to do.
pub(crate) fn no_table(bytes: &[u8]) -> Option<(String, &'static str)> {
    let other = foreign(bytes).map(|(what, advice)| (what.to_owned(), advice));
    other.or_else(|| foreign_text(bytes))
}

/// Extensions of files that are worth opening to say why they are no logs, where a folder holds no log.
pub(crate) const EXTENSIONS: [&str; 8] = ["bag", "db3", "gz", "zst", "zstd", "lz4", "bz2", "zip"];
