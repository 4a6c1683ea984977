//! RoBIOS in safe Rust: its functions in its own units, for one robot.
//!
//! Methods are named after the functions. They return the function's result, or the error that leads to its
//! failure code; the C interface is in `ffi`.

mod display;
mod drive;
pub(crate) mod images;
mod lines;
mod radio;
mod sensing;
mod system;
mod time;

pub use display::Frame;
pub use lines::Lines;
pub use sensing::NOTHING;
pub use system::Timers;

use image::RgbImage;
use roverlab::geometry::{Pose, normalize_angle, units};
use roverlab::io::{Error, ErrorKind, Resolution, Result, Viewport};

use crate::ask::{Reply, Request};
use crate::costs::Costs;
use crate::identity::Identity;
use crate::keys::KeyDesk;
use crate::link::Link;
use crate::report::{NOTES, Report, ReportFile, Stage};
use crate::screen::Screen;
use crate::showing::Showing;

#[cfg(feature = "c")]
pub(crate) use system::Callback;

/// One robot and its devices from a program's perspective.
#[derive(Debug)]
pub struct Robios {
    link: Box<dyn Link>,
    identity: Identity,
    /// Time taken by local calls since the last request to the world (ns).
    debt: u64,
    queue: time::Queue,
    recent: time::Recent,
    /// The current call.
    call: &'static str,
    pub(crate) screen: Screen,
    pub(crate) keys: KeyDesk,
    pub(crate) lines: Lines,
    pub(crate) timers: Timers,
    /// Size of the camera's images, once initialised.
    camera: Option<Resolution>,
    /// Size of images for the image processing functions.
    image_size: (usize, usize),
    image_size_set: bool,
    inbox: radio::Inbox,
    /// Numbers of all robots, once known.
    numbers: Vec<u32>,
    /// Size of the display's images, and their window.
    lcd_image: ImageSize,
    window: Option<Viewport>,
    /// Whether the last drive command was a turn on the spot.
    turns: bool,
    moving: Moving,
    /// Motors set to turn, one bit each.
    turning: u8,
    standing_since: f64,
    servos: [i32; 15],
    /// Offset of the clock set by a program (s).
    clock_offset: f64,
    sounds: u64,
    sound_ends: f64,
    report: Report,
    file: Option<ReportFile>,
    text_changed: bool,
    lcd_file: Option<std::path::PathBuf>,
    showing: Option<Showing>,
}

/// Last setting of `LCDImageSize`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ImageSize {
    Unsaid,
    /// Number of columns and rows.
    Named((usize, usize)),
    /// Size of the window.
    Custom,
}

/// The last drive command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moving {
    No,
    Manoeuvre,
    Speeds,
}

pub(crate) const NANOSECONDS: f64 = 1e9;
/// Time from 1970 to the start of every run (s): 1 January 2020, 12:00 UTC.
pub(crate) const EPOCH: f64 = 1_577_880_000.0;

/// Maximum number of notes per call: a program that tries all numbers needs no more.
const MOST_OF_CALL: usize = 3;

/// Interval of the checks on a robot that drives on (s).
const LOOK: f64 = 0.1;

/// Outputs of a run's report.
#[derive(Debug, Default)]
pub struct Outlets {
    /// Writer of the report.
    pub report: Option<ReportFile>,
    /// File for the final picture of the display.
    pub lcd: Option<std::path::PathBuf>,
    /// Who watches the display.
    pub showing: Option<Showing>,
}

impl Robios {
    /// Connects to a robot through a link. Fails if the link does.
    pub fn new(mut link: Box<dyn Link>, keys: KeyDesk, costs: Costs, outlets: Outlets) -> Result<Self> {
        let (Reply::Identity(identity), _) = link.ask(0.0, &[], &Request::Identity)? else {
            return Err(foreign());
        };
        Ok(Self {
            link,
            identity,
            debt: 0,
            queue: time::Queue::new(costs),
            recent: time::Recent::default(),
            call: "",
            screen: Screen::default(),
            keys,
            lines: Lines::default(),
            timers: Timers::default(),
            camera: None,
            image_size: images::size(Resolution::Qqvga),
            image_size_set: false,
            inbox: radio::Inbox::new(),
            numbers: Vec::new(),
            lcd_image: ImageSize::Unsaid,
            window: None,
            turns: false,
            moving: Moving::No,
            turning: 0,
            standing_since: 0.0,
            servos: [128; 15],
            clock_offset: 0.0,
            sounds: 0,
            sound_ends: 0.0,
            report: Report { stage: Stage::Running, ..Report::default() },
            file: outlets.report,
            text_changed: false,
            lcd_file: outlets.lcd,
            showing: outlets.showing,
        })
    }

    /// Properties of the robot.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Time of the program since the start (s).
    pub fn now(&mut self) -> f64 {
        self.link.now() + self.debt as f64 / NANOSECONDS
    }

