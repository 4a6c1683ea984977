use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Arc, PoisonError};

use eyesim::keys::{KeyDesk, KeyPlan};
use eyesim::memory::Memory;
use eyesim::plan::{Plan, parse_pose};
use eyesim::report::{Report, ReportFile, Stage};
use eyesim::robios::{Outlets, Robios};
use eyesim::seat::{Seat, Terms};
use eyesim::showing::Showing;
use eyesim::verdict::{Ending, Summary, Truth, Verdict};
use roverlab::geometry::Pose;
use roverlab::io::sim::Simulation;
use roverlab::world::Scene;
use roverlab::world::formats::{FileSource, SourceFile};
use roverlab_view::Face;
use serde_json::{Value, json};

use crate::camera::{Camera, Panel};
use crate::job::file_of;
use crate::mouth::Mouth;
use crate::{Job, Message};

/// A program for RoBIOS that runs in the page.
#[derive(Debug)]
pub(crate) struct Program {
    name: String,
    plan: Plan,
    mouth: Mouth,
    from: f64,
    memory: Arc<Memory>,
    /// Pose of its robot before it drives.
    start: Pose,
    warnings: Vec<String>,
}

impl Program {
    /// Gives a program its robot. The job's words are the name of its file and options of `robios`.
    pub(crate) fn begin(job: Job, tell: impl FnMut(Message, &[u8]) + Send + 'static) -> Result<Self, String> {
        let Job { words, files, wishes, walls, from } = job;
        let (name, options) = words.split_first().ok_or("found no program; expected the name of one")?;
        let (plan, keys) = plan(options)?;
        let mut files = Files(files);
        let mut warnings = Vec::new();
        let world =
            plan.world.as_deref().map(|file| Ok::<_, String>((file, files.whole(file)?))).transpose()?;
        let mut scene = plan.scene_of(world, &mut files, &mut warnings)?;
        let mouth = Mouth::new(tell);
        let panel = Panel::default();
        let camera = Camera::of(&mut scene, (&walls, wishes), from, &mouth).with_panel(Arc::clone(&panel));
        let simulation = Simulation::new(&scene, plan.options()).map_err(|error| error.to_string())?;
        simulation.watch(Box::new(camera));
        let memory = Arc::new(Memory::default());
        let outlets = Outlets {
            report: Some(ReportFile::new(Arc::clone(&memory))),
            showing: Some(showing(panel, &scene, plan.index)),
            lcd: None,
        };
        let seat = Seat::take(&simulation, &scene, plan.index, Terms::of(&plan.options()));
        let robios = seat
            .and_then(|seat| Robios::new(Box::new(seat), KeyDesk::new(keys), plan.costs.clone(), outlets))
            .map_err(|error| error.to_string())?;
        eyesim::page::begin(robios);
        let start = scene.robots[plan.index].pose;
        Ok(Self { name: name.clone(), plan, mouth, from, memory, start, warnings })
    }

    /// Shows a line that it has printed.
    pub(crate) fn printed(&self, line: &str) {
        self.mouth.tell_line(line, self.from);
    }

    /// Ends its run with its exit status and its last words, as the runner does.
    pub(crate) fn finish(self, status: i32, last_words: &str) {
        eyesim::page::finish();
        let report = Report::read(&self.memory);
        let words = Some(last_words).filter(|words| status != 0 && !words.is_empty()).map(String::from);
        let ending =
            if report.stage == Stage::TimedOut { Ending::time_limit() } else { Ending::Exit(status, words) };
        let truth = if report.known {
            Truth::reported(&report, self.plan.time_limit)
        } else {
            Truth { pose: self.start, ..Truth::default() }
        };
        let verdict = Verdict::new(&self.name, self.plan.index, ending, &report, truth);
        let warnings = self.warnings.into_iter().chain(verdict.warnings()).collect();
        let (seed, noise) = (self.plan.seed, self.plan.noise);
        let summary = Summary { verdicts: vec![verdict], warnings, seed, noise, wall_time: None };
        let report: Value = summary.json().parse().unwrap_or_default();
        self.mouth.end(json!({
            "status": summary.status(), "output": summary.words(), "errors": summary.warnings.join("\n"),
            "report": report,
        }));
    }
}

/// Shows the display of a robot's program on a panel.
fn showing(panel: Panel, scene: &Scene, robot: usize) -> Showing {
    panel.lock().unwrap_or_else(PoisonError::into_inner).resize(scene.robots.len(), None);
    Showing::new(move |image, menu| {
        let face = &mut panel.lock().unwrap_or_else(PoisonError::into_inner)[robot];
        let drawings = face.as_ref().map_or(0, |face| face.drawings) + 1;
        *face = Some(Face { drawings, image: Arc::new(image.clone()), menu: menu.to_owned() });
        Ok(())
    })
}

/// The files of the page.
#[derive(Debug)]
struct Files(BTreeMap<String, Vec<u8>>);

impl Files {
    fn whole(&self, name: &Path) -> Result<Vec<u8>, String> {
        let name = name.display().to_string();
        let found = file_of(&self.0, &name).cloned();
        found.ok_or_else(|| format!("{name}: no such file; expected one that is opened in the page"))
    }
}

impl FileSource for Files {
    fn read(&mut self, reference: &str, _referrer: &str, limit: u64) -> io::Result<SourceFile> {
        let bytes = file_of(&self.0, reference).ok_or(io::ErrorKind::NotFound)?;
        if bytes.len() as u64 > limit {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        Ok(SourceFile { name: reference.into(), bytes: bytes.clone() })
    }
}

/// What options of `robios` say.
fn plan(options: &[String]) -> Result<(Plan, KeyPlan), String> {
    let (mut plan, mut keys) = (Plan::default(), KeyPlan::default());
    for option in options {
        let (name, value) = option.split_once('=').unwrap_or((option.as_str(), ""));
        match name {
            "--seed" => plan.seed = number(name, value)?,
            "--noise" => plan.noise = number(name, value)?,
            "--time-limit" => plan.time_limit = number(name, value)?,
            "--robot" => plan.robot = Some(value.to_owned()),
            "--world" => plan.world = Some(PathBuf::from(value)),
            "--start" => plan.start = Some(parse_pose(value).map_err(|error| format!("{name}: {error}"))?),
            "--keys" => keys = value.parse::<KeyPlan>().map_err(|error| format!("{name}: {error}"))?,
            _ => return Err(format!("{option}; expected an option of robios that the page has")),
        }
    }
    Ok((plan, keys))
}

fn number<T: FromStr>(name: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{name}={value}; expected a number"))
}
