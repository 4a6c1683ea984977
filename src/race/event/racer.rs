use super::layout::{EventLayout, EventShape};
use super::line;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist};
use crate::io::LidarScan;
use crate::parameter::{require, require_positive, require_up_to};
use crate::race::cone::{Cone, ConeColour};
use crate::race::error::LineError;
use crate::race::grip::GripLimit;
use crate::race::lane_model::FARTHEST;
use crate::race::map::{ConeMap, ConeMapParameters, STRIDE};
use crate::race::profile::{CarLimits, SpeedProfile};
use crate::race::racer::{ASTRAY, RacerParameters, STILL};
use crate::race::racing_line::CarOutline;
use crate::race::reckoning::Reckoning;
use crate::race::sight::{ConeSighting, sightings};
use crate::race::tracker::{CRAWL, LineTracker, LineTrackerParameters};
use crate::race::tyres::Tyres;

/// Parameters of [`EventRacer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventParameters {
    /// Limits of tyres and motors.
    pub limits: CarLimits,
    /// Outline of the car, for the clearance from cones.
    pub outline: CarOutline,
    /// Parameters of the map.
    pub map: ConeMapParameters,
    /// Parameters of the line tracker.
    pub tracker: LineTrackerParameters,
    /// Distance from the nose at the start to the finish of an acceleration (m): to the start line, plus 75
    /// m.
    pub strip: f64,
    /// Distance of the nose behind the finish at the end: acceleration, skidpad (m).
    pub stop: [f64; 2],
    /// Speed up to the first circle of a skidpad (m/s).
    pub entry: f64,
    /// Time without cones that fit the layout after which the car stops: while searching, while driving (s).
    pub patience: [f64; 2],
    /// Control period (s).
    pub period: f64,
}

impl Default for EventParameters {
    fn default() -> Self {
        let RacerParameters { limits, outline, map, tracker, period, .. } = RacerParameters::default();
        Self {
            // A steady circle demands less of steering and tyres than changing bends.
            limits: CarLimits {
                grip: GripLimit::Balance(Tyres { grip: 11.7, ..Tyres::default() }),
                brake: 10.0,
                ..limits
            },
            outline: CarOutline { room: 0.3, ..outline },
            map,
            tracker,
            strip: 75.3,
            // The shortest lanes behind the finish are 25 and 21 m long.
            stop: [21.5, 15.0],
            entry: 6.0,
            patience: [3.0, 0.6],
            period,
        }
    }
}

impl EventParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.limits.validate().map_err(|error| error.of("limits"))?;
        self.outline.validate().map_err(|error| error.of("outline"))?;
        self.map.validate().map_err(|error| error.of("map"))?;
        self.tracker.validate().map_err(|error| error.of("tracker"))?;
        require_up_to("strip", self.strip, FARTHEST)?;
        for metres in self.stop {
            require("stop", metres, (0.0..=FARTHEST).contains(&metres), "0 to 1000 m")?;
        }
        require_positive("entry", self.entry)?;
        self.patience.into_iter().try_for_each(|seconds| require_positive("patience", seconds))?;
        require_positive("control period", self.period)
    }
}

/// Phase of a car at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EventPhase {
    /// Searches for the layout, initially at rest.
    Looking,
    /// Drives.
    Driving,
    /// Has crossed the finish and stands.
    Finished,
    /// Sees no cones that fit the layout, and stops.
    Lost,
}

/// Drives an acceleration or a skidpad with unknown cones and a known layout.
///
/// In every control period, the layout is fitted to recently seen cones; the line is given in its frame. In
/// an acceleration, the car follows the centre line at full throttle and stops within the shortest lane
/// behind a finish. In a skidpad, it circles the inner cones as closely as is safe.
#[derive(Debug, Clone)]
pub struct EventRacer {
    pub(in crate::race) parameters: EventParameters,
    event: EventShape,
    map: ConeMap,
    reckoning: Reckoning,
    layout: Option<EventLayout>,
    phase: EventPhase,
    line: Option<LineTracker>,
    /// The layout's shape for which the line was planned.
    planned: EventShape,
    /// Time (s), distance (m), and time since cones last fitted the layout (s).
    time: f64,
    way: f64,
    blind: f64,
}

/// Time of observation before the car moves (s).
const LOOKS: f64 = 0.3;
/// Distance before the origin of a skidpad, and behind the start of a strip, at which lines begin (m).
const BEFORE: f64 = 30.0;
/// Change of a layout parameter at which the line is planned again (m).
const CHANGED: f64 = 0.02;
/// Distance from a cone to the side of a car that passes it (m).
const BESIDE: f64 = 0.07;
/// Distance ahead within which cones in the way matter (m).
const AHEAD: f64 = 45.0;

