//! Writes a recording.

use crate::error::BagError;
use mcap::{Attachment, Compression, McapError, WriteOptions, records, write::NoSeek};
use std::{
    collections::BTreeMap,
    fmt,
    io::{BufWriter, Write},
};

/// How hard zstd tries: its quickest usual level, by which 96 logs of ten minutes are no larger than by the third (150 MB).
const LEVEL: u32 = 1;

/// A recording under way: zstd chunks, a checksum each, an index. The same calls give the same bytes.
pub struct Writer<W: Write> {
    /// Gathers the small pieces that records are written in; a chunk is one piece.
    out: mcap::Writer<NoSeek<BufWriter<W>>>,
}

impl<W: Write> fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Writer").finish_non_exhaustive()
    }
}

fn failed(source: McapError) -> BagError {
    BagError::Write { source }
}

impl<W: Write> Writer<W> {
    /// Begins a recording of ROS 2 messages, or of others; `library` is who writes it.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn new(out: W, library: &str) -> Result<Self, BagError> {
        let out = WriteOptions::new()
            .profile("ros2")
            .library(library)
            .compression(Some(Compression::Zstd))
            .compression_level(LEVEL)
            // More threads would be faster, but the bytes would depend on them.
            .compression_threads(0)
            // A chunk goes out whole: no head of it is written twice.
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(out)))
            .map_err(failed)?;
        Ok(Self { out })
    }

    /// Writes named texts, where they stand when they are written.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn metadata(
        &mut self,
        name: &str,
        values: BTreeMap<String, String>,
    ) -> Result<(), BagError> {
        let record = records::Metadata { name: name.to_owned(), metadata: values };
        self.out.write_metadata(&record).map_err(failed)
    }

    /// Attaches a file, where it stands when it is written.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> Result<(), BagError> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: data.into(),
        };
        self.out.attach(&attachment).map_err(failed)
    }

    /// Declares a channel and gives its number: the encoding of its messages (`cdr`, `json`, …), and name, encoding
    /// (`ros2msg`, `protobuf`, …) and text, or descriptors, of its schema.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn channel(
        &mut self,
        topic: &str,
        encoding: &str,
        (name, schema_encoding, data): (&str, &str, impl AsRef<[u8]>),
    ) -> Result<u16, BagError> {
        let schema = self.out.add_schema(name, schema_encoding, data.as_ref());
        let schema = schema.map_err(failed)?;
        let channel = self.out.add_channel(schema, topic, encoding, &BTreeMap::new());
        channel.map_err(failed)
    }

    /// Writes a message of a channel, received and published at `time_ns`.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn message(
        &mut self,
        channel: u16,
        sequence: u32,
        time_ns: u64,
        bytes: &[u8],
    ) -> Result<(), BagError> {
        let head = records::MessageHeader {
            channel_id: channel,
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.out.write_to_known_channel(&head, bytes).map_err(failed)
    }

    /// Ends the recording with its summary and gives back what it was written to.
    ///
    /// # Errors
    /// [`BagError::Write`].
    pub fn finish(mut self) -> Result<W, BagError> {
        self.out.finish().map_err(failed)?;
        let out = self.out.into_inner().into_inner().into_inner();
        out.map_err(|e| failed(McapError::Io(e.into_error())))
    }
}
