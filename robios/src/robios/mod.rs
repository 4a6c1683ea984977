//! RoBIOS in safe Rust: what its functions do, in its own units, for one robot.
//!
//! Methods are named after the functions. They answer with what the function returns, or with the error that makes it
//! return its code for failure; who calls from C is in `ffi`.

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

use crate::ask::{Identity, Reply, Request};
use crate::costs::Costs;
use crate::keys::KeyDesk;
use crate::link::Link;
use crate::report::{NOTES, Report, ReportFile, Stage};
use crate::screen::Screen;

pub(crate) use system::Callback;

/// One robot and its devices, as a program sees them.
#[derive(Debug)]
pub struct Robios {
    link: Box<dyn Link>,
    identity: Identity,
    /// Nanoseconds that calls without the world have taken since the last one with it.
    debt: u64,
    queue: time::Queue,
    recent: time::Recent,
    /// The call that is being served.
    call: &'static str,
    pub(crate) screen: Screen,
    pub(crate) keys: KeyDesk,
    pub(crate) lines: Lines,
    pub(crate) timers: Timers,
    /// The size of the camera's images, once it is started.
    camera: Option<Resolution>,
    /// The size of the images that functions of image processing take.
    image_size: (usize, usize),
    image_size_set: bool,
    inbox: radio::Inbox,
    /// The numbers of all robots, once they are known.
    numbers: Vec<u32>,
    /// The size of the images that the display takes, and where it puts them.
    lcd_image: ImageSize,
    window: Option<Viewport>,
    /// Whether the last drive command was one for a turn on the spot.
    turns: bool,
    moving: Moving,
    /// The motors that have been set to turn, a bit for each.
    turning: u8,
    standing_since: f64,
    servos: [i32; 15],
    /// Seconds by which a program has set the clock forward.
    clock_offset: f64,
    sounds: u64,
    sound_ends: f64,
    report: Report,
    file: Option<ReportFile>,
    text_changed: bool,
    lcd_file: Option<std::path::PathBuf>,
}

/// What `LCDImageSize` has said last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ImageSize {
    Unsaid,
    /// Columns and rows.
    Named((usize, usize)),
    /// That of the window.
    Custom,
}

/// What the last drive command was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moving {
    No,
    Manoeuvre,
    Speeds,
}

const NANOSECONDS: f64 = 1e9;
/// Seconds from 1970 to the beginning of every run: noon of the first day of 2020, in Greenwich.
pub(crate) const EPOCH: f64 = 1_577_880_000.0;

/// Notes of one call that are kept: a program that tries all numbers needs no more.
const MOST_OF_CALL: usize = 3;

/// Seconds between two looks at a robot that drives on.
const LOOK: f64 = 0.1;

/// Where a run is reported.
#[derive(Debug, Default)]
pub struct Outlets {
    /// The file of the report.
    pub report: Option<ReportFile>,
    /// The picture of the display at the end.
    pub lcd: Option<std::path::PathBuf>,
}

impl Robios {
    /// A robot at the other end of a link.
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
        })
    }

    /// Who the robot is.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The program's time in seconds since the start.
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

    /// Notes, once, what a call has asked for in vain, for whoever reads the report.
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

    /// Writes the report, if there is a file for it.
    pub(crate) fn publish(&mut self) {
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

    /// Ends the run: the robot drives on until it stands, is held or the time is over, as it would without a program;
    /// then everything is written down.
    pub fn finish(&mut self, stage: Stage) {
        self.begin("");
        self.report.stage = stage;
        // What is known now counts, whatever becomes of the rest.
        self.publish();
        let (time, contacts) = (self.report.time, self.report.contacts);
        if stage == Stage::Ended && self.deliver_all().is_ok() {
            self.drive_on();
        }
        self.publish();
        if let Some(file) = &mut self.file {
            // What the robot touches without its program is none of the program's doing.
            self.report.time = time;
            self.report.later_contacts = self.report.contacts.saturating_sub(contacts);
            self.report.contacts = contacts;
            file.write(&self.report);
        }
        if let Some(path) = &self.lcd_file {
            let _ = self.screen.lcd.frame().save(path);
        }
    }

    /// Lets a world of the program's own run until the robot stands.
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

/// Metres in whole millimetres.
pub(crate) fn millimetres(metres: f64) -> i32 {
    units::to_mm(metres).round() as i32
}

/// Radians in whole degrees, in `-179..=180`.
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
