use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::workplace::Workplace;
use crate::common::{Failure, own_program};

/// A program to grade.
#[derive(Debug, Clone)]
pub(super) struct Program {
    /// Name as given.
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone)]
pub(super) enum Kind {
    /// A program for RoBIOS: its file, and the source text that it was made of, if any.
    Robios { file: PathBuf, source: PathBuf },
    /// Command and options of `roverlab`.
    Lab(Vec<String>),
}

impl Program {
    /// A program as given on the command line.
    pub(super) fn parse(text: &str) -> Result<Self, Failure> {
        let name = text.to_owned();
        if let Some(words) = text.strip_prefix("roverlab ") {
            let kind = Kind::Lab(words.split_whitespace().map(str::to_owned).collect());
            return Ok(Self { name, kind });
        }
        let file = std::path::absolute(text).unwrap_or_else(|_| text.into());
        if !file.is_file() {
            return Err(Failure::input(format!(
                "{text}: no such file; expected a program (.c, .cpp, .py or an executable), or a command in quotes \
                 such as \"roverlab distbug\""
            )));
        }
        Ok(Self { name, kind: Kind::Robios { source: file.clone(), file } })
    }

    /// The same, compiled if it has to be, or why it cannot be.
    pub(super) fn compiled(&self, folder: &Workplace) -> Result<Self, String> {
        let Kind::Robios { source, .. } = &self.kind else { return Ok(self.clone()) };
        if !is_source(source) {
            return Ok(self.clone());
        }
        let target = folder.path().join("program.x");
        // The runner ends the compiler at its own limit.
        let output = Command::new(runner()?)
            .args([OsString::from("compile"), source.into(), target.clone().into()])
            .stdin(Stdio::null())
            .output()
            .map_err(|error| error.to_string())?;
        if output.status.success() {
            let kind = Kind::Robios { file: target, source: source.clone() };
            return Ok(Self { kind, ..self.clone() });
        }
        Err(String::from_utf8_lossy(&output.stderr).trim().to_owned())
    }
}

/// Whether a file is a source text that is compiled.
fn is_source(file: &Path) -> bool {
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ["c", "cpp", "cc", "cxx", "c++"].contains(&ending.as_str()))
}

/// The runner of programs for RoBIOS: beside this program, or in the folder above, as that of tests.
pub(super) fn runner() -> Result<PathBuf, String> {
    let own = own_program().map_err(|error| error.to_string())?;
    let name = format!("robios{}", std::env::consts::EXE_SUFFIX);
    let found = own.ancestors().skip(1).take(2).map(|folder| folder.join(&name)).find(|file| file.is_file());
    found.ok_or_else(|| {
        format!("no {name} beside {}; expected one from `cargo build -p robios`", own.display())
    })
}
