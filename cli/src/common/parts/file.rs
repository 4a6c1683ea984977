use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use roverlab::files::{open_regular, write_whole};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Part, Portable};
use crate::common::{Facts, Failure, regular_bytes};

/// The first line of a part's file: which part of which campaign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Header {
    /// Version of the format.
    roverlab_part: u32,
    /// Version of the program.
    version: String,
    /// Name of the command, with underscores.
    pub(crate) command: String,
    /// The options that decide about results, in the command's order.
    pub(crate) options: Vec<String>,
    /// The part, K/N.
    part: String,
    /// Number of runs of the whole campaign.
    runs: u64,
    /// Checksums of input files, by option.
    files: BTreeMap<String, String>,
}

/// Version of the format.
const FORMAT: u32 = 1;
/// Length up to which a line is read or written (bytes).
const LONGEST: u64 = 1 << 20;
/// Number of missing parts that an error names.
const NAMED: usize = 8;

/// A line of results.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    /// Index in the campaign, from 0 on.
    run: u64,
    result: Value,
}

impl Header {
    /// The header of a run's part.
    pub(crate) fn new(facts: &Facts, part: Part, runs: u64) -> Result<Self, Failure> {
        let mut files = BTreeMap::new();
        for (option, file) in &facts.inputs {
            let bytes = regular_bytes(file).map_err(|error| {
                Failure::input(format!("--{option} {}: {error}; expected a file", file.display()))
            })?;
            files.insert(option.clone(), format!("{:016x}", checksum(&bytes)));
        }
        Ok(Self {
            roverlab_part: FORMAT,
            version: env!("CARGO_PKG_VERSION").into(),
            command: facts.program.clone(),
            options: facts.settings.clone(),
            part: part.to_string(),
            runs,
            files,
        })
    }

    /// The header of a file.
    pub(crate) fn read(file: &Path) -> Result<Self, Failure> {
        Lines::open(file)?.header()
    }

    /// Fails, in words, if a part of a campaign with this header cannot belong to another one.
    fn check_same(&self, other: &Self) -> Result<(), String> {
        let differs = |what: &str, found: &dyn std::fmt::Display, expected: &dyn std::fmt::Display| {
            Err(format!("found {what} {found}; expected {expected}"))
        };
        let words = |options: &[String]| format!("`{}`", options.join(" "));
        let files = |files: &BTreeMap<String, String>| {
            let list = files.iter().map(|(option, sum)| format!("--{option} {sum}")).collect::<Vec<_>>();
            if list.is_empty() { "none".to_owned() } else { list.join(", ") }
        };
        match () {
            () if other.version != self.version => {
                differs("results of version", &other.version, &self.version)
            }
            () if other.command != self.command => {
                differs("results of the command", &other.command, &self.command)
            }
            () if other.options != self.options => {
                differs("results with the options", &words(&other.options), &words(&self.options))
            }
            () if other.files != self.files => {
                differs("input files with the checksums", &files(&other.files), &files(&self.files))
            }
            () if other.runs != self.runs => {
                differs("a campaign of", &format_args!("{} runs", other.runs), &self.runs)
            }
            () => Ok(()),
        }
    }
}

/// FNV-1a of some bytes. It tells files apart, and protects against nobody.
fn checksum(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The file of a part: a header, and a line for each run.
#[derive(Debug)]
pub(crate) struct PartFile<'a> {
    pub(crate) file: &'a Path,
    pub(crate) header: Header,
}

impl PartFile<'_> {
    /// Writes the results of the part. The file is complete, or not there.
    pub(crate) fn write<T: Portable>(&self, results: &[T]) -> Result<(), Failure> {
        let failed = |error: String| {
            Failure::run(format!("--out {}: {error}; expected to save the results", self.file.display()))
        };
        let part = self.header.part.parse::<Part>().map_err(failed)?;
        let mut text = line(&self.header).map_err(failed)?;
        for (index, result) in (0..).zip(results) {
            let result = result.packed();
            T::unpacked(&result).map_err(|error| failed(format!("found a result that is lost: {error}")))?;
            text.push_str(&line(&Line { run: part.run(index), result }).map_err(failed)?);
        }
        write_whole(self.file, text.as_bytes()).map_err(|error| failed(format!("found {error}")))
    }

    /// The results of all parts of a campaign, in the order of its runs. `own` is the header that a campaign
    /// in one part has.
    pub(crate) fn collect<T: Portable>(files: &[PathBuf], own: &Header) -> Result<Vec<T>, Failure> {
        let parts = parts(files, own)?;
        let of = parts.len() as u64;
        let mut readers = Vec::new();
        for (number, file) in (1..).zip(parts) {
            readers.push(results::<T>(file, Part { number, of }, own.runs)?.into_iter());
        }
        let taken = (0..own.runs).map_while(|run| readers[(run % of) as usize].next());
        Ok(taken.collect())
    }
}

