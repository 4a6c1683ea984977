//! Report on a program's run, in memory that the library keeps up to date.
//!
//! It is updated at every call, so that the runner knows the program's progress, however it ended.

use std::sync::Arc;

use roverlab::geometry::Pose;
use roverlab::io::sim::{Mishap, Truth};

use crate::memory::{Memory, REPORT};

/// Stage of a program's run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stage {
    /// It has called no RoBIOS function.
    #[default]
    Silent,
    /// It is running, or ended without notice.
    Running,
    /// It has ended by itself.
    Ended,
    /// Ended by the time limit.
    TimedOut,
    /// The library could not create its world.
    Refused,
    /// The shared world is gone.
    Disconnected,
}

const STAGES: [Stage; 6] =
    [Stage::Silent, Stage::Running, Stage::Ended, Stage::TimedOut, Stage::Refused, Stage::Disconnected];

/// Attitude and state of a robot on hills.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stance {
    /// Height above the floor (m).
    pub elevation: f64,
    /// Roll (rad), positive with the left side up.
    pub roll: f64,
    /// Pitch (rad), positive with the nose down.
    pub pitch: f64,
    /// Reason why it cannot drive, if any.
    pub mishap: Option<Mishap>,
}

/// All mishaps by their number in the report; an unknown number reads as none.
const MISHAPS: [Option<Mishap>; 6] = [
    None,
    Some(Mishap::Tipped),
    Some(Mishap::Fell),
    Some(Mishap::Stuck),
    Some(Mishap::Drowned),
    Some(Mishap::Broken),
];

impl Stance {
    /// Stance of a robot in a world.
    pub fn of(world: &Truth, robot: usize) -> Self {
        let Ok(pose) = world.pose_in_space(robot) else { return Self::default() };
        let [roll, pitch, _] = pose.roll_pitch_yaw();
        let mishap = world.mishap(robot).ok().flatten();
        Self { elevation: pose.position.z, roll, pitch, mishap }
    }
}

/// Report on a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Stage of the program.
    pub stage: Stage,
    /// Whether the following numbers are valid: not in a shared world, where the runner knows them.
    pub known: bool,
    /// Time taken by the program (s).
    pub time: f64,
    /// Time of the world (s).
    pub world_time: f64,
    /// True pose of the robot.
    pub pose: Pose,
    /// Attitude on hills.
    pub stance: Stance,
    /// Pose by odometry.
    pub odometry: Pose,
    /// Distance moved (m).
    pub path_length: f64,
    /// Number of contacts until the program ended.
    pub contacts: u64,
    /// Number of contacts after that, while the robot drove on.
    pub later_contacts: u64,
    /// Number of beeps and sounds.
    pub sounds: u64,
    /// Functions called that no robot has, a bit for each of [`BEYOND_ROBOTS`].
    pub beyond_robots: u8,
    /// Start of waiting for a radio message, if waiting (s).
    pub listening_since: Option<f64>,
    /// Text shown on the display, past and present.
    pub text: String,
    /// Unsupported requests of the program.
    pub notes: Vec<String>,
}

/// The functions that tell a program where things are, or put them elsewhere: the simulator has them, robots
/// have not.
pub const BEYOND_ROBOTS: [&str; 4] = ["SIMGetRobot", "SIMSetRobot", "SIMGetObject", "SIMSetObject"];

const NUMBERS: usize = 20;
/// Size of the numbers and text lengths (bytes).
const HEADER: usize = 8 * (NUMBERS + 3);
/// Size of the visible rows (bytes).
const STANDING: usize = 24 * 1024;
/// Size of the notes (bytes), one per line.
pub const NOTES: usize = 16 * 1024;
const HISTORY_START: usize = HEADER + STANDING + NOTES;

impl Report {
    /// Records the call of a function that no robot has.
    pub(crate) fn note_beyond(&mut self, function: &str) {
        let bit = BEYOND_ROBOTS.iter().position(|known| *known == function);
        self.beyond_robots |= bit.map_or(0, |bit| 1 << bit);
    }

    /// Names of the functions called that no robot has.
    pub fn beyond_robots(&self) -> Vec<&'static str> {
        let called = |(bit, _): &(usize, &&'static str)| self.beyond_robots & (1 << bit) != 0;
        BEYOND_ROBOTS.iter().enumerate().filter(called).map(|(_, name)| *name).collect()
    }
}

/// Writer of a report.
#[derive(Debug)]
pub struct ReportFile {
    memory: Arc<Memory>,
    history: usize,
}

impl ReportFile {
    /// Writes to shared memory.
    pub fn new(memory: Arc<Memory>) -> Self {
        Self { memory, history: 0 }
    }

