use std::collections::BTreeMap;
use std::io;

/// The version of what recordings hold. A recording of a newer one is refused.
pub const SCHEMA_VERSION: u32 = 1;

/// The name of the MCAP metadata record that makes a file a recording of this project.
pub(super) const METADATA: &str = "roverlab";
/// How files of ours name what wrote them.
pub(super) const LIBRARY: &str = "roverlab";

/// The name of the field that guards the others: MCAP has checksums of chunks and attachments, but none of metadata.
const CHECKSUM: &str = "checksum";

/// What a recording says about the run: enough to run the program again.
///
/// It holds nothing about where and when a run took place: no names of files, no dates.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    /// The program's name.
    pub program: String,
    /// The options that affect the run, as on a command line.
    pub options: Vec<String>,
    /// The seed of every random stream.
    pub seed: Option<u64>,
    /// The version of this crate that made the recording; a new header has the present one.
    pub version: String,
    /// How the file's chunks are packed.
    pub compression: Compression,
    /// Files that belong to the run, such as its world, with their whole contents.
    pub attachments: Vec<Attachment>,
}

/// How the chunks of a recording are packed. Files are many times smaller so, and are written more slowly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Compression {
    /// Not at all.
    #[default]
    None,
    /// By LZ4, which is fast. For builds with the feature `lz4`.
    Lz4,
    /// By Zstandard, which packs more densely. For builds with the feature `zstd`.
    Zstd,
}

impl Compression {
    /// Each compression with its name in MCAP files.
    const ALL: [(Self, &'static str); 3] = [(Self::None, ""), (Self::Lz4, "lz4"), (Self::Zstd, "zstd")];

    /// Its name in files; empty for none.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, name)| *name)
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, other)| *other == name).map(|(kind, _)| *kind)
    }

    /// What the writer of files calls it. Fails if this build cannot pack so.
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

/// A file in a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// What it is: `world.wld`, say.
    pub name: String,
    /// Its type, as on the web: `text/plain`, say.
    pub media_type: String,
    /// What it holds.
    pub data: Vec<u8>,
}

/// What the metadata record of a file says.
pub(super) struct Written {
    /// The header without its attachments.
    pub(super) header: Header,
    /// The version of its schema.
    pub(super) schema: u32,
    /// The digest of the attachments.
    pub(super) digest: u64,
}

impl Header {
    /// The header of a program's run with some options.
    pub fn new(program: impl Into<String>, options: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            program: program.into(),
            options: options.into_iter().map(Into::into).collect(),
            version: env!("CARGO_PKG_VERSION").into(),
            ..Self::default()
        }
    }

    /// A digest of all attachments, their names included: of the world and the robots.
    pub fn digest(&self) -> u64 {
        digest(self.attachments.iter().flat_map(|file| [file.name.as_bytes(), &file.data]))
    }

    /// The text of the MCAP metadata record.
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

    /// What a metadata record says; `None` if it is not as it was written.
    pub(super) fn read(fields: &BTreeMap<String, String>) -> Option<Written> {
        let schema = fields.get("schema")?.parse().ok()?;
        match fields.get(CHECKSUM) {
            Some(written) if *written != checksum(fields) => return None,
            // Newer schemas may do without.
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

    /// An attachment by its name.
    pub fn attachment(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().find(|attachment| attachment.name == name)
    }
}

/// The 64-bit FNV-1a digest (Fowler, Noll and Vo) of some parts, with the length ahead of each.
fn digest<'a>(parts: impl Iterator<Item = &'a [u8]>) -> u64 {
    let with_length =
        parts.flat_map(|part| (part.len() as u64).to_le_bytes().into_iter().chain(part.iter().copied()));
    with_length.fold(0xcbf2_9ce4_8422_2325, |digest: u64, byte| {
        (digest ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// What the field [`CHECKSUM`] says of all others.
fn checksum(fields: &BTreeMap<String, String>) -> String {
    let others = fields.iter().filter(|(name, _)| *name != CHECKSUM);
    format!("{:016x}", digest(others.flat_map(|(name, value)| [name.as_bytes(), value.as_bytes()])))
}
