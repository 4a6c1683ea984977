use std::fs;
use std::path::Path;

use roverlab::files::write_whole;
use roverlab::world::formats::sim::{self, SimFile};
use roverlab::world::formats::wld;

use super::trial::{Run, Trial, scene};
use crate::common::Failure;

/// Creates the folder before a long campaign.
pub(super) fn prepare(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| {
        let name = folder.display();
        Failure::input(format!("--save {name}: {error}; expected a folder that can be written to"))
    })
}

/// Writes the courses of failed runs: `course-SEED.sim`, which the command `distbug` can run, and the
/// `course-SEED.wld` that it names.
pub(super) fn failures(trials: &[Trial], folder: &Path) -> Result<(), Failure> {
    trials
        .iter()
        .filter(|trial| !trial.runs.iter().all(Run::is_clean))
        .try_for_each(|trial| save(trial, folder))
}

/// Writes one course.
pub(crate) fn save(trial: &Trial, folder: &Path) -> Result<(), Failure> {
    let name = format!("course-{}", trial.seed);
    let world = format!("{name}.wld");
    let scene = scene(trial.seed)?;
    let script = sim::print(&SimFile::for_scene(&scene, &world));
    write(&folder.join(&world), &wld::print(&scene.world))?;
    write(&folder.join(format!("{name}.sim")), &script)
}

fn write(file: &Path, text: &str) -> Result<(), Failure> {
    write_whole(file, text.as_bytes()).map_err(|error| Failure::run(format!("{}: {error}", file.display())))
}
