//! Checkpoints of runs on disk (feature `checkpoint`).
//!
//! ```
//! use roverlab::evolve::{Evolution, Genetic, Population, Recipe, Serial, StopRules, Trial, checkpoint};
//!
//! # fn main() -> roverlab::io::Result<()> {
//! # let (first, fitness) = (vec![vec![0_u8; 8]; 10], |genome: &Vec<u8>, _: Trial| Ok(f64::from(genome[0])));
//! let file = &std::env::temp_dir().join(format!("run-{}.json", std::process::id()));
//! // Everything that affects the run, so that checkpoints of other runs are rejected.
//! let settings = "ten individuals of eight genes, six mutations, seed 1";
//! let population = match checkpoint::load(file, settings)? {
//!     Some(population) => population,
//!     None => Population::new(first, 1)?,
//! };
//! let mut evolution = Genetic::resume(population, Recipe::book(6))?;
//! evolution.run(&mut Serial::new(fitness), &StopRules::generations(10), |now| {
//!     checkpoint::save(file, settings, now.population())
//! })?;
//! let saved: Population<Vec<u8>> = checkpoint::load(file, settings)?.expect("a checkpoint");
//! assert_eq!((saved.generation, &saved.genomes), (9, &evolution.population().genomes));
//! # std::fs::remove_file(file).expect("the checkpoint");
//! # Ok(())
//! # }
//! ```

use std::fs;
use std::io::{ErrorKind as FileError, Read};
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::files::{open_regular, write_whole};
use crate::io::{Error, ErrorKind, Result};

/// Version of the file format.
const VERSION: u32 = 1;

#[derive(Serialize, Deserialize)]
struct Checkpoint<S> {
    version: u32,
    settings: String,
    state: S,
}

/// Writes the state of a run, a [`Population`](super::Population) or more, to a file. The write is atomic:
/// even if the process is killed or the disk is full, the file holds either the old state or the new one.
///
/// # Errors
///
/// If the file cannot be written.
pub fn save<S: Serialize>(file: &Path, settings: &str, state: &S) -> Result<()> {
    let failed = |what: &str, error: std::io::Error| {
        let message = format!("{}: the checkpoint cannot be {what}", file.display());
        Error::new(ErrorKind::Other, message).with_source(error)
    };
    let checkpoint = Checkpoint { version: VERSION, settings: settings.into(), state };
    let text = serde_json::to_vec(&checkpoint).map_err(|error| failed("written", error.into()))?;
    // Replace the target of a symbolic link, not the link.
    let file = &fs::canonicalize(file).unwrap_or_else(|_| file.to_owned());
    write_whole(file, &text).map_err(|error| failed("written", error))
}

/// Reads a state written by [`save`]; `None` if there is no such file.
///
/// # Errors
///
/// If the file has another format or version, or belongs to a run with other settings.
pub fn load<S: DeserializeOwned>(file: &Path, settings: &str) -> Result<Option<S>> {
    let refused = |found: &str, expected: &str| {
        let message = format!("{}: {found}; expected {expected}", file.display());
        Error::new(ErrorKind::InvalidInput, message)
    };
    let mut text = Vec::new();
    match open_regular(file).and_then(|mut file| file.read_to_end(&mut text)) {
        Err(error) if error.kind() == FileError::NotFound => return Ok(None),
        Err(error) => return Err(refused(&error.to_string(), "a file that can be read")),
        Ok(_) => {}
    }
    let parsed: std::result::Result<Checkpoint<serde_json::Value>, _> = serde_json::from_slice(&text);
    let checkpoint = parsed.map_err(|error| {
        let place = format!("{}:{}:{}", file.display(), error.line(), error.column());
        Error::new(ErrorKind::InvalidInput, format!("{place}: {error}; expected a whole checkpoint"))
    })?;
    if checkpoint.version != VERSION {
        let found = format!("version {} of checkpoints", checkpoint.version);
        return Err(refused(&found, &format!("version {VERSION}")));
    }
    if checkpoint.settings != settings {
        return Err(refused(&format!("a run with {}", checkpoint.settings), &format!("one with {settings}")));
    }
    let state = serde_json::from_value(checkpoint.state)
        .map_err(|error| refused(&error.to_string(), "the state of such a run"))?;
    Ok(Some(state))
}

#[cfg(test)]
mod tests {
    use super::super::{Evolution, Genetic, Population, Recipe, Serial, StopRules, Trial};
    use super::*;
    use std::path::PathBuf;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("roverlab-checkpoint-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn evolved(generations: u64) -> Genetic<Vec<f64>> {
        let recipe = Recipe {
            selection: super::super::Selection::Wheel,
            crossover: Box::new(super::super::Arithmetic),
            mutation: Box::new(super::super::Gaussian { probability: 0.5, sigma: 0.1, low: -9.0, high: 9.0 }),
            elite: 1,
        };
        let mut evolution = Genetic::new(vec![vec![0.1, -1.0 / 3.0]; 6], recipe, 1).unwrap();
        let sum = |genome: &Vec<f64>, _: Trial| Ok(genome.iter().sum());
        evolution.run(&mut Serial::new(sum), &StopRules::generations(generations), |_| Ok(())).unwrap();
        evolution
    }

    #[test]
    fn what_is_saved_comes_back_to_the_bit() {
        let folder = folder("roundtrip");
        let file = folder.join("run.json");
        assert_eq!(load::<Population<Vec<f64>>>(&file, "a").unwrap(), None);
        let evolution = evolved(12);
        save(&file, "a", evolution.population()).unwrap();
        let back: Population<Vec<f64>> = load(&file, "a").unwrap().unwrap();
        assert_eq!(&back, evolution.population());
        assert_eq!(back.hash(), evolution.population().hash());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "no temporary file is left");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn other_files_are_refused_with_a_reason() {
        let folder = folder("refused");
        let file = folder.join("run.json");
        save(&file, "a", evolved(3).population()).unwrap();
        let message = |settings: &str| {
            let error = load::<Population<Vec<f64>>>(&file, settings).unwrap_err();
            error.to_string().replace(&file.display().to_string(), "FILE")
        };
        assert_eq!(message("b"), "FILE: a run with a; expected one with b");
        let whole = fs::read_to_string(&file).unwrap();
        fs::write(&file, &whole[..100]).unwrap();
        assert!(message("a").starts_with("FILE:1:100: EOF while parsing"), "{}", message("a"));
        fs::write(&file, whole.replace("version\":1", "version\":2")).unwrap();
        assert_eq!(message("a"), "FILE: version 2 of checkpoints; expected version 1");
        fs::write(&file, whole.replace("genomes", "gnomes")).unwrap();
        assert!(message("a").contains("missing field `genomes`"), "{}", message("a"));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let error = save(Path::new("/no/such/folder/run.json"), "a", &1).unwrap_err();
        assert_eq!(error.to_string(), "/no/such/folder/run.json: the checkpoint cannot be written");
    }
}
