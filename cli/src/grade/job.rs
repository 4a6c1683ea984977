use std::path::PathBuf;

use roverlab::files::write_whole;
use roverlab::picture::Picture;

use super::Args;
use super::page::{page, picture};
use super::place::Place;
use super::program::{Kind, Program};
use super::rubric::Rubric;
use super::run::{Ran, Terms, run};
use super::table::{Graded, heading};
use super::workplace::Workplace;
use crate::common::{Failure, Outcome, Report, check_writable, share_out, threads};

/// Runs beyond the limit of real time after which a program is not run again.
const ENDLESS: usize = 2;
/// Columns of pictures.
const COLUMNS: usize = 4;

/// What all programs are graded by.
struct Course<'a> {
    rubric: &'a Rubric,
    places: &'a [Place],
    /// Files of all programs.
    files: Vec<PathBuf>,
    seed: u64,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.plain.check_picture()?;
    if let Some(file) = &args.html {
        check_writable("--html", file)?;
    }
    let rubric = Rubric::read(&args.rubric)?;
    let places = rubric.worlds.iter().map(|task| Place::load(&rubric, task, &args.plain.origin));
    let places = places.collect::<Result<Vec<_>, _>>()?;
    let programs = args.programs.iter().map(|text| Program::parse(text)).collect::<Result<Vec<_>, _>>()?;
    let files = programs.iter().filter_map(|program| match &program.kind {
        Kind::Robios { source, .. } => Some(source.clone()),
        Kind::Lab(_) => None,
    });
    let course = Course { rubric: &rubric, places: &places, files: files.collect(), seed: args.plain.seed };
    let count = programs.len() as u64;
    let graded = share_out("programs", count, threads(args.threads), |index| {
        grade(&programs[index as usize], &course)
    })?;
    let mut lines = vec![format!("{}: {} runs each", rubric.title, course.runs()), heading()];
    lines.extend(graded.iter().map(|program| program.line(&places)));
    if let Some(file) = &args.html {
        let text = page(&rubric, &places, &graded);
        write_whole(file, text.as_bytes())
            .map_err(|error| Failure::run(format!("--html {}: {error}", file.display())))?;
    }
    let rows: Vec<_> = graded.iter().map(|program| program.value(&places)).collect();
    let report = Report::new(Outcome::verdict("graded"))
        .field("rubric", args.rubric.display().to_string())
        .field("title", &rubric.title)
        .field("runs", course.runs())
        .table("programs", rows)
        .field("html", args.html.as_ref().map(|file| file.display().to_string()));
    let report = Report { words: Some(lines.join("\n")), ..report };
    Ok(args.plain.draw(report, "grade.svg", || pictures(&graded, &places)))
}

impl Course<'_> {
    /// Number of runs of each program.
    fn runs(&self) -> usize {
        self.places.len() * self.rubric.seeds as usize
    }
}

/// All runs of a program, one after the other.
fn grade(source: &Program, course: &Course<'_>) -> Result<Graded, Failure> {
    let folder =
        Workplace::new().map_err(|error| Failure::run(format!("no folder to compile in: {error}")))?;
    let mut runs = Vec::new();
    let program = match source.compiled(&folder) {
        Ok(program) => program,
        Err(message) => {
            let failed = Ran { outcome: "failed", error: Some(message), ..Ran::default() };
            return Ok(Graded { name: source.name.clone(), runs: vec![failed; course.runs()] });
        }
    };
    for (index, place) in course.places.iter().enumerate() {
        for number in 0..course.rubric.seeds {
            let seed = course.seed.wrapping_add(number);
            let terms = Terms { rubric: course.rubric, place, index, seed, files: &course.files };
            let endless: Vec<&Ran> = runs.iter().filter(|ran: &&Ran| ran.is_endless).collect();
            let ran = match endless.last() {
                Some(last) if endless.len() >= ENDLESS => {
                    Ran { outcome: "timed_out", place: index, path: Vec::new(), ..(*last).clone() }
                }
                _ => run(&program, &terms).map_err(Failure::run)?,
            };
            runs.push(ran);
        }
    }
    Ok(Graded { name: source.name.clone(), runs })
}

/// The paths of all programs in the first world.
fn pictures(graded: &[Graded], places: &[Place]) -> Picture {
    let panels: Vec<Picture> = graded.iter().map(|program| picture(program, places, 0)).collect();
    Picture::panels(&panels, COLUMNS.min(panels.len()))
}
