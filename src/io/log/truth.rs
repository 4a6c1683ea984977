use std::collections::BTreeMap;
use std::io::Write;

use super::call::Call;
use super::messages::transform_in_space;
use super::player::Player;
use super::port::Port;
use super::position::Position;
use super::recording::Kind;
use super::stamp::Nanoseconds;
use super::topics::{TRANSFORMS, TRUTH, WORLD, truth_frame};
use super::values::{Put, Take, Taking, Values};
use super::{LogError, LogWriter};
use crate::geometry::{Point, Pose, Pose3};
use crate::io::{Error, ErrorKind, GroundTruth, Result, RobotTruth, TrailPoint, TruthInSpace};

/// Recorded ground truth, made by [`LogWriter::truth`](super::LogWriter::truth).
#[derive(Debug)]
pub struct RecordedTruth<T, W: Write> {
    inner: T,
    notes: Notes<W>,
}

impl<W: Write> LogWriter<W> {
    /// Records queries of the ground truth along with a robot, by its index.
    pub fn truth<T: GroundTruth>(&self, truth: T, robot: usize) -> RecordedTruth<T, W> {
        RecordedTruth::new(truth, Port::beside(self.clone(), robot))
    }
}

impl<T: GroundTruth, W: Write> RecordedTruth<T, W> {
    pub(super) fn new(inner: T, port: Port<W>) -> Self {
        Self { inner, notes: Notes::new(port) }
    }
}

impl<T: GroundTruth, W: Write> GroundTruth for RecordedTruth<T, W> {
    fn time(&mut self) -> Result<f64> {
        let result = self.inner.time();
        self.notes.note("time", &(), &result);
        result
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        let result = self.inner.pose(robot);
        self.notes.note("pose", &robot, &result);
        result
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        let result = self.inner.robot(robot);
        self.notes.note_robot(robot, &result);
        result
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        let result = self.inner.object(object);
        self.notes.note("object", &object, &result);
        result
    }

    /// Viewers see the answer as the frame `robotN/truth` in the world's.
    fn in_space(&mut self, robot: usize) -> Result<TruthInSpace> {
        let result = self.inner.in_space(robot);
        self.notes.note("in_space", &robot, &result);
        if let Ok(truth) = &result {
            self.notes.show(robot, &truth.pose);
        }
        result
    }
}

/// Records made beside a robot's calls: queries of the ground truth, and their answers.
#[derive(Debug)]
pub(super) struct Notes<W: Write> {
    port: Port<W>,
    /// Recorded length of each robot's lists.
    known: BTreeMap<usize, (usize, usize)>,
}

impl<W: Write> Notes<W> {
    pub(super) fn new(port: Port<W>) -> Self {
        Self { port, known: BTreeMap::new() }
    }

    /// Writes a query and its answer at the time of the robot's last call.
    pub(super) fn note<T: Put>(&mut self, method: &str, argument: &impl Put, result: &Result<T>) {
        self.note_at(None, method, argument, result);
    }

    /// The same at its own time.
    pub(super) fn note_at<T: Put>(
        &mut self,
        time: Option<Nanoseconds>,
        method: &str,
        argument: &impl Put,
        result: &Result<T>,
    ) {
        self.port.begin(time);
        self.port.argument(argument);
        self.port.end(TRUTH, method, result);
    }

    /// Writes the true pose of a robot for viewers.
    fn show(&mut self, robot: usize, pose: &Pose3) {
        let child = truth_frame(robot);
        self.port.show(TRANSFORMS, |out, frames| {
            transform_in_space(out, frames.time, WORLD, &child, pose);
        });
    }

    /// Writes a robot's ground truth, as far as not yet written.
    pub(super) fn note_robot(&mut self, robot: usize, result: &Result<RobotTruth>) {
        let known = self.known.entry(robot).or_default();
        let news = result.as_ref().map(|truth| News::since(*known, truth)).map_err(copy);
        if let Ok(truth) = result {
            *known = (truth.contact_places.len(), truth.trail.len());
        }
        self.note("robot", &robot, &news);
    }
}

