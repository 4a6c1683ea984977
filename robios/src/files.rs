//! The files that a world names, for scripts that came without some of them, or from a system that does not tell small
//! letters from capital ones.

use std::io;
use std::path::{Component, Path, PathBuf};

use roverlab::world::RobotSpec;
use roverlab::world::formats::{DiskFiles, FileSource, SourceFile, robi};

use crate::walker::is_walker;

/// Files on disk, and stand-ins for those that are not there: a robot of the kind that the folder's name says, a small
/// object. A world has none, since the reader of scripts gets over that itself.
#[derive(Debug, Default)]
pub struct LenientFiles {
    disk: DiskFiles,
    /// What was not there.
    pub warnings: Vec<String>,
}

impl LenientFiles {
    /// Files on disk.
    pub fn new() -> Self {
        Self::default()
    }

    fn stand_in(&mut self, reference: &str) -> Option<Vec<u8>> {
        let name = reference.rsplit(['/', '\\']).next().unwrap_or(reference);
        let (stem, ending) = name.rsplit_once('.')?;
        let (what, text) = match ending.to_ascii_lowercase().as_str() {
            "robi" if is_walker(stem) => {
                let spec = RobotSpec { name: stem.to_owned(), ..RobotSpec::s4() };
                ("the walking robot that is built in", robi::print(&spec))
            }
            "robi" => {
                let spec = RobotSpec { name: stem.to_owned(), ..like(reference) };
                ("a robot like the built-in ones", robi::print(&spec))
            }
            "esobj" => ("a small object", String::new()),
            _ => return None,
        };
        self.warnings.push(format!("{reference} does not exist; {what} is used"));
        Some(text.into_bytes())
    }
}

/// A robot that drives as one of such a name, or from such a folder, does.
fn like(reference: &str) -> RobotSpec {
    let reference = reference.to_ascii_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| reference.contains(word));
    if says(&["ackermann", "sae", "car"]) {
        RobotSpec::car()
    } else if says(&["omni", "mecanum"]) {
        RobotSpec::omni()
    } else {
        RobotSpec::s4()
    }
}

impl FileSource for LenientFiles {
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile> {
        let missing = match self.disk.read(reference, referrer, limit) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => error,
            found => return found,
        };
        let folder = Path::new(referrer).parent().unwrap_or(Path::new("."));
        let written = PathBuf::from(reference.replace('\\', "/"));
        // As it is written but for the case, or brought along beside the script.
        let beside = written.file_name().map(PathBuf::from);
        let mut places = [Some(written), beside].into_iter().flatten();
        if let Some(found) = places.find_map(|path| in_any_case(folder, &path)) {
            return self.disk.read(&found.display().to_string(), referrer, limit);
        }
        let bytes = self.stand_in(reference).ok_or(missing)?;
        Ok(SourceFile { name: reference.to_owned(), bytes })
    }
}

/// The file of a path below a folder whose names differ at most in the case of their letters.
pub fn in_any_case(folder: &Path, path: &Path) -> Option<PathBuf> {
    let mut place = folder.to_owned();
    for part in path.components() {
        match part {
            Component::Normal(name) if !place.join(name).exists() => {
                let entries = std::fs::read_dir(&place).ok()?.filter_map(Result::ok);
                let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
                names.sort();
                let wanted = name.to_string_lossy();
                let found = names.into_iter().find(|n| n.to_string_lossy().eq_ignore_ascii_case(&wanted))?;
                place.push(found);
            }
            part => place.push(part),
        }
    }
    place.is_file().then_some(place)
}

#[cfg(test)]
mod tests {
    use roverlab::world::formats::sim;

    use super::*;

    #[test]
    fn scripts_run_without_their_files() {
        let script = "world ../worlds/Pool.wld\nrobot \"../robots/Ackermann/SAE.robi\"\nobject cone.esObj\n\
                      SAE 12500 5000 0 drive.x\ncone 100 100 0\n";
        let mut files = LenientFiles::new();
        let parsed = sim::parse_tolerantly(script, "nowhere/script.sim", &mut files).unwrap();
        let scene = parsed.value;
        assert_eq!((scene.robots.len(), scene.world.objects.len()), (1, 1));
        assert_eq!(scene.robots[0].spec.name, "SAE");
        assert!(scene.world.floor.max.x >= 13.5);
        assert_eq!(files.warnings.len(), 2);
        assert!(files.warnings[0].contains("SAE.robi does not exist"), "{:?}", files.warnings);
        let message = parsed.warnings[0].to_string();
        assert!(message.contains("`../worlds/Pool.wld`, which does not exist"), "{message}");
    }

    #[test]
    fn files_are_found_in_any_case() {
        let folder = std::env::temp_dir().join(format!("robios-files-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("Worlds")).unwrap();
        std::fs::write(folder.join("Worlds/Field.wld"), "floor 3000 2000\n").unwrap();
        let referrer = folder.join("a.sim").display().to_string();
        let mut files = LenientFiles::new();
        for name in ["worlds/field.wld", "WORLDS\\FIELD.WLD"] {
            assert_eq!(files.read(name, &referrer, 1000).unwrap().bytes, b"floor 3000 2000\n");
        }
        let referrer = folder.join("Worlds/b.sim").display().to_string();
        assert!(files.read("../../small/field.wld", &referrer, 1000).is_ok(), "it came along");
        assert!(files.warnings.is_empty());
        assert!(files.read("maze.maz", &referrer, 1000).is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
