use std::ops::ControlFlow;

use super::message::{CarIntent, CarReport, RoadMessage};
use super::sharing::{RoadSharing, RoadSharingParameters};
use crate::ParameterError;
use crate::drive::lane_keeping::{LaneObservation, LaneOutcome};
use crate::drive::traffic::driver::{TrafficDriver, TrafficState};
use crate::drive::traffic::parameters::TrafficParameters;
use crate::geometry::{Pose, Twist};
use crate::io::control::{Behaviour, Command, Decision, Senses};
use crate::io::{Camera, Drive, Odometry, Radio, RadioMessage, Result};
use crate::vision::lane_markings::{RoadCamera, RoadModel};
use crate::vision::road_elements::RoadElementKind;

/// Observation of a [`RadioCar`].
#[derive(Debug, Clone, Default)]
pub struct RadioCarObservation {
    /// Camera and odometry.
    pub lane: LaneObservation,
    /// Messages received.
    pub messages: Vec<RadioMessage>,
    /// Numbers of the other robots.
    pub others: Vec<u32>,
}

/// Command of a [`RadioCar`]: its speed, and what it tells the others.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RadioCarCommand {
    /// Speed.
    pub twist: Twist,
    /// A message and its receivers.
    pub message: Option<(Vec<u32>, String)>,
}

/// A [`TrafficDriver`] that shares the road with other cars by radio.
///
/// Five times a second it tells the others and the base station where it is, whether it is in its lane, and
/// what it is about to do ([`RoadMessage`]); by what they tell, it drives as [`RoadSharing`] permits. All
/// poses are in the frame of the lane's centre where laps start. Each start line that the car passes corrects
/// its odometry.
#[derive(Debug, Clone)]
pub struct RadioCar {
    driver: TrafficDriver,
    sharing: RoadSharing,
    /// The frame of odometry in the shared one.
    frame: Pose,
    /// Time of the next report (s).
    due: f64,
    /// Whether the last start line has corrected the frame.
    is_corrected: bool,
}

/// Distance ahead of the origin at which a start line corrects the pose: it is near, and still in view (m).
const CORRECTS: f64 = 0.6;

impl RadioCar {
    /// Creates a car for a camera and a road that starts at a pose. Fails for parameters out of range.
    pub fn new(
        camera: RoadCamera,
        road: RoadModel,
        (driving, sharing): (TrafficParameters, RoadSharingParameters),
        start: Pose,
    ) -> std::result::Result<Self, ParameterError> {
        Ok(Self {
            driver: TrafficDriver::new(camera, road, driving)?,
            sharing: RoadSharing::new(sharing)?,
            frame: start,
            due: 0.0,
            is_corrected: true,
        })
    }

    /// The driver.
    pub fn driver(&self) -> &TrafficDriver {
        &self.driver
    }

    /// Pose in the shared frame at an odometry pose.
    pub fn pose(&self, odometry: &Pose) -> Pose {
        self.frame.compose(odometry)
    }

    /// Corrects the frame when a start line is near.
    fn correct(&mut self, odometry: &Pose) {
        let line = self.driver.elements().find(|element| element.kind == RoadElementKind::StartLine);
        let Some(line) = line else {
            self.is_corrected = false;
            return;
        };
        let Some(lane) = self.driver.keeper().lane() else { return };
        if self.is_corrected || line.ahead > CORRECTS {
            return;
        }
        self.is_corrected = true;
        // The lane's centre at the line is the frame's origin.
        self.frame = lane.place(line.ahead).inverse().compose(&odometry.inverse());
    }

    fn report(&self, odometry: &Pose, speed: f64, sharing: CarIntent) -> CarReport {
        let lane = self.driver.keeper().lane();
        let intent = match self.driver.state() {
            TrafficState::Wait => CarIntent::Stand,
            _ => sharing,
        };
        CarReport {
            pose: self.pose(odometry),
            speed,
            curvature: lane.map_or(0.0, |lane| lane.curvature),
            is_in_lane: lane.is_none_or(|lane| lane.offset.abs() < 0.5 * lane.edge),
            intent,
        }
    }
}

impl Behaviour for RadioCar {
    type Observation = RadioCarObservation;
    type Command = RadioCarCommand;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.driver.period()
    }

    fn step(&mut self, time: f64, seen: &RadioCarObservation) -> Decision<Self> {
        seen.lane.check()?;
        for RadioMessage { from, data } in &seen.messages {
            if let Some(message) = RoadMessage::read(data) {
                self.sharing.hear(time, *from, message);
            }
        }
        let LaneObservation { odometry, speed, .. } = seen.lane;
        let pose = self.pose(&odometry);
        let (most, intent) = match self.driver.keeper().lane() {
            Some(lane) => {
                let path: Vec<Pose> =
                    RoadSharing::distances().map(|ahead| pose.compose(&lane.place(ahead))).collect();
                self.sharing.limit(time, &path, speed)
            }
            None => (f64::INFINITY, CarIntent::Drive),
        };
        self.driver.set_limit(most);
        let twist = match self.driver.step(time, &seen.lane)? {
            ControlFlow::Continue(twist) => twist,
            ControlFlow::Break(outcome) => return Ok(ControlFlow::Break(outcome)),
        };
        self.correct(&odometry);
        let is_due = time >= self.due;
        if is_due {
            self.due = time + self.sharing.parameters().interval;
        }
        let message = is_due.then(|| {
            let report = self.report(&odometry, speed, intent);
            (seen.others.clone(), RoadMessage::Car(report).to_string())
        });
        Ok(ControlFlow::Continue(RadioCarCommand { twist, message }))
    }
}

impl<R: Camera + Odometry + Radio + ?Sized> Senses<R> for RadioCar {
    fn prepare(&mut self, robot: &mut R) -> Result<()> {
        self.driver.prepare(robot)
    }

    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut RadioCarObservation) -> Result<()> {
        self.driver.sense(robot, time, &mut seen.lane)?;
        (seen.messages, seen.others) = listen(robot)?;
        Ok(())
    }
}

/// The messages that have arrived, and the numbers of the other robots.
pub(super) fn listen<R: Radio + ?Sized>(robot: &mut R) -> Result<(Vec<RadioMessage>, Vec<u32>)> {
    let mut messages = Vec::new();
    while let Some(message) = robot.receive()? {
        messages.push(message);
    }
    let own = robot.radio_id()?;
    let others = robot.radio_peers()?.into_iter().filter(|peer| *peer != own).collect();
    Ok((messages, others))
}

impl<R: Drive + Radio + ?Sized> Command<R> for RadioCarCommand {
    fn apply(&self, robot: &mut R) -> Result<()> {
        self.twist.apply(robot)?;
        let Some((receivers, text)) = &self.message else { return Ok(()) };
        receivers.iter().try_for_each(|receiver| robot.send(*receiver, text.as_bytes()))
    }

    fn stop(robot: &mut R) -> Result<()> {
        <Twist as Command<R>>::stop(robot)
    }
}