/// An error with the same kind and message.
fn copy(error: &Error) -> Error {
    Error::new(error.kind(), error.to_string())
}

/// Ground truth of a robot, with only the new ends of its lists.
#[derive(Debug, Clone, PartialEq)]
struct News {
    /// Contact places and trail contain only new entries.
    truth: RobotTruth,
    /// Number of contact places and trail points before.
    before: (usize, usize),
}

impl News {
    fn since((places, trail): (usize, usize), truth: &RobotTruth) -> Self {
        // A list shorter than before is a new one.
        let before = (places.min(truth.contact_places.len()), trail.min(truth.trail.len()));
        let truth = RobotTruth {
            contact_places: truth.contact_places[before.0..].to_vec(),
            trail: truth.trail[before.1..].to_vec(),
            pose: truth.pose,
            odometry: truth.odometry,
            contacts: truth.contacts,
            path_length: truth.path_length,
        };
        Self { truth, before }
    }

    /// The complete truth, based on the previous one.
    fn after(self, old: Option<&RobotTruth>) -> RobotTruth {
        let places = old.map_or(&[][..], |old| &old.contact_places);
        let trail = old.map_or(&[][..], |old| &old.trail);
        let mut truth = self.truth;
        truth.contact_places =
            places.iter().take(self.before.0).copied().chain(truth.contact_places).collect();
        truth.trail = trail.iter().take(self.before.1).copied().chain(truth.trail).collect();
        truth
    }
}

impl Put for News {
    fn put(&self, out: &mut Values) {
        let RobotTruth { pose, odometry, contacts, contact_places, path_length, trail } = &self.truth;
        pose.put(out);
        odometry.put(out);
        path_length.put(out);
        contacts.put(out);
        for (before, new) in [(self.before.0, contact_places.len()), (self.before.1, trail.len())] {
            before.put(out);
            new.put(out);
        }
        for place in contact_places {
            out.numbers.extend([place.x, place.y]);
        }
        for point in trail {
            point.time.put(out);
            point.pose.put(out);
            point.odometry.put(out);
        }
    }
}

impl Take for News {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        let (pose, odometry) = (Pose::take(from)?, Pose::take(from)?);
        let (path_length, contacts) = (f64::take(from)?, u32::take(from)?);
        let (places, new_places) = (usize::take(from)?, usize::take(from)?);
        let (points, new_points) = (usize::take(from)?, usize::take(from)?);
        let mut contact_places = Vec::new();
        for _ in 0..new_places {
            contact_places.push(Point::new(f64::take(from)?, f64::take(from)?));
        }
        let mut trail = Vec::new();
        for _ in 0..new_points {
            trail.push(TrailPoint {
                time: f64::take(from)?,
                pose: Pose::take(from)?,
                odometry: Pose::take(from)?,
            });
        }
        let truth = RobotTruth { pose, odometry, contacts, contact_places, path_length, trail };
        Some(Self { truth, before: (places, points) })
    }
}

/// Ground truth from a recording, up to the replayed robot's position.
///
/// A query that was not recorded at this position gets the last answer of its kind.
#[derive(Debug, Clone)]
pub struct ReplayTruth {
    position: Position,
    /// The robot's next event to examine.
    next: usize,
    time: Option<f64>,
    poses: BTreeMap<usize, Pose>,
    objects: BTreeMap<usize, Pose>,
    in_space: BTreeMap<usize, TruthInSpace>,
    robots: BTreeMap<usize, RobotTruth>,
}

impl Player {
    /// The recorded ground truth along with a robot.
    pub fn truth(&self, robot: usize) -> std::result::Result<ReplayTruth, LogError> {
        self.position(robot).map(ReplayTruth::new)
    }
}

/// A query of the ground truth.
type Question<'a> = (&'a str, Option<usize>);

