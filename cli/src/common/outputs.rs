use std::path::{Path, PathBuf};

use clap::ArgMatches;
use roverlab::files::irregular;

use super::Failure;

/// Options with output files.
pub(super) const OUTPUTS: [&str; 10] =
    ["ros2", "picture", "animation", "record", "output", "lcd", "statistics", "checkpoint", "csv", "out"];

/// Fails if a file is a device or a pipe, or if an output file is also an input file, or another option's
/// output.
pub(super) fn check_outputs(matches: &ArgMatches) -> Result<(), Failure> {
    if let Some((_, matches)) = matches.subcommand() {
        return check_outputs(matches);
    }
    let files: Vec<(&str, &PathBuf)> = matches
        .ids()
        .flat_map(|id| {
            let files = matches.try_get_many::<PathBuf>(id.as_str()).ok().flatten();
            files.into_iter().flatten().map(|file| (id.as_str(), file))
        })
        .collect();
    for (_, file) in files.iter().filter(|(_, file)| !file.is_dir()) {
        if let Some(wrong) = irregular(file) {
            return Err(Failure::input(format!("{}: {wrong}; expected a regular file", file.display())));
        }
    }
    for (output, file) in files.iter().filter(|(option, _)| OUTPUTS.contains(option)) {
        let same = |(option, other): &&(&str, &PathBuf)| option != output && is_same_file(file, other);
        if let Some((option, _)) = files.iter().find(same) {
            let (file, output, option) = (file.display(), shown(output), shown(option));
            return Err(Failure::input(format!(
                "{output} {file}: found the file of {option}; expected another one"
            )));
        }
    }
    Ok(())
}

/// An option or argument as shown in the help.
fn shown(id: &str) -> String {
    if ["file", "out"].contains(&id) { format!("<{}>", id.to_uppercase()) } else { format!("--{id}") }
}

/// Whether two names refer to one file, which need not exist yet.
pub(crate) fn is_same_file(one: &Path, other: &Path) -> bool {
    place(one).is_some_and(|place_of_one| Some(place_of_one) == place(other))
}

/// Canonical path of an existing or future file.
fn place(file: &Path) -> Option<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    file.canonicalize().ok().or_else(|| Some(folder.canonicalize().ok()?.join(file.file_name()?)))
}
