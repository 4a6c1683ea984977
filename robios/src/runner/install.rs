use std::fs;
use std::path::Path;

use super::place::{home, library, program};

/// Copies the library under both names, headers, scripts, Python modules and the runner to a folder.
pub(super) fn install(folder: &Path) -> Result<(), String> {
    let (home, library) = (home()?, library()?);
    let failed = |what: &Path, error: &std::io::Error| format!("{}: {error}", what.display());
    for part in ["include", "include/X11", "bin", "python"] {
        let (from, to) = (home.join(part), folder.join(part));
        fs::create_dir_all(&to).map_err(|error| failed(&to, &error))?;
        for entry in fs::read_dir(&from).map_err(|error| failed(&from, &error))? {
            let entry = entry.map_err(|error| failed(&from, &error))?;
            if entry.path().is_file() {
                let target = to.join(entry.file_name());
                fs::copy(entry.path(), &target).map_err(|error| failed(&target, &error))?;
            }
        }
    }
    let lib = folder.join("lib");
    fs::create_dir_all(&lib).map_err(|error| failed(&lib, &error))?;
    let name = library.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    for name in [name.clone(), name.replace("eyesim", "eyebot")] {
        let target = lib.join(name);
        fs::copy(&library, &target).map_err(|error| failed(&target, &error))?;
    }
    let program = program()?;
    let target = folder.join("bin/robios");
    fs::copy(&program, &target).map_err(|error| failed(&target, &error))?;
    Ok(())
}
