use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use roverlab::world::Scene;

use super::options::{Options, ends_in, whole};
use super::work_folder::WorkFolder;

/// A program and the robot that it drives.
#[derive(Debug)]
pub(crate) struct Program {
    /// As it was named.
    pub(crate) name: String,
    /// The robot's index in the scene.
    pub(crate) robot: usize,
    /// The file that is executed, or why there is none.
    pub(crate) file: Result<PathBuf, String>,
    /// Where it runs: in its own folder.
    pub(crate) folder: PathBuf,
    pub(crate) arguments: Vec<String>,
    /// Whether it gets the keys that somebody types.
    pub(crate) is_first: bool,
}

/// The programs of a run.
pub(crate) fn of(options: &Options, scene: &Scene, folder: &WorkFolder) -> Result<Vec<Program>, String> {
    if !options.is_script() {
        if !options.program.is_file() {
            let program = options.program.display();
            return Err(format!(
                "{program}: no such file; expected a program, .py, .c, .cpp, or a script, .sim"
            ));
        }
        let name = options.program.display().to_string();
        let alone = program(&name, &whole(&options.program), 0, options, folder);
        return Ok(vec![Program { is_first: true, ..alone }]);
    }
    let base = whole(&options.program);
    let base = base.parent().unwrap_or(Path::new("/"));
    let named =
        scene.robots.iter().enumerate().filter_map(|(robot, placed)| Some((robot, placed.program.as_ref()?)));
    let mut programs: Vec<Program> = named
        .map(|(robot, name)| program(name, &base.join(name.replace('\\', "/")), robot, options, folder))
        .collect();
    let Some(first) = programs.first_mut() else {
        let script = options.program.display();
        return Err(format!(
            "{script}: no robot has a program; expected a line such as `S4 500 500 0 program.x`"
        ));
    };
    first.is_first = true;
    Ok(programs)
}

fn program(name: &str, path: &Path, robot: usize, options: &Options, folder: &WorkFolder) -> Program {
    let found = source(path).unwrap_or_else(|| path.to_owned());
    let file = if !found.is_file() {
        Err(format!("{}: no such file; expected a program, or its source text beside it", path.display()))
    } else if is_source(&found) {
        compile(&found, folder, robot)
    } else {
        Ok(found.clone())
    };
    Program {
        name: name.to_owned(),
        robot,
        file,
        folder: found.parent().map_or_else(|| PathBuf::from("/"), Path::to_owned),
        arguments: options.arguments.clone(),
        is_first: false,
    }
}

const C: [&str; 1] = ["c"];
const CPP: [&str; 4] = ["cpp", "cc", "cxx", "c++"];

fn is_source(file: &Path) -> bool {
    C.iter().chain(&CPP).any(|ending| ends_in(file, ending))
}

/// The program's file, or the source text of one that is not compiled, or only for other systems.
fn source(path: &Path) -> Option<PathBuf> {
    let usable = path.is_file() && (is_source(path) || ends_in(path, "py") || starts_here(path));
    if usable {
        return Some(path.to_owned());
    }
    let endings = C.iter().chain(&CPP).chain(&["py"]);
    let beside = endings.map(|ending| path.with_extension(ending)).find(|file| file.is_file());
    beside.or_else(|| only_source(path.parent()?))
}

/// The source text of a folder that has only one: programs are often named otherwise than what they are made of.
fn only_source(folder: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    let mut sources = files.filter(|file| is_source(file));
    let first = sources.next()?;
    sources.next().is_none().then_some(first)
}

/// Whether this system can start a file: it is a program of its own format, or a script that says by what.
fn starts_here(path: &Path) -> bool {
    let mut magic = [0; 4];
    let read = std::fs::File::open(path).and_then(|mut file| std::io::Read::read(&mut file, &mut magic));
    read.is_ok() && (magic == *b"\x7fELF" || magic[..2] == *b"#!" || !cfg!(target_os = "linux"))
}