    fn number(&mut self, request: &Request) -> Result<f64> {
        match self.ask(request)? {
            Reply::Number(number) => Ok(number),
            _ => Err(foreign()),
        }
    }

    fn flag(&mut self, request: &Request) -> Result<bool> {
        match self.ask(request)? {
            Reply::Flag(flag) => Ok(flag),
            _ => Err(foreign()),
        }
    }

    fn pose_of(&mut self, request: &Request) -> Result<(Pose, f64)> {
        match self.ask(request)? {
            Reply::Pose(pose, elevation) => Ok((pose, elevation)),
            _ => Err(foreign()),
        }
    }

    fn image(&mut self) -> Result<RgbImage> {
        match self.ask(&Request::Image)? {
            Reply::Image(image) => Ok(image),
            _ => Err(foreign()),
        }
    }

    /// Records a failed request of a call, once, for the report.
    pub(crate) fn note(&mut self, what: &str) {
        let what = what.replace('\n', " ");
        let note = if self.call.is_empty() { what } else { format!("{}: {what}", self.call) };
        let notes = &mut self.report.notes;
        let of_call = notes.iter().filter(|known| known.split(':').next() == note.split(':').next()).count();
        let length: usize = notes.iter().map(|note| note.len() + 1).sum();
        if of_call >= MOST_OF_CALL || length + note.len() > NOTES || notes.contains(&note) {
            return;
        }
        notes.push(note);
        if let Some(file) = &self.file {
            file.write_notes(&self.report.notes);
        }
    }

    /// Like [`note`](Robios::note), for a call other than the present one.
    fn note_of(&mut self, call: &'static str, what: &str) {
        let present = std::mem::replace(&mut self.call, call);
        self.note(what);
        self.call = present;
    }

    /// Writes the report, if there is a writer.
    pub(crate) fn publish(&mut self) {
        let now = self.now();
        if let Some(showing) = &mut self.showing {
            showing.show(&self.screen.lcd, now);
        }
        let Some(file) = &mut self.file else { return };
        self.report.time = self.link.now() + self.debt as f64 / NANOSECONDS;
        self.report.sounds = self.sounds;
        if let Some(truth) = self.link.truth() {
            self.report.known = true;
            self.report.world_time = truth.time;
            self.report.pose = truth.pose;
            self.report.stance = truth.stance;
            self.report.odometry = truth.odometry;
            self.report.path_length = truth.path_length;
            self.report.contacts = u64::from(truth.contacts);
        }
        file.write(&self.report);
        if std::mem::take(&mut self.text_changed) {
            file.write_text(self.screen.history(), &self.screen.standing());
        }
    }

    /// Ends the run: the robot drives on until it stands, is held or the time is over, as it would without a
    /// program; then writes the report.
    pub fn finish(&mut self, stage: Stage) {
        self.begin("");
        self.report.stage = stage;
        // The current state counts, whatever happens later.
        self.publish();
        let (time, contacts) = (self.report.time, self.report.contacts);
        if stage == Stage::Ended && self.deliver_all().is_ok() {
            self.drive_on();
        }
        self.publish();
        if let Some(file) = &mut self.file {
            // Contacts without the program are not the program's.
            self.report.time = time;
            self.report.later_contacts = self.report.contacts.saturating_sub(contacts);
            self.report.contacts = contacts;
            file.write(&self.report);
        }
        if let Some(showing) = &mut self.showing {
            showing.show_last(&self.screen.lcd);
        }
        if let Some(path) = &self.lcd_file {
            let _ = self.screen.lcd.frame().save(path);
        }
    }

    /// Runs a world of the program's own until the robot stands.
    fn drive_on(&mut self) {
        while let Some(before) = self.link.truth() {
            let passed = self.pass(LOOK).is_ok();
            if !passed || self.link.truth().is_none_or(|now| now.pose == before.pose) {
                return;
            }
        }
    }
}

fn foreign() -> Error {
    Error::new(ErrorKind::Other, "the world has answered something else than what it was asked")
}

fn invalid(name: &str, found: impl std::fmt::Display, expected: &str) -> Error {
    Error::invalid_input(name, found, expected)
}

/// Metres to whole millimetres.
pub(crate) fn millimetres(metres: f64) -> i32 {
    units::to_mm(metres).round() as i32
}

/// Radians to whole degrees, in `-179..=180`.
pub(crate) fn degrees(radians: f64) -> i32 {
    let whole = units::to_deg(normalize_angle(radians)).round() as i32;
    if whole == -180 { 180 } else { whole }
}

/// A pose in whole millimetres and degrees.
pub(crate) fn in_whole(pose: Pose) -> [i32; 3] {
    [millimetres(pose.x), millimetres(pose.y), degrees(pose.heading)]
}

/// A pose from millimetres and degrees.
pub(crate) fn pose_from([x, y, phi]: [i32; 3]) -> Pose {
    Pose::from_mm_deg(f64::from(x), f64::from(y), f64::from(phi))
}
