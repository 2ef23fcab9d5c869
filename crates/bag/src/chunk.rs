//! Chunks: the records within, unpacked piece by piece and as far as they can be read.

use crate::record::{Fields, HEAD};
use std::io::Read;
use zstd::{bulk::Decompressor, stream::read::Decoder};

/// Longest record that is read, in bytes; a longer one can be no message that we want, and is passed over.
pub const MOST_RECORD: usize = 32 << 20;
/// Longest chunk that is read, compressed.
pub(crate) const MOST_CHUNK: u64 = 512 << 20;
/// Most bytes that one chunk may unpack to.
const MOST_UNPACKED: u64 = 4 << 30;
/// How far a chunk may unpack beyond what its header says before it is given up.
const MOST_OVERRUN: u64 = 64 << 20;
/// Longest window of a zstd stream (a power of two), which the stream itself claims.
const MOST_WINDOW_LOG: u32 = 25;
/// Room for unpacked bytes at first; it grows where one record needs more.
const ROOM: usize = 1 << 20;
/// Most room that is given at first for what a header claims.
pub(crate) const MOST_ROOM: u64 = 4 << 20;
/// Bytes of a chunk's content before the name of its compression.
const FIXED: usize = 8 + 8 + 8 + 4;

/// How a chunk is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Packing {
    None,
    Zstd,
    Lz4,
}

/// A chunk's own account of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Head {
    pub(crate) uncompressed_size: u64,
    crc: u32,
    compression: String,
    compressed_size: u64,
    /// Length of this account, in bytes.
    length: usize,
}

impl Head {
    /// Bytes of the content that this reads at most.
    pub(crate) const MOST: usize = FIXED + 4 + 16 + 8;

    /// Reads the account at the start of a chunk's content; none where there is none, or its compression has a name
    /// that is no word.
    pub(crate) fn read(content: &[u8]) -> Option<Self> {
        let mut fields = Fields(content);
        fields.u64()?;
        fields.u64()?;
        let uncompressed_size = fields.u64()?;
        let crc = fields.u32()?;
        let name = fields.block()?;
        if name.len() > 16 {
            return None;
        }
        Some(Self {
            uncompressed_size,
            crc,
            // By the bytes: a damaged name may be longer as text.
            length: FIXED + 4 + name.len() + 8,
            compression: String::from_utf8_lossy(name).into_owned(),
            compressed_size: fields.u64()?,
        })
    }

    /// Length of the whole content by this account; none past 2⁶⁴.
    pub(crate) fn content_length(&self) -> Option<u64> {
        self.compressed_size.checked_add(self.length as u64)
    }

    /// Length of the account itself.
    pub(crate) fn length(&self) -> u64 {
        self.length as u64
    }

    /// The packed bytes of a zstd chunk of a usual size whose content is as long as it says.
    pub(crate) fn whole_zstd<'a>(&self, content: &'a [u8]) -> Option<&'a [u8]> {
        let data = content.get(self.length..)?;
        let usual = (1..=MOST_ROOM).contains(&self.uncompressed_size);
        (usual && self.compression == "zstd" && self.compressed_size == data.len() as u64)
            .then_some(data)
    }

    /// Whether a record of another kind whose content starts like this is a chunk by accident of one byte.
    pub(crate) fn is_telling(&self) -> bool {
        match self.compression.as_str() {
            "zstd" | "lz4" => self.uncompressed_size > 0,
            "" => self.uncompressed_size > 0 && self.uncompressed_size == self.compressed_size,
            _ => false,
        }
    }

    /// The packing: by name, else by the first bytes.
    fn packing(&self, data: &[u8]) -> Option<Packing> {
        match self.compression.as_str() {
            "" => Some(Packing::None),
            "zstd" => Some(Packing::Zstd),
            "lz4" => Some(Packing::Lz4),
            _ if data.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) => Some(Packing::Zstd),
            _ if data.starts_with(&[0x04, 0x22, 0x4d, 0x18]) => Some(Packing::Lz4),
            _ => None,
        }
    }
}

/// What became of a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Every byte is as it was written, as far as can be told.
    Whole,
    /// Something about it is wrong, but its messages are proven: by its checksum, or by all its sizes where it has none.
    Proven(String),
    /// It cannot be trusted.
    Lost(String),
}

/// Unpacks chunks, one after another, in the same memory.
#[derive(Default)]
pub(crate) struct Unpacker {
    at_once: Option<Decompressor<'static>>,
    room: Vec<u8>,
}