impl EventRacer {
    /// A car before the start of an acceleration.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn acceleration(parameters: EventParameters) -> Result<Self, ParameterError> {
        Self::new(EventShape::STRIP, &parameters)
    }

    /// A car before the start of a skidpad.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn skidpad(parameters: EventParameters) -> Result<Self, ParameterError> {
        Self::new(EventShape::EIGHT, &parameters)
    }

    fn new(event: EventShape, parameters: &EventParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self {
            parameters: *parameters,
            event,
            map: ConeMap::new(parameters.map)?,
            reckoning: Reckoning::default(),
            layout: None,
            phase: EventPhase::Looking,
            line: None,
            planned: event,
            time: 0.0,
            way: 0.0,
            blind: 0.0,
        })
    }

    /// Present phase.
    pub fn phase(&self) -> EventPhase {
        self.phase
    }

    /// Map of the cones seen, in the frame of its start.
    pub fn map(&self) -> &ConeMap {
        &self.map
    }

    /// Estimated layout, in the frame of the map.
    pub fn layout(&self) -> Option<&EventLayout> {
        self.layout.as_ref()
    }

    /// The line that it follows, in the frame of the layout.
    pub fn line(&self) -> Option<&LineTracker> {
        self.line.as_ref()
    }

    /// Command for a pose and a velocity by odometry and a scan.
    pub fn step(&mut self, odometry: Pose, speed: Twist, scan: &LidarScan) -> Twist {
        self.decide(odometry, speed, &sightings(scan))
    }

    /// The same for detections of a lidar or a camera. Call it once per [`period`](EventParameters::period).
    /// If odometry is not finite, the car brakes.
    pub fn decide(&mut self, odometry: Pose, speed: Twist, seen: &[ConeSighting]) -> Twist {
        if !(odometry.is_finite() && speed.is_finite()) {
            return Twist::STOP;
        }
        self.way += self.reckoning.step(odometry, speed, &self.parameters.tracker.tyres);
        self.map.update(self.reckoning.pose(), seen);
        self.time += self.parameters.period;
        let fresh: Vec<Cone> = self.map.fresh_cones().collect();
        self.localise(&fresh, seen);
        match self.phase {
            EventPhase::Looking => self.look(&fresh),
            EventPhase::Driving => self.drive(speed, &fresh),
            EventPhase::Finished => Twist::default(),
            EventPhase::Lost => self.brake(speed),
        }
    }

    /// Whether it has finished driving and stands.
    pub fn is_done(&self, speed: Twist) -> bool {
        matches!(self.phase, EventPhase::Finished | EventPhase::Lost) && speed.linear.abs() < STILL
    }

    /// Finds or follows the layout, and measures how long no detection has fitted it.
    fn localise(&mut self, fresh: &[Cone], seen: &[ConeSighting]) {
        let Some(layout) = &mut self.layout else {
            self.blind = if seen.is_empty() { self.blind + self.parameters.period } else { 0.0 };
            if self.time >= LOOKS {
                self.layout = self.find(fresh);
            }
            return;
        };
        layout.follow(fresh);
        let fits = !seen.is_empty() && layout.fits(fresh);
        self.blind = if fits { 0.0 } else { self.blind + self.parameters.period };
    }

    fn find(&self, fresh: &[Cone]) -> Option<EventLayout> {
        let mut found = EventLayout::find(fresh, self.map.pose(), self.event)?;
        if matches!(self.event, EventShape::Strip { .. }) {
            // The origin of a strip is the initial position of the nose.
            found.pose = found.pose.compose(&Pose::new(self.parameters.outline.nose - self.way, 0.0, 0.0));
        }
        Some(found)
    }

    /// Stands, then creeps forward, until the layout is found.
    fn look(&mut self, fresh: &[Cone]) -> Twist {
        if let Some(layout) = self.layout {
            self.planned = layout.shape;
            let tracker = self.parameters.tracker;
            self.line = self
                .plan(layout.shape)
                .ok()
                .and_then(|(points, profile)| LineTracker::new(points, profile, false, tracker).ok());
            self.phase = if self.line.is_some() { EventPhase::Driving } else { EventPhase::Lost };
            return Twist::default();
        }
        if self.blind >= self.parameters.patience[0] || self.way >= ASTRAY {
            self.phase = EventPhase::Lost;
        }
        let outline = self.parameters.outline;
        let pose = self.map.pose();
        let free = fresh.iter().all(|cone| {
            let local = pose.to_local(cone.position);
            local.y.abs() > self.beside() || !(0.0..outline.nose + 2.0).contains(&local.x)
        });
        let creeps =
            self.time >= 2.0 * LOOKS && self.blind == 0.0 && free && self.phase == EventPhase::Looking;
        if creeps { Twist::new(CRAWL, 0.0) } else { Twist::default() }
    }

    /// Distance from the line at which a car would touch a cone, plus a margin (m).
    fn beside(&self) -> f64 {
        self.parameters.outline.half_width + ConeColour::Unknown.radius() + BESIDE
    }

    /// The line in the frame of a layout, with its speeds.
    fn plan(&self, shape: EventShape) -> Result<(Vec<Point>, SpeedProfile), LineError> {
        let p = &self.parameters;
        // The line is that of a point behind the nose.
        let behind = p.outline.nose - p.outline.ahead;
        let (points, entered) = match shape {
            EventShape::Strip { .. } => {
                (line::straight(-behind - BEFORE, p.strip + p.stop[0] - behind), f64::NEG_INFINITY)
            }
            EventShape::Eight { apart, .. } => {
                let room = p.outline.half_width + ConeColour::Unknown.radius() + p.outline.room;
                let ends = [-BEFORE, p.stop[1] - behind];
                (line::smooth_eight(apart, line::radius(shape, room), ends), -STRIDE)
            }
        };
        let mut profile = SpeedProfile::open(&points, &p.limits, p.limits.top_speed, 0.0)?;
        let entry = points.iter().zip(&mut profile.speeds).take_while(|(point, _)| point.x < entered);
        entry.for_each(|(_, speed)| *speed = speed.min(p.entry));
        Ok((points, profile))
    }

    fn drive(&mut self, speed: Twist, fresh: &[Cone]) -> Twist {
        self.adapt();
        // Behind the finish there may be no cones any more: the car stops as soon as it sees none.
        let is_over = self.blind >= self.parameters.patience[1] && self.is_behind_finish();
        if (is_over || self.remaining() < STRIDE) && speed.linear.abs() < STILL {
            self.phase = EventPhase::Finished;
            return Twist::default();
        }
        if is_over {
            return self.brake(speed);
        }
        if self.blind >= self.parameters.patience[1] {
            self.phase = EventPhase::Lost;
        }
        let command = self.follow(speed);
        self.before_cones(command, fresh)
    }

    /// Replans if the numbers of the layout have changed.
    fn adapt(&mut self) {
        let Some(layout) = self.layout else { return };
        let (now, before) = (layout.shape.numbers(), self.planned.numbers());
        let changed = now.iter().zip(before).any(|(now, before)| (now - before).abs() > CHANGED);
        if !changed || matches!(layout.shape, EventShape::Strip { .. }) {
            return;
        }
        if let (Ok((points, profile)), Some(line)) = (self.plan(layout.shape), &mut self.line) {
            line.shift(points, profile);
            self.planned = layout.shape;
        }
    }

    fn follow(&mut self, speed: Twist) -> Twist {
        let Some((layout, line)) = self.layout.as_ref().zip(self.line.as_mut()) else {
            return Twist::default();
        };
        let pose = layout.pose.inverse().compose(&self.map.pose());
        line.step(pose, speed).map_or(Twist::default(), |(twist, _)| twist)
    }

    /// Length of the line ahead (m).
    fn remaining(&self) -> f64 {
        self.line.as_ref().map_or(f64::INFINITY, |line| {
            line.profile().lengths[line.passed()..line.points().len() - 1].iter().sum()
        })
    }

    fn is_behind_finish(&self) -> bool {
        let stop = self.parameters.stop;
        self.remaining() < if matches!(self.event, EventShape::Strip { .. }) { stop[0] } else { stop[1] }
    }

    /// Limits a command so that the car stops before obstacles, such as the cones at the end of a lane.
    fn before_cones(&self, command: Twist, fresh: &[Cone]) -> Twist {
        let Some((layout, line)) = self.layout.as_ref().zip(self.line.as_ref()) else { return command };
        let p = &self.parameters;
        let places = fresh.iter().map(|cone| cone.position).chain(self.map.fresh_others());
        let places = places.map(|place| layout.pose.to_local(place));
        let gaps = places.filter_map(|place| line.distance_to(place, self.beside(), AHEAD));
        let Some(gap) = gaps.min_by(f64::total_cmp) else { return command };
        let free = (gap - (p.outline.nose - p.outline.ahead) - p.outline.room).max(0.0);
        slowed(command, (1.6 * p.limits.brake * free).sqrt())
    }

    /// Brakes along the line as long as there is one.
    fn brake(&mut self, speed: Twist) -> Twist {
        let command = self.follow(speed);
        if speed.linear > 0.1 { slowed(command, (speed.linear - 0.5).max(0.0)) } else { Twist::default() }
    }
}

/// Limits the speed of a command, preserving its curvature.
fn slowed(command: Twist, fastest: f64) -> Twist {
    if command.linear <= fastest {
        return command;
    }
    let share = fastest.max(1e-3) / command.linear;
    Twist::new(fastest.max(1e-3), command.angular * share)
}