fn line(value: &impl Serialize) -> Result<String, String> {
    let text = serde_json::to_string(value).map_err(|error| format!("found {error}"))? + "\n";
    if text.len() as u64 <= LONGEST {
        Ok(text)
    } else {
        Err(format!("found a line of {} bytes, more than the {LONGEST} that are read", text.len()))
    }
}

/// The files in the order of their parts: all parts of one campaign, each once.
fn parts<'a>(files: &'a [PathBuf], own: &Header) -> Result<Vec<&'a Path>, Failure> {
    let mut found: BTreeMap<u64, &Path> = BTreeMap::new();
    let mut all = None;
    for file in files {
        let refused = |message: String| refused(file, 1, &message);
        let header = Header::read(file)?;
        own.check_same(&header).map_err(refused)?;
        let part: Part =
            header.part.parse().map_err(|error| refused(format!("part {:?}: {error}", header.part)))?;
        let of = *all.get_or_insert(part.of);
        if part.of != of {
            return Err(refused(format!(
                "found part {part}; expected one of {of} parts, as in {}",
                files[0].display()
            )));
        }
        if let Some(other) = found.insert(part.number, file) {
            return Err(refused(format!(
                "found part {part} again; expected another one than in {}",
                other.display()
            )));
        }
    }
    let all = all.unwrap_or_default();
    let missing: Vec<String> = (1..=all)
        .filter(|number| !found.contains_key(number))
        .map(|number| format!("{number}/{all}"))
        .take(NAMED)
        .collect();
    if missing.is_empty() {
        return Ok(found.into_values().collect());
    }
    Err(Failure::input(format!(
        "{}: found {} of {all} parts; expected part {} as well",
        files[0].display(),
        found.len(),
        missing.join(", ")
    )))
}

/// The results of a part.
fn results<T: Portable>(file: &Path, part: Part, runs: u64) -> Result<Vec<T>, Failure> {
    let mut lines = Lines::open(file)?;
    lines.header()?;
    let mut results = Vec::new();
    for run in (0..part.runs(runs)).map(|index| part.run(index)) {
        let Some(Line { run: found, result }) = lines.next::<Line>("a result")? else {
            return Err(
                lines.refused(&format!("found the end of the file; expected the result of run {run}"))
            );
        };
        if found != run {
            return Err(
                lines.refused(&format!("found the result of run {found}; expected that of run {run}"))
            );
        }
        results.push(T::unpacked(&result).map_err(|error| lines.refused(&format!("result: {error}")))?);
    }
    match lines.next::<Value>("a result")? {
        Some(_) => Err(lines.refused("found another line; expected the end of the file")),
        None => Ok(results),
    }
}

fn refused(file: &Path, line: u64, message: &str) -> Failure {
    Failure::input(format!("{}: line {line}: {message}", file.display()))
}

/// The lines of a file, none of which is long.
struct Lines<'a> {
    file: &'a Path,
    reader: BufReader<File>,
    number: u64,
}

impl<'a> Lines<'a> {
    fn open(file: &'a Path) -> Result<Self, Failure> {
        let reader = BufReader::new(open_regular(file).map_err(|error| {
            Failure::input(format!(
                "{}: {error}; expected a file that --part and --out wrote",
                file.display()
            ))
        })?);
        Ok(Self { file, reader, number: 0 })
    }

    fn refused(&self, message: &str) -> Failure {
        refused(self.file, self.number, message)
    }

    fn header(&mut self) -> Result<Header, Failure> {
        let header = self.next::<Header>("the header of a part of a campaign")?;
        let header = header.ok_or_else(|| {
            self.refused("found an empty file; expected the header of a part of a campaign")
        })?;
        if header.roverlab_part == FORMAT {
            return Ok(header);
        }
        let found = header.roverlab_part;
        Err(self.refused(&format!("found version {found} of the format; expected version {FORMAT}")))
    }

    /// The next line, as JSON; `None` at the end of the file.
    fn next<T: serde::de::DeserializeOwned>(&mut self, what: &str) -> Result<Option<T>, Failure> {
        self.number += 1;
        let mut line = Vec::new();
        let read = (&mut self.reader).take(LONGEST + 1).read_until(b'\n', &mut line);
        let length = read.map_err(|error| self.refused(&format!("found {error}; expected {what}")))?;
        if length as u64 > LONGEST {
            let message = format!("found a line of more than {LONGEST} bytes; expected {what}");
            return Err(self.refused(&message));
        }
        if line.is_empty() {
            return Ok(None);
        }
        let parsed = serde_json::from_slice(&line);
        parsed.map(Some).map_err(|error| self.refused(&format!("found no JSON of {what} ({error})")))
    }
}