    /// Writes everything but the text.
    pub fn write(&self, report: &Report) {
        let stage = STAGES.iter().position(|&stage| stage == report.stage).unwrap_or_default();
        let (pose, odometry) = (report.pose, report.odometry);
        let numbers: [f64; NUMBERS] = [
            stage as f64,
            f64::from(u8::from(report.known)),
            report.time,
            report.world_time,
            pose.x,
            pose.y,
            pose.heading,
            odometry.x,
            odometry.y,
            odometry.heading,
            report.path_length,
            report.contacts as f64,
            report.later_contacts as f64,
            report.sounds as f64,
            report.listening_since.unwrap_or(-1.0),
            report.stance.elevation,
            report.stance.roll,
            report.stance.pitch,
            MISHAPS.iter().position(|&mishap| mishap == report.stance.mishap).unwrap_or_default() as f64,
            f64::from(report.beyond_robots),
        ];
        let mut bytes = [0; 8 * NUMBERS];
        for (place, number) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(numbers) {
            *place = number.to_le_bytes();
        }
        self.memory.write_report(0, &bytes);
    }

    /// Writes the text: the visible rows, and additions to the history.
    pub fn write_text(&mut self, history: &str, standing: &str) {
        let standing = &standing.as_bytes()[..standing.len().min(STANDING)];
        let fresh = history.as_bytes().get(self.history..).unwrap_or_default();
        self.memory.write_report(HISTORY_START + self.history, fresh);
        self.history = history.len();
        self.memory.write_report(HEADER, standing);
        self.write_length(0, self.history);
        self.write_length(1, standing.len());
    }

    /// Writes the notes, as far as there is room.
    pub fn write_notes(&self, notes: &[String]) {
        let text = notes.join("\n");
        let text = &text.as_bytes()[..text.len().min(NOTES)];
        self.memory.write_report(HEADER + STANDING, text);
        self.write_length(2, text.len());
    }

    fn write_length(&self, index: usize, length: usize) {
        self.memory.write_report(8 * (NUMBERS + index), &(length as u64).to_le_bytes());
    }
}

impl Report {
    /// Reads a report. A program may have corrupted it, so nothing is trusted.
    pub fn read(memory: &Memory) -> Self {
        Self::parse(&memory.report())
    }

    fn parse(bytes: &[u8]) -> Self {
        let number = |index: usize| {
            let bytes = bytes.get(8 * index..8 * index + 8).and_then(|bytes| bytes.try_into().ok());
            Some(bytes.map_or(0.0, f64::from_le_bytes)).filter(|n| n.is_finite()).unwrap_or_default()
        };
        let length = |index: usize, most: usize| {
            let bytes = bytes.get(8 * index..8 * index + 8).and_then(|bytes| bytes.try_into().ok());
            (bytes.map_or(0, u64::from_le_bytes) as usize).min(most)
        };
        let text = |start: usize, length: usize| {
            let start = start.min(bytes.len());
            String::from_utf8_lossy(&bytes[start..(start + length).min(bytes.len())]).into_owned()
        };
        let history = text(HISTORY_START, length(NUMBERS, REPORT));
        let standing = text(HEADER, length(NUMBERS + 1, STANDING));
        let notes = text(HEADER + STANDING, length(NUMBERS + 2, NOTES));
        Self {
            stage: STAGES.get(number(0) as usize).copied().unwrap_or_default(),
            known: number(1) != 0.0,
            time: number(2),
            world_time: number(3),
            pose: Pose::new(number(4), number(5), number(6)),
            stance: Stance {
                elevation: number(15),
                roll: number(16),
                pitch: number(17),
                mishap: MISHAPS.get(number(18) as usize).copied().flatten(),
            },
            odometry: Pose::new(number(7), number(8), number(9)),
            path_length: number(10),
            contacts: number(11) as u64,
            later_contacts: number(12) as u64,
            sounds: number(13) as u64,
            beyond_robots: number(19) as u8,
            listening_since: Some(number(14)).filter(|&time| time >= 0.0 && number(0) > 0.0),
            text: history + &standing,
            notes: notes.lines().map(str::to_owned).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_read_as_it_was_written() {
        let memory = Arc::new(Memory::create().unwrap().0);
        assert_eq!(Report::read(&memory), Report::default());
        let mut file = ReportFile::new(Arc::clone(&memory));
        let mut report = Report {
            stage: Stage::TimedOut,
            known: true,
            time: 1.5,
            pose: Pose::new(1.0, 2.0, 3.0),
            stance: Stance { elevation: 0.5, roll: 0.1, pitch: -0.2, mishap: Some(Mishap::Tipped) },
            contacts: 4,
            beyond_robots: 3,
            listening_since: Some(1.0),
            ..Report::default()
        };
        file.write(&report);
        file.write_text("one\n", "a long row");
        file.write_text("one\ntwo\n", "three");
        report.text = "one\ntwo\nthree".into();
        report.notes = vec!["first".into(), "second".into()];
        file.write_notes(&report.notes);
        assert_eq!(Report::read(&memory), report);
    }

    #[test]
    fn nonsense_is_survived() {
        for length in [0, 1, 100, HEADER + 10] {
            Report::parse(&vec![0xff; length]);
        }
    }
}
