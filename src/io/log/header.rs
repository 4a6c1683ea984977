use std::collections::BTreeMap;
use std::io;

/// Schema version of recordings. Newer recordings are rejected.
pub const SCHEMA_VERSION: u32 = 1;

/// Name of the MCAP metadata record that identifies a recording of this project.
pub(super) const METADATA: &str = "roverlab";
/// Library name in this project's files.
pub(super) const LIBRARY: &str = "roverlab";

/// Field with the checksum of the others: MCAP has checksums of chunks and attachments, but not of metadata.
const CHECKSUM: &str = "checksum";

/// Description of a run, sufficient to run the program again.
///
/// It contains nothing about place and date of a run: no file names, no dates.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    /// Name of the program.
    pub program: String,
    /// Command-line options that affect the run.
    pub options: Vec<String>,
    /// Seed of all random streams.
    pub seed: Option<u64>,
    /// Version of this crate that made the recording; the current one in a new header.
    pub version: String,
    /// Compression of the file's chunks.
    pub compression: Compression,
    /// Files that belong to the run, such as its world, with their full content.
    pub attachments: Vec<Attachment>,
}

/// Compression of a recording's chunks. Compressed files are many times smaller and slower to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Compression {
    /// No compression.
    #[default]
    None,
    /// LZ4, which is fast. Needs the feature `lz4`.
    Lz4,
    /// Zstandard, which compresses more. Needs the feature `zstd`.
    Zstd,
}

impl Compression {
    /// Each compression with its name in MCAP files.
    const ALL: [(Self, &'static str); 3] = [(Self::None, ""), (Self::Lz4, "lz4"), (Self::Zstd, "zstd")];

    /// Name in files; empty for none.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| *name)
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, other)| *other == name).map(|(kind, _)| *kind)
    }

    /// The writer's setting. Fails if this build lacks the compression.
    pub(super) fn method(self) -> io::Result<Option<mcap::Compression>> {
        match self {
            Self::None => Ok(None),
            #[cfg(feature = "lz4")]
            Self::Lz4 => Ok(Some(mcap::Compression::Lz4)),
            #[cfg(feature = "zstd")]
            Self::Zstd => Ok(Some(mcap::Compression::Zstd)),
            #[allow(unreachable_patterns, reason = "a build may have all features")]
            other => Err(io::Error::new(
                io::ErrorKind::Unsupported,
                format!("this build lacks the feature `{}`, which packs recordings", other.name()),
            )),
        }
    }
}

/// A file attached to a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Name, such as `world.wld`.
    pub name: String,
    /// Media type, such as `text/plain`.
    pub media_type: String,
    /// Content.
    pub data: Vec<u8>,
}

/// Content of a file's metadata record.
pub(super) struct Written {
    /// Header without its attachments.
    pub(super) header: Header,
    /// Schema version.
    pub(super) schema: u32,
    /// Digest of the attachments.
    pub(super) digest: u64,
}

impl Header {
    /// Creates the header of a program's run with its options.
    pub fn new(program: impl Into<String>, options: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            program: program.into(),
            options: options.into_iter().map(Into::into).collect(),
            version: env!("CARGO_PKG_VERSION").into(),
            ..Self::default()
        }
    }

    /// Digest of all attachments and their names, which identifies world and robots.
    pub fn digest(&self) -> u64 {
        digest(self.attachments.iter().flat_map(|file| [file.name.as_bytes(), &file.data]))
    }

    /// Fields of the MCAP metadata record.
    pub(super) fn metadata(&self) -> BTreeMap<String, String> {
        let mut fields = BTreeMap::from([
            ("schema".to_owned(), SCHEMA_VERSION.to_string()),
            ("version".to_owned(), self.version.clone()),
            ("program".to_owned(), self.program.clone()),
            ("attachments".to_owned(), format!("{:016x}", self.digest())),
        ]);
        if self.compression != Compression::None {
            fields.insert("compression".to_owned(), self.compression.name().to_owned());
        }
        if let Some(seed) = self.seed {
            fields.insert("seed".to_owned(), seed.to_string());
        }
        for (index, option) in self.options.iter().enumerate() {
            fields.insert(format!("option {index:06}"), option.clone());
        }
        fields.insert(CHECKSUM.to_owned(), checksum(&fields));
        fields
    }

    /// Parses a metadata record; `None` if it is damaged.
    pub(super) fn read(fields: &BTreeMap<String, String>) -> Option<Written> {
        let schema = fields.get("schema")?.parse().ok()?;
        match fields.get(CHECKSUM) {
            Some(written) if *written != checksum(fields) => return None,
            // Newer schemas may lack it.
            None if schema <= SCHEMA_VERSION => return None,
            _ => {}
        }
        let options =
            fields.range("option ".to_owned()..).take_while(|(name, _)| name.starts_with("option "));
        let header = Self {
            program: fields.get("program").cloned().unwrap_or_default(),
            options: options.map(|(_, option)| option.clone()).collect(),
            seed: fields.get("seed").and_then(|seed| seed.parse().ok()),
            version: fields.get("version").cloned().unwrap_or_default(),
            compression: fields
                .get("compression")
                .and_then(|name| Compression::named(name))
                .unwrap_or_default(),
            attachments: Vec::new(),
        };
        let digest = fields.get("attachments").and_then(|digits| u64::from_str_radix(digits, 16).ok());
        Some(Written { header, schema, digest: digest.unwrap_or_default() })
    }

    /// The attachment with this name.
    pub fn attachment(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().find(|attachment| attachment.name == name)
    }
}

/// The 64-bit FNV-1a digest (Fowler, Noll and Vo) of several parts, each preceded by its length.
fn digest<'a>(parts: impl Iterator<Item = &'a [u8]>) -> u64 {
    let with_length =
        parts.flat_map(|part| (part.len() as u64).to_le_bytes().into_iter().chain(part.iter().copied()));
    with_length.fold(0xcbf2_9ce4_8422_2325, |digest: u64, byte| {
        (digest ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// Value of the field [`CHECKSUM`] for all other fields.
fn checksum(fields: &BTreeMap<String, String>) -> String {
    let others = fields.iter().filter(|(name, _)| *name != CHECKSUM);
    format!("{:016x}", digest(others.flat_map(|(name, value)| [name.as_bytes(), value.as_bytes()])))
}