impl Unpacker {
    /// Gives every record of a chunk to `each`, in order, and then says whether to believe them; of one that is too long to be
    /// read it gives no content.
    ///
    /// `content` is what there is of the chunk: all of it, or what stands before the end of a cut file; `unpacked` what its
    /// packed bytes gave, with its checksum, where that is known. Nothing is allocated by a length that the chunk claims beyond a few MiB.
    pub(crate) fn records(
        &mut self,
        content: &[u8],
        unpacked: Option<(&[u8], u32)>,
        each: impl FnMut(u8, Option<&[u8]>),
    ) -> Verdict {
        let lost = |why: &str| Verdict::Lost(why.to_owned());
        let Some(head) = Head::read(content) else {
            return lost("its chunk header cannot be read");
        };
        let rest = &content[head.length..];
        let Some(packing) = head.packing(rest) else {
            let name = head.compression.escape_default();
            return Verdict::Lost(format!(
                "its compression `{name}` is unknown, expected zstd, lz4 or none"
            ));
        };
        let claimed = usize::try_from(head.compressed_size).unwrap_or(usize::MAX);
        let cut = rest.len() < claimed;
        // A packed stream knows its own end, so a wrong size does no harm.
        let data = match packing {
            Packing::None if head.uncompressed_size != rest.len() as u64 => {
                &rest[..claimed.min(rest.len())]
            }
            _ => rest,
        };
        let mut splitter = Splitter { each, crc: crc32fast::Hasher::new(), pass_over: 0, total: 0 };
        let unpacked = match packing {
            Packing::None => Ok(splitter.take(data) == data.len()),
            Packing::Zstd if let Some((bytes, checksum)) = unpacked => {
                splitter.crc = crc32fast::Hasher::new_with_initial(checksum);
                splitter.total = bytes.len() as u64;
                Ok(splitter.split(bytes) == bytes.len())
            }
            Packing::Zstd => self.zstd(&head, data, &mut splitter),
            Packing::Lz4 => lz4::Decoder::new(data)
                .map_err(cannot)
                .and_then(|unpacked| self.roll(&head, unpacked, &mut splitter)),
        };
        let fits = match unpacked {
            Err(_) if cut => return lost("its end is missing"),
            Err(why) => return Verdict::Lost(why),
            Ok(fits) => fits && splitter.pass_over == 0,
        };
        let broken = |why: &str| lost(if cut { "its end is missing" } else { why });
        let sized = splitter.total == head.uncompressed_size;
        let checked = head.crc != 0;
        if checked && splitter.crc.finalize() != head.crc {
            return broken("its checksum does not match");
        }
        if !fits {
            return broken("its records do not fit together");
        }
        if !checked && !sized {
            return lost("it does not unpack to the size that it claims");
        }
        let named = matches!(head.compression.as_str(), "" | "zstd" | "lz4");
        if sized && named && claimed == rest.len() {
            Verdict::Whole
        } else {
            Verdict::Proven(
                "a size or name in its header is wrong; its messages are kept".to_owned(),
            )
        }
    }

    fn zstd(
        &mut self,
        head: &Head,
        data: &[u8],
        splitter: &mut Splitter<impl FnMut(u8, Option<&[u8]>)>,
    ) -> Result<bool, String> {
        if (1..=MOST_ROOM).contains(&head.uncompressed_size) {
            // Straight into the room, where the chunk is as it says; else piece by piece, which tells what is wrong.
            let at_once = match &mut self.at_once {
                Some(at_once) => at_once,
                none => none.insert(Decompressor::new().map_err(cannot)?),
            };
            let length = head.uncompressed_size as usize;
            self.room.resize(self.room.len().max(length), 0);
            let room = &mut self.room[..length];
            if at_once.decompress_to_buffer(data, room).ok() == Some(length) {
                return Ok(splitter.take(&self.room[..length]) == length);
            }
        }
        let mut decoder = Decoder::with_buffer(data).map_err(cannot)?.single_frame();
        decoder.window_log_max(MOST_WINDOW_LOG).map_err(cannot)?;
        self.roll(head, decoder, splitter)
    }

    /// Unpacks through the room: what `unpacked` gives is split into records, and a record that is not whole yet moves to the front.
    ///
    /// Returns whether nothing was left over.
    fn roll(
        &mut self,
        head: &Head,
        mut unpacked: impl Read,
        splitter: &mut Splitter<impl FnMut(u8, Option<&[u8]>)>,
    ) -> Result<bool, String> {
        let most = head.uncompressed_size.saturating_add(MOST_OVERRUN);
        let most = most.min(MOST_UNPACKED);
        let room = &mut self.room;
        if room.len() < ROOM {
            *room = vec![0; ROOM];
        }
        let mut filled = 0;
        loop {
            if filled == room.len() {
                // One record is longer than the room: it is there byte by byte, so its length is no mere claim.
                if room.len() > MOST_RECORD {
                    return Err("a record in it is too long".to_owned());
                }
                room.resize(room.len() * 2, 0);
            }
            let new = unpacked.read(&mut room[filled..]).map_err(cannot)?;
            if new == 0 {
                return Ok(filled == 0);
            }
            splitter.count(&room[filled..filled + new]);
            if splitter.total > most {
                return Err("it unpacks to more than it claims".to_owned());
            }
            filled += new;
            let used = splitter.split(&room[..filled]);
            room.copy_within(used..filled, 0);
            filled -= used;
        }
    }
}

#[expect(clippy::needless_pass_by_value, reason = "what `map_err` takes")]
fn cannot(error: std::io::Error) -> String {
    format!("it cannot be unpacked ({error})")
}