/// Compiles a program with the script that is meant for it, with the other source texts that it needs.
fn compile(source: &Path, folder: &WorkFolder, robot: usize) -> Result<PathBuf, String> {
    let program = folder.file(&format!("program{robot}.x"));
    let Some(message) = compile_files(&[source.to_owned()], &program)? else { return Ok(program) };
    let mut files = vec![source.to_owned()];
    companions(source, &mut files, MOST_HEADERS);
    if files.len() > 1
        && message.contains("undefined reference")
        && compile_files(&files, &program)?.is_none()
    {
        return Ok(program);
    }
    let first = message.lines().find(|line| line.contains("error")).or(message.lines().next());
    Err(format!("{}: does not compile: {}", source.display(), first.unwrap_or("the compiler says nothing")))
}

/// Compiles files into a program. Returns what the compiler says if it fails.
fn compile_files(files: &[PathBuf], program: &Path) -> Result<Option<String>, String> {
    let is_cpp = files.iter().any(|file| CPP.iter().any(|ending| ends_in(file, ending)));
    let script = if is_cpp { "g++sim" } else { "gccsim" };
    let mut command = Command::new(home()?.join("bin").join(script));
    command.arg("-w").args(files).arg("-o").arg(program).stdin(Stdio::null()).stdout(Stdio::null());
    command.env("ROBIOS_LIBRARY_DIR", library()?.parent().unwrap_or(Path::new(".")));
    let output =
        command.output().map_err(|error| format!("{script}: {error}; expected a script to compile with"))?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((!output.status.success()).then_some(message))
}

/// Headers within headers that are looked into.
const MOST_HEADERS: usize = 3;

/// Adds the source texts that stand beside the headers which a file includes, under the same names.
fn companions(file: &Path, found: &mut Vec<PathBuf>, depth: usize) {
    let (Ok(text), Some(folder)) = (std::fs::read(file), file.parent()) else { return };
    for line in String::from_utf8_lossy(&text).lines() {
        let rest = line.trim_start().strip_prefix('#').map(str::trim_start);
        let name =
            rest.and_then(|rest| rest.strip_prefix("include")?.trim().strip_prefix('"')?.split('"').next());
        let Some(header) = name.map(|name| folder.join(name)).filter(|header| header.is_file()) else {
            continue;
        };
        let endings = C.iter().chain(&CPP);
        let beside = endings.map(|ending| header.with_extension(ending)).find(|file| file.is_file());
        if let Some(file) = beside.filter(|file| *file != header && !found.contains(file)) {
            found.push(file);
        }
        if depth > 0 {
            companions(&header, found, depth - 1);
        }
    }
}

/// Headers, scripts and Python modules: beside this program's folder, or where the project was built.
pub(crate) fn home() -> Result<PathBuf, String> {
    let installed = std::env::current_exe().ok().and_then(|file| Some(file.parent()?.parent()?.to_owned()));
    let built = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let mut places = installed.into_iter().chain([built]);
    let found =
        places.find(|place| place.join("include/eyebot.h").is_file() && place.join("bin/gccsim").is_file());
    found.ok_or_else(|| {
        "no folder with include/eyebot.h and bin/gccsim; expected one above this program's".into()
    })
}

/// The library: beside this program, or where the project or an installation has it.
pub(crate) fn library() -> Result<PathBuf, String> {
    let name = if cfg!(target_os = "macos") { "libeyesim.dylib" } else { "libeyesim.so" };
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let folder = program.parent().unwrap_or(Path::new("."));
    let places = [folder.to_owned(), folder.join("deps"), folder.join("../lib"), folder.join("..")];
    let found = places.iter().map(|place| place.join(name)).find(|file| file.is_file());
    found.ok_or_else(|| {
        format!("no {name} beside {}; expected one from `cargo build -p robios`", program.display())
    })
}
