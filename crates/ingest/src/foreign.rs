//! Files that are no logs but are often taken for one: what they are, and what makes a log of them.

/// What a file is by its first bytes, as a sentence, and what to do with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Foreign {
    pub(crate) what: &'static str,
    pub(crate) advice: &'static str,
}

const KNOWN: [(&[u8], Foreign); 11] = [
    (
        b"#ROSBAG",
        Foreign {
            what: "it is a ROS 1 bag",
            advice: "convert it with the mcap tool: `mcap convert FILE.bag FILE.mcap`",
        },
    ),
    (
        b"SQLite format 3\0",
        Foreign {
            what: "it is an SQLite file, as older ROS 2 rigs record",
            advice: "convert it with the mcap tool: `mcap convert FILE.db3 FILE.mcap`, or with `ros2 bag convert`",
        },
    ),
    (
        &[0x1f, 0x8b],
        Foreign {
            what: "it is packed with gzip",
            advice: "unpack it first: `gunzip FILE.gz`",
        },
    ),
    (
        &[0x28, 0xb5, 0x2f, 0xfd],
        Foreign {
            what: "it is packed with zstd as a whole",
            advice: "unpack it first: `zstd -d FILE.zstd`",
        },
    ),
    (
        &[0x04, 0x22, 0x4d, 0x18],
        Foreign {
            what: "it is packed with lz4 as a whole",
            advice: "unpack it first: `lz4 -d FILE.lz4`",
        },
    ),
    (
        b"BZh",
        Foreign {
            what: "it is packed with bzip2",
            advice: "unpack it first: `bunzip2 FILE.bz2`",
        },
    ),
    (
        b"PK\x03\x04",
        Foreign {
            what: "it is a ZIP archive, or a spreadsheet",
            advice: "unpack it, or save the sheet as CSV",
        },
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        Foreign {
            what: "it is an HDF5 file",
            advice: "export its signals as CSV or Parquet first",
        },
    ),
    (
        b"MATLAB 5.0 MAT-file",
        Foreign {
            what: "it is a MATLAB file",
            advice: "export its signals as CSV or Parquet first (`writetable`)",
        },
    ),
    (
        b"\x89PNG",
        Foreign {
            what: "it is a picture",
            advice: PLAIN,
        },
    ),
    (
        b"\xff\xd8\xff",
        Foreign {
            what: "it is a picture",
            advice: PLAIN,
        },
    ),
];

/// What to do with a file of which nothing is known.
pub(crate) const PLAIN: &str =
    "logs are MCAP recordings, or CSV, TSV or Parquet with a mapping; convert others first";

/// What a file that starts like this is, where it is known to be no log.
pub(crate) fn foreign(head: &[u8]) -> Option<Foreign> {
    let known = KNOWN.iter().find(|(start, _)| head.starts_with(start));
    known.map(|k| k.1)
}

/// Extensions of files that are worth opening to say why they are no logs, where a folder holds no log.
pub(crate) const EXTENSIONS: [&str; 8] = ["bag", "db3", "gz", "zst", "zstd", "lz4", "bz2", "zip"];
