use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use roverlab::files::TemporaryFolder;
use roverlab::world::Scene;
use roverlab::world::formats::in_any_case;

use super::compiler;
use super::options::{Options, ends_in, whole};
use super::place::{home, library};
use super::stopwatch::Stopwatch;
use crate::files;

/// A program and the robot it drives.
#[derive(Debug)]
pub(crate) struct Program {
    /// Name as given, or that of the file which takes its place.
    pub(crate) name: String,
    /// Warning about that.
    pub(crate) warning: Option<String>,
    /// Index of the robot in the scene.
    pub(crate) robot: usize,
    /// The executable file, or the reason why there is none.
    pub(crate) file: Result<PathBuf, String>,
    /// Working folder: the program's own.
    pub(crate) folder: PathBuf,
    pub(crate) arguments: Vec<String>,
    /// Whether it gets the typed keys.
    pub(crate) is_first: bool,
}

/// The programs of a run. Fails if a file is missing.
pub(crate) fn of(options: &Options, scene: &Scene, folder: &TemporaryFolder) -> Result<Vec<Program>, String> {
    if !options.is_script() {
        let program = &options.program;
        files::require_regular(program)?;
        let Some(file) = source(&whole(program)) else {
            let program = program.display();
            return Err(format!(
                "{program}: no such file; expected a program, .py, .c, .cpp, or a script, .sim"
            ));
        };
        let alone = prepared(&program.display().to_string(), Ok(file), 0, options, folder);
        return Ok(vec![Program { is_first: true, ..alone }]);
    }
    let base = whole(&options.program);
    let base = base.parent().unwrap_or(Path::new("/"));
    let placed =
        scene.robots.iter().enumerate().filter_map(|(robot, placed)| Some((robot, placed.program.as_ref()?)));
    let mut programs: Vec<Program> =
        placed.map(|(robot, name)| named(base, name, robot, options, folder)).collect();
    let Some(first) = programs.first_mut() else {
        let script = options.program.display();
        return Err(format!(
            "{script}: no robot has a program; expected a line such as `S4 500 500 0 program.x`"
        ));
    };
    first.is_first = true;
    Ok(programs)
}

/// A program named in a script: relative to the script, in the script's own folder, or else the only source
/// text of that folder, with a warning. Programs outside the script's folder need the user's leave.
fn named(base: &Path, name: &str, robot: usize, options: &Options, folder: &TemporaryFolder) -> Program {
    let path = base.join(name.replace('\\', "/"));
    let beside = path.file_name().map(|file| base.join(file));
    let may_start = |file: &PathBuf| options.allow_outside || is_inside(file, base);
    let there = source(&path);
    let is_there = there.is_some();
    if let Some(file) = there.filter(may_start).or_else(|| source(&beside?).filter(may_start)) {
        return prepared(name, Ok(file), robot, options, folder);
    }
    if is_there {
        let (path, base) = (path.display(), base.display());
        let refused = format!("{path}: outside of {base}; expected a program inside, or --allow-outside");
        return prepared(name, Err(refused), robot, options, folder);
    }
    let place = path.parent().filter(|place| place.is_dir()).unwrap_or(base);
    let Some(only) = only_source(place).filter(may_start) else {
        let missing =
            format!("{}: no such file; expected a program, or its source text beside it", path.display());
        return prepared(name, Err(missing), robot, options, folder);
    };
    let instead = only.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let warning = format!(
        "robot {}: its program {name} is not there; {instead}, the only source text in the folder, runs instead",
        robot + 1
    );
    Program { warning: Some(warning), ..prepared(&instead, Ok(only), robot, options, folder) }
}

/// Whether a file is in a folder or below it. A link is where it leads to.
fn is_inside(file: &Path, folder: &Path) -> bool {
    let real = |path: &Path| std::fs::canonicalize(path);
    matches!((real(file), real(folder)), (Ok(file), Ok(folder)) if file.starts_with(&folder))
}

fn prepared(
    name: &str,
    found: Result<PathBuf, String>,
    robot: usize,
    options: &Options,
    folder: &TemporaryFolder,
) -> Program {
    let own_folder = found.as_ref().ok().and_then(|file| file.parent()).map(Path::to_owned);
    let file = found.and_then(|file| if is_source(&file) { compile(&file, folder, robot) } else { Ok(file) });
    Program {
        name: name.to_owned(),
        warning: None,
        robot,
        file,
        folder: own_folder.unwrap_or_else(|| PathBuf::from("/")),
        arguments: options.arguments.clone(),
        is_first: false,
    }
}

const C: [&str; 1] = ["c"];
const CPP: [&str; 4] = ["cpp", "cc", "cxx", "c++"];

fn is_source(file: &Path) -> bool {
    C.iter().chain(&CPP).any(|ending| ends_in(file, ending))
}

/// Whether Python runs a file.
pub(crate) fn is_python(file: &Path) -> bool {
    ends_in(file, "py")
        || first_line(file).is_ok_and(|line| line.starts_with("#!") && line.contains("python"))
}

fn first_line(file: &Path) -> std::io::Result<String> {
    let start = files::read_beginning(file, 100)?;
    Ok(String::from_utf8_lossy(&start).lines().next().unwrap_or_default().to_owned())
}

