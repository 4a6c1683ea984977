use std::env;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Where a runner that is part of another program has its files.
#[derive(Debug, Clone)]
pub struct Place {
    /// The file by which the runner is started.
    pub program: PathBuf,
    /// Folder with `include`, `bin`, `python`, and `lib` with the library.
    pub home: PathBuf,
}

static PLACE: OnceLock<Place> = OnceLock::new();

/// Sets the place of this process. The first one counts.
pub(super) fn set(place: Place) {
    let _ = PLACE.set(place);
}

/// The file by which the runner is started.
pub(crate) fn program() -> Result<PathBuf, String> {
    match PLACE.get() {
        Some(place) => Ok(place.program.clone()),
        None => env::current_exe().map_err(|error| error.to_string()),
    }
}

/// Headers, scripts and Python modules: at the set place, above this program's folder, or in the project.
pub(crate) fn home() -> Result<PathBuf, String> {
    let places = if let Some(place) = PLACE.get() {
        vec![place.home.clone()]
    } else {
        let installed = env::current_exe().ok().and_then(|file| Some(file.parent()?.parent()?.to_owned()));
        installed.into_iter().chain([PathBuf::from(env!("CARGO_MANIFEST_DIR"))]).collect()
    };
    let is_home =
        |place: &&PathBuf| place.join("include/eyebot.h").is_file() && place.join("bin/gccsim").is_file();
    let found = places.iter().find(is_home).cloned();
    found.ok_or_else(|| {
        "no folder with include/eyebot.h and bin/gccsim; expected one above this program's".into()
    })
}

/// The library: at the set place, beside this program, in the project or in an installation. The newest one
/// is used: `cargo test` builds one without replacing that of `cargo build`.
pub(crate) fn library() -> Result<PathBuf, String> {
    let name = if cfg!(target_os = "macos") { "libeyesim.dylib" } else { "libeyesim.so" };
    let program = program()?;
    let folder = program.parent().unwrap_or(Path::new("."));
    let places = match PLACE.get() {
        Some(place) => vec![place.home.join("lib")],
        None => vec![folder.to_owned(), folder.join("deps"), folder.join("../lib"), folder.join("..")],
    };
    let files = places.iter().map(|place| place.join(name));
    let built = files.filter_map(|file| Some((file.metadata().ok()?.modified().ok()?, file)));
    built.max().map(|(_, file)| file).ok_or_else(|| {
        format!("no {name} beside {}; expected one from `cargo build -p robios`", program.display())
    })
}