impl ReplayTruth {
    pub(super) fn new(position: Position) -> Self {
        let (poses, objects, in_space, robots) = Default::default();
        Self { position, next: 0, time: None, poses, objects, in_space, robots }
    }

    /// Processes the recorded answers up to the next one to a query, or all before the robot's next call if
    /// there is none.
    fn catch_up(&mut self, question: Question<'_>) {
        let position = self.position.clone();
        let end = position.next_call();
        let is_asked = |index: usize| {
            position.event(index).filter(|event| event.kind == Kind::Truth).is_some_and(|event| {
                Call::read(position.log().data(event)).is_some_and(|call| asked(&call) == question)
            })
        };
        // If the position was passed, the answers recorded there are read again in order.
        let behind = (self.next..end).find(|&index| is_asked(index));
        let last = behind.map_or(end, |index| index + 1);
        for index in self.next..last {
            let Some(event) = position.event(index).filter(|event| event.kind == Kind::Truth) else {
                continue;
            };
            if let Some(call) = Call::read(position.log().data(event)) {
                self.take_in(&call);
            }
        }
        self.next = self.next.max(last);
    }

    fn take_in(&mut self, call: &Call<'_>) {
        let Ok(result) = &call.result else { return };
        match asked(call) {
            ("time", None) => self.time = result.take().or(self.time),
            ("pose", Some(robot)) => {
                if let Some(pose) = result.take() {
                    self.poses.insert(robot, pose);
                }
            }
            ("object", Some(object)) => {
                if let Some(pose) = result.take() {
                    self.objects.insert(object, pose);
                }
            }
            ("in_space", Some(robot)) => {
                if let Some(truth) = result.take() {
                    self.in_space.insert(robot, truth);
                }
            }
            ("robot", Some(robot)) => {
                if let Some(news) = result.take::<News>() {
                    let truth = news.after(self.robots.get(&robot));
                    self.robots.insert(robot, truth);
                }
            }
            _ => {}
        }
    }
}

/// A pose, and its time (s) if that is not the query's.
type TimedPose = (Option<f64>, Pose);

/// True poses in a recorded answer: the robot, each with its time if that is not the query's.
pub(super) fn true_poses(call: &Call<'_>) -> Option<(usize, Vec<TimedPose>)> {
    let result = call.result.as_ref().ok()?;
    match asked(call) {
        ("pose", Some(robot)) => Some((robot, vec![(None, result.take()?)])),
        ("in_space", Some(robot)) => {
            let truth = result.take::<TruthInSpace>()?;
            Some((robot, vec![(None, truth.pose.pose())]))
        }
        ("robot", Some(robot)) => {
            let RobotTruth { pose, trail, .. } = result.take::<News>()?.truth;
            let before = trail.into_iter().map(|point| (Some(point.time), point.pose));
            Some((robot, before.chain([(None, pose)]).collect()))
        }
        _ => None,
    }
}

/// The query of a recorded call.
fn asked<'a>(call: &Call<'a>) -> Question<'a> {
    (call.method, call.arguments.take())
}

fn untold(what: &str) -> Error {
    Error::new(ErrorKind::Unsupported, format!("the recording does not say {what}"))
}

impl GroundTruth for ReplayTruth {
    fn time(&mut self) -> Result<f64> {
        self.catch_up(("time", None));
        self.time.ok_or_else(|| untold("what time it was in the world"))
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        self.catch_up(("pose", Some(robot)));
        self.poses.get(&robot).copied().ok_or_else(|| untold("where the robot was"))
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        self.catch_up(("robot", Some(robot)));
        self.robots.get(&robot).cloned().ok_or_else(|| untold("what was true about the robot"))
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        self.catch_up(("object", Some(object)));
        self.objects.get(&object).copied().ok_or_else(|| untold("where the object was"))
    }

    fn in_space(&mut self, robot: usize) -> Result<TruthInSpace> {
        self.catch_up(("in_space", Some(robot)));
        self.in_space.get(&robot).copied().ok_or_else(|| untold("where the robot was in space"))
    }
}