/// The file of a program: the named one if this system can run it, or one beside it with another extension:
/// executable first, then C, C++ and Python source text. The name may have another system's extension, or
/// none, or the program may not be compiled. Case is ignored.
fn source(path: &Path) -> Option<PathBuf> {
    let endings = || ["x"].iter().chain(&C).chain(&CPP).chain(&["py"]);
    let instead = endings().map(|ending| path.with_extension(ending));
    let name = path.file_name()?.to_string_lossy();
    let behind = endings().map(|ending| path.with_file_name(format!("{name}.{ending}")));
    let bare = [path.with_extension("")];
    let mut all = [path.to_owned()].into_iter().chain(instead).chain(behind).chain(bare);
    all.find_map(|file| usable(&file).filter(|file| runs(file)))
}

fn runs(file: &Path) -> bool {
    is_source(file) || ends_in(file, "py") || starts_here(file)
}

/// A file by name, ignoring case.
fn usable(path: &Path) -> Option<PathBuf> {
    if path.is_file() {
        Some(path.to_owned())
    } else {
        in_any_case(path.parent()?, Path::new(path.file_name()?))
    }
}

/// The source text of a folder with only one: programs are often named differently from their source.
fn only_source(folder: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    let is_module =
        |file: &Path| file.file_name().is_some_and(|name| name == "eye.py" || name == "eyebot.py");
    let (python, compiled): (Vec<_>, Vec<_>) = files
        .filter(|file| is_source(file) || ends_in(file, "py") && !is_module(file))
        .filter(|file| file.is_file())
        .partition(|file| ends_in(file, "py"));
    match (compiled.as_slice(), python.as_slice()) {
        ([only], _) | ([], [only]) => Some(only.clone()),
        _ => None,
    }
}

/// Whether this system can start a file: a program of its own format, or a script with an interpreter line.
fn starts_here(path: &Path) -> bool {
    files::read_beginning(path, 4)
        .is_ok_and(|magic| magic == *b"\x7fELF" || magic.starts_with(b"#!") || !cfg!(target_os = "linux"))
}

/// Compiles a program for a robot.
fn compile(source: &Path, folder: &TemporaryFolder, robot: usize) -> Result<PathBuf, String> {
    let program = folder.path().join(format!("program{robot}.x"));
    compile_to(source, &program)?;
    Ok(program)
}

/// Compiles a program with the appropriate script, including other necessary source texts. Fails if that
/// takes more than [`compiler::LIMIT`].
pub(crate) fn compile_to(source: &Path, program: &Path) -> Result<(), String> {
    files::require_regular(source)?;
    let clock = Stopwatch::start();
    let Some(mut message) = compile_files(&[source.to_owned()], program, &clock)? else { return Ok(()) };
    let mut files = vec![source.to_owned()];
    companions(source, &mut files, MOST_HEADERS);
    if files.len() > 1 && message.contains("undefined reference") {
        // If the complete program fails as well, its error is the relevant one.
        match compile_files(&files, program, &clock)? {
            Some(with_companions) => message = with_companions,
            None => return Ok(()),
        }
    }
    let telling =
        |words: &str| message.lines().find(|line| line.contains(words) && !line.starts_with("collect2"));
    let first = telling("error:")
        .or_else(|| telling("error"))
        .or_else(|| telling("undefined reference"))
        .or(message.lines().next());
    Err(format!("{}: does not compile: {}", source.display(), first.unwrap_or("the compiler says nothing")))
}

/// Compiles files into a program, which was begun with the stopwatch. Returns the compiler's message on
/// failure.
fn compile_files(files: &[PathBuf], program: &Path, clock: &Stopwatch) -> Result<Option<String>, String> {
    let is_cpp = files.iter().any(|file| CPP.iter().any(|ending| ends_in(file, ending)));
    let script = if is_cpp { "g++sim" } else { "gccsim" };
    let mut command = Command::new(home()?.join("bin").join(script));
    command.arg("-w").args(files).arg("-o").arg(program).stdin(Stdio::null()).stdout(Stdio::null());
    command.env("ROBIOS_LIBRARY_DIR", library()?.parent().unwrap_or(Path::new(".")));
    let ended = compiler::run(&mut command, clock, compiler::LIMIT)
        .map_err(|error| format!("{script}: {error}; expected a script to compile with"))?;
    let (status, message) = ended.ok_or_else(|| {
        let (file, limit) = (files[0].display(), compiler::LIMIT);
        format!("{file}: does not compile: the compiler was ended after {limit} real seconds")
    })?;
    Ok((!status.success()).then_some(message))
}

/// Maximum nesting depth of headers searched.
const MOST_HEADERS: usize = 3;

/// Length of a text in which headers are searched (bytes).
const MOST_SEARCHED: u64 = 16 << 20;

/// Adds the source texts beside the headers that a file includes, with the same names.
fn companions(file: &Path, found: &mut Vec<PathBuf>, depth: usize) {
    let (Ok(text), Some(folder)) = (files::read_beginning(file, MOST_SEARCHED), file.parent()) else {
        return;
    };
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