/// Splits unpacked bytes into records.
struct Splitter<F> {
    each: F,
    crc: crc32fast::Hasher,
    /// Bytes still to come of a record that is passed over.
    pass_over: u64,
    total: u64,
}

impl<F: FnMut(u8, Option<&[u8]>)> Splitter<F> {
    fn count(&mut self, bytes: &[u8]) {
        self.crc.update(bytes);
        self.total += bytes.len() as u64;
    }

    /// All of an unpacked chunk; gives how many bytes belong to whole records.
    fn take(&mut self, bytes: &[u8]) -> usize {
        self.count(bytes);
        self.split(bytes)
    }

    /// Gives the whole records at the start of `bytes` and returns their length.
    fn split(&mut self, bytes: &[u8]) -> usize {
        let mut used = 0;
        loop {
            let rest = &bytes[used..];
            if self.pass_over > 0 {
                let n = self.pass_over.min(rest.len() as u64);
                self.pass_over -= n;
                used += n as usize;
                if self.pass_over > 0 {
                    return used;
                }
                continue;
            }
            let Some((&opcode, after)) = rest.split_first() else {
                return used;
            };
            let Some(length) = Fields(after).u64() else {
                return used;
            };
            if length > MOST_RECORD as u64 {
                (self.each)(opcode, None);
                self.pass_over = length;
                used += HEAD;
                continue;
            }
            let length = length as usize;
            let Some(content) = rest.get(HEAD..HEAD + length) else {
                return used;
            };
            (self.each)(opcode, Some(content));
            used += HEAD + length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chunk's content as far as its data.
    fn account(uncompressed: u64, compression: &str, compressed: u64) -> Vec<u8> {
        let mut bytes = [0_u64, 9].map(u64::to_le_bytes).concat();
        bytes.extend(uncompressed.to_le_bytes());
        bytes.extend(7_u32.to_le_bytes());
        bytes.extend((compression.len() as u32).to_le_bytes());
        bytes.extend(compression.as_bytes());
        bytes.extend(compressed.to_le_bytes());
        bytes
    }

    fn head(uncompressed: u64, compression: &str, compressed: u64) -> Head {
        Head::read(&account(uncompressed, compression, compressed)).unwrap()
    }

    #[test]
    fn an_account_is_as_long_as_it_is_and_its_content_as_it_says() {
        let found = head(100, "zstd", 40);
        assert_eq!((found.uncompressed_size, found.crc), (100, 7));
        assert_eq!(found.length(), account(100, "zstd", 40).len() as u64);
        assert_eq!(found.content_length(), Some(found.length() + 40));
        assert_eq!(head(1, "", u64::MAX).content_length(), None);
        // A name of 16 letters is one, a longer one is none.
        assert!(Head::read(&account(1, &"x".repeat(16), 1)).is_some());
        assert!(Head::read(&account(1, &"x".repeat(17), 1)).is_none());
        let short = account(100, "zstd", 40);
        assert!((0..short.len()).all(|n| Head::read(&short[..n]).is_none()));
    }

    #[test]
    fn what_is_a_chunk_by_accident_of_one_byte_is_told_by_its_account() {
        for (uncompressed, compression, compressed, telling) in [
            (100, "zstd", 40, true),
            (100, "lz4", 40, true),
            (0, "zstd", 40, false),
            (40, "", 40, true),
            (41, "", 40, false),
            (0, "", 0, false),
            (100, "gzip", 40, false),
        ] {
            let found = head(uncompressed, compression, compressed).is_telling();
            assert_eq!(found, telling, "{uncompressed} `{compression}`");
        }
    }

    #[test]
    fn a_packing_is_told_by_its_name_else_by_the_first_bytes() {
        let of = |name: &str, data: &[u8]| head(1, name, 1).packing(data);
        assert_eq!(of("", b"x"), Some(Packing::None));
        assert_eq!((of("zstd", b"x"), of("lz4", b"x")), (Some(Packing::Zstd), Some(Packing::Lz4)));
        assert_eq!(of("zst?", &[0x28, 0xb5, 0x2f, 0xfd]), Some(Packing::Zstd));
        assert_eq!(of("?", &[0x04, 0x22, 0x4d, 0x18]), Some(Packing::Lz4));
        assert_eq!(of("?", &[0x04, 0x22, 0x4d]), None);
    }

    #[test]
    fn a_whole_zstd_chunk_has_all_of_its_data_and_a_usual_size() {
        let of = |uncompressed, name: &str, compressed, data: &[u8]| {
            let content = [account(uncompressed, name, compressed), data.to_vec()].concat();
            let head = head(uncompressed, name, compressed);
            head.whole_zstd(&content).map(<[u8]>::to_vec)
        };
        assert_eq!(of(9, "zstd", 3, b"abc"), Some(b"abc".to_vec()));
        assert_eq!(of(MOST_ROOM, "zstd", 3, b"abc"), Some(b"abc".to_vec()));
        assert_eq!((of(0, "zstd", 3, b"abc"), of(MOST_ROOM + 1, "zstd", 3, b"abc")), (None, None));
        assert_eq!((of(9, "lz4", 3, b"abc"), of(9, "zstd", 4, b"abc")), (None, None));
    }
}
