use std::collections::BTreeMap;

use ambassador::Delegate;
use image::RgbImage;

use super::health::{HealthLimits, OdometryHealth, ReadingHealth, digest};
use super::{
    Beat, Causes, Deadline, Debounce, Panel, SafetyCore, SafetyInputs, SafetyState, Station, StoppingModel,
    is_inside,
};
use crate::geometry::{Point, Pose, Twist};
use crate::io::delegate::{
    ambassador_impl_Display, ambassador_impl_Encoders, ambassador_impl_Keys, ambassador_impl_Radio,
};
use crate::io::{
    Camera, Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Error, ErrorKind, Fill, Font,
    Key, Keys, Lidar, LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Resolution,
    Result, Servos, Viewport,
};
use crate::world::Colour;

/// What a vehicle is supervised by.
#[derive(Debug, Clone, PartialEq)]
pub struct SupervisorParameters {
    /// Seconds between two looks at everything.
    pub period: f64,
    /// Seconds without a heartbeat of the base station that are allowed.
    pub heartbeat: f64,
    /// Seconds without a call of the driving program that are allowed.
    pub watchdog: f64,
    /// Corners of the area that must not be left, in the frame of odometry; without three of them there is no fence.
    pub fence: Vec<Point>,
    /// Looks in a row outside before it counts.
    pub fence_debounce: u16,
    /// How far a pedal has to be pressed, or how hard the wheel has to be held, before the driver has taken over.
    pub override_threshold: f64,
    /// The deceleration of a safe stop, in m/s²; an emergency stop takes all that there is.
    pub gentle: f64,
    /// Metres per second, and radians per second, below which the vehicle stands.
    pub standing: [f64; 2],
    /// What sensors may do.
    pub health: HealthLimits,
}

impl Default for SupervisorParameters {
    fn default() -> Self {
        Self {
            period: 0.02,
            heartbeat: 0.5,
            watchdog: 0.4,
            fence: Vec::new(),
            fence_debounce: 3,
            override_threshold: 0.1,
            gentle: 3.0,
            standing: [0.01, 0.02],
            health: HealthLimits::default(),
        }
    }
}

impl SupervisorParameters {
    /// How a vehicle stops that follows speeds with a lag and a greatest deceleration: it reacts within one control period, and
    /// brakes as gently as is allowed.
    pub fn stopping(&self, lag: f64, deceleration: f64) -> StoppingModel {
        StoppingModel { reaction: 2.0 * self.period, lag, deceleration: deceleration.min(self.gentle) }
    }

    fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("control period", self.period),
            ("heartbeat", self.heartbeat),
            ("watchdog", self.watchdog),
            ("threshold of the override", self.override_threshold),
            ("gentle deceleration", self.gentle),
        ] {
            crate::io::error::require_positive(name, value)?;
        }
        if self.fence.iter().any(|corner| !(corner.x.is_finite() && corner.y.is_finite())) {
            return Err(Error::invalid_input("corner of the fence", "no number", "finite coordinates"));
        }
        Ok(())
    }
}

/// A stop that has begun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopRecord {
    /// When, in seconds of the robot's clock as it was believed.
    pub time: f64,
    /// Why.
    pub causes: Causes,
    /// The state that it led to.
    pub state: SafetyState,
    /// The speed at which the vehicle went.
    pub speed: f64,
}

/// A robot under the safety system of a car that drives by wire (book, sections 14.2 and 14.3).
///
/// It is a robot like the one inside, but a program's commands reach the wheels in the state [`SafetyState::Auto`] alone, and
/// whenever time passes, every control period, it looks at the buttons, the heartbeat of the base station, the fence, the
/// pedals, the program and the sensors. When something is wrong, it brakes, and keeps the curvature that was being driven
/// until the vehicle stands; then it stands until somebody arms it again.
///
/// A program that hangs does so between two calls, or in a [`wait`](Clock::wait) that is longer than the watchdog allows.
///
/// ```
/// use roverlab::drive::safety::{Beat, Panel, Requests, SafetyState, Supervised, SupervisorParameters};
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Clock, Drive, MockRobot};
///
/// # fn main() -> roverlab::io::Result<()> {
/// // Armed and started at once; the stop button is pressed after a second.
/// let station = |now: f64, beat: Beat| Panel {
///     heartbeat: Some(beat.count),
///     requests: Requests { arm: now > 0.0, start: now > 0.05, disarm: false },
///     remote_stop: now > 1.0,
///     ..Panel::default()
/// };
/// let robot = MockRobot::new().with_ideal_drive();
/// let mut car = Supervised::new(robot, station, SupervisorParameters::default())?;
/// car.wait(0.1)?;
/// for _ in 0..20 {
///     car.set_speed(Twist::new(0.5, 0.0))?;
///     car.wait(0.1)?;
/// }
/// assert_eq!((car.state(), car.speed()?), (SafetyState::EmergencyStop, Twist::STOP));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Delegate)]
#[expect(clippy::duplicated_attributes, reason = "every capability has the same target")]
#[delegate(Display, target = "inner")]
#[delegate(Keys, target = "inner")]
#[delegate(Radio, target = "inner")]
#[delegate(Encoders, target = "inner")]
pub struct Supervised<R, S> {
    inner: R,
    station: S,
    parameters: SupervisorParameters,
    core: SafetyCore,
    /// What calls of the program have shown since the last look.
    seen: Causes,
    heartbeat: Deadline,
    heard: Option<u64>,
    beat: u64,
    /// Time that passed by waiting, which is what the watchdog goes by: a clock may stop.
    waited: f64,
    /// When it looks next, in that time.
    due: f64,
    watchdog: Deadline,
    outside: Debounce,
    odometry: OdometryHealth,
    scans: ReadingHealth,
    images: ReadingHealth,
    distances: BTreeMap<Psd, ReadingHealth>,
    clock: Option<f64>,
    pose: Pose,
    /// The speed measured last, and the curvature driven last.
    speed: f64,
    curvature: f64,
    /// The speed asked for while it brakes.
    braking: Option<f64>,
    causes: Causes,
    stop: Option<StopRecord>,
}

impl<R: Clock + Drive, S: Station> Supervised<R, S> {
    /// A robot in the hands of a person, with somebody at the other end.
    ///
    /// Fails with the name of the parameter that is out of range.
    pub fn new(inner: R, station: S, parameters: SupervisorParameters) -> Result<Self> {
        parameters.validate()?;
        let mut watchdog = Deadline::new(parameters.watchdog);
        watchdog.feed(0.0);
        Ok(Self {
            inner,
            station,
            core: SafetyCore::new(),
            seen: Causes::NONE,
            heartbeat: Deadline::new(parameters.heartbeat),
            heard: None,
            beat: 0,
            waited: 0.0,
            due: 0.0,
            watchdog,
            outside: Debounce::new(parameters.fence_debounce),
            odometry: OdometryHealth::new(),
            scans: ReadingHealth::default(),
            images: ReadingHealth::default(),
            distances: BTreeMap::new(),
            clock: None,
            pose: Pose::default(),
            speed: 0.0,
            curvature: 0.0,
            braking: None,
            causes: Causes::NONE,
            stop: None,
            parameters,
        })
    }

    /// The present state.
    pub fn state(&self) -> SafetyState {
        self.core.state()
    }

    /// What is wrong now.
    pub fn causes(&self) -> Causes {
        self.causes
    }

    /// The last stop.
    pub fn last_stop(&self) -> Option<StopRecord> {
        self.stop
    }

    /// The other end.
    pub fn station_mut(&mut self) -> &mut S {
        &mut self.station
    }

    /// The robot inside.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The robot inside, unsupervised.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// The driver drives: reaches the wheels in the state [`SafetyState::Manual`] alone. Whether it did.
    pub fn drive_by_hand(&mut self, twist: Twist) -> Result<bool> {
        let manual = self.core.state() == SafetyState::Manual;
        if manual {
            self.inner.set_speed(twist)?;
        }
        Ok(manual)
    }

    /// The program is alive.
    fn alive(&mut self) {
        self.watchdog.feed(self.waited);
    }

    /// One look at everything, and what follows from it.
    fn look(&mut self) {
        let mut causes = std::mem::take(&mut self.seen);
        causes = causes.with(self.read_clock());
        let (odometry, standing) = self.read_odometry();
        causes = causes.with(odometry);
        causes = causes.with_if(self.watchdog.is_over(self.waited), Causes::WATCHDOG);
        self.beat += 1;
        let beat = Beat { count: self.beat, state: self.core.state() };
        let panel = self.station.exchange(self.waited, beat);
        causes = causes.with(self.read_panel(&panel));
        let before = self.core.state();
        let state = self.core.step(SafetyInputs { causes, requests: panel.requests, standing });
        self.causes = causes;
        if state.severity() > before.severity() {
            self.stop = Some(StopRecord { time: self.waited, causes, state, speed: self.speed });
        }
        self.act(before, state, standing);
    }

    /// The clock has to go on while time passes.
    fn read_clock(&mut self) -> Causes {
        match self.inner.now() {
            Err(_) => Causes::LINK,
            Ok(now) => {
                let went_on = self.clock.replace(now).is_none_or(|before| {
                    let passed = now - before;
                    // It may also have passed in calls, but not stood, and not leapt.
                    passed > 0.2 * self.parameters.period && passed < self.parameters.period + 0.5
                });
                Causes::NONE.with_if(!went_on, Causes::CLOCK)
            }
        }
    }

    /// What odometry says, and whether the vehicle stands.
    fn read_odometry(&mut self) -> (Causes, bool) {
        match (self.inner.pose(), self.inner.speed()) {
            (Ok(pose), Ok(speed)) => {
                let limits = self.parameters.health;
                if !self.odometry.read(self.waited, pose, speed, &limits) {
                    return (Causes::SENSOR, false);
                }
                self.pose = pose;
                self.speed = speed.linear;
                let corners: Vec<[f64; 2]> = self.parameters.fence.iter().map(|p| [p.x, p.y]).collect();
                let outside = corners.len() >= 3 && !is_inside(&corners, [pose.x, pose.y]);
                let outside = self.outside.update(outside);
                let [linear, angular] = self.parameters.standing;
                let standing = speed.linear.abs() < linear && speed.angular.abs() < angular;
                (Causes::NONE.with_if(outside, Causes::OUTSIDE_FENCE), standing)
            }
            (Err(error), _) | (_, Err(error)) => (fault(&error), false),
        }
    }

    fn read_panel(&mut self, panel: &Panel) -> Causes {
        if panel.heartbeat.is_some() && panel.heartbeat != self.heard {
            self.heard = panel.heartbeat;
            self.heartbeat.feed(self.waited);
        }
        let threshold = self.parameters.override_threshold;
        // What is no number is taken for a driver who does something.
        let quiet = |value: f64| value.abs() <= threshold;
        let driver = panel.disengage
            || !(quiet(panel.accelerator) && quiet(panel.brake) && quiet(panel.steering_force));
        Causes::NONE
            .with_if(panel.emergency_button, Causes::EMERGENCY_BUTTON)
            .with_if(panel.remote_stop, Causes::REMOTE_STOP)
            .with_if(self.heartbeat.is_over(self.waited), Causes::HEARTBEAT_LOST)
            .with_if(driver, Causes::DRIVER)
    }

    /// Brakes where the state asks for it. Errors are looked at in the next period, when the link is asked again.
    fn act(&mut self, before: SafetyState, state: SafetyState, standing: bool) {
        if !state.is_stop() {
            self.braking = None;
            if before == SafetyState::Auto && state == SafetyState::Manual {
                // The driver has it: nothing of the program's is left.
                let _ = self.inner.set_speed(Twist::STOP);
            }
            return;
        }
        let slower = match (state, self.braking) {
            (SafetyState::EmergencyStop, _) => 0.0,
            (_, None) => self.speed,
            (_, Some(speed)) => speed,
        };
        let step = self.parameters.gentle * self.parameters.period;
        let speed = slower - slower.clamp(-step, step);
        self.braking = Some(speed);
        // The curvature is kept, by a speed next to none: brakes act before the steering does.
        let least = if standing { 0.0 } else { 1e-6_f64.copysign(self.speed) };
        let speed = if speed == 0.0 { least } else { speed };
        let _ = self.inner.set_speed(Twist::new(speed, speed * self.curvature));
    }

    /// Whether the program may drive now; it lives, in any case.
    fn may_drive(&mut self) -> bool {
        self.alive();
        self.core.state().lets_drive()
    }

    fn note<T>(&mut self, answer: Result<T>) -> Result<T> {
        if let Err(error) = &answer {
            self.seen = self.seen.with(fault(error));
        }
        answer
    }
}

/// What an error of a sensor is a sign of. That it was never there, or that the program asked for nonsense, is none.
fn fault(error: &Error) -> Causes {
    match error.kind() {
        ErrorKind::Unsupported | ErrorKind::InvalidInput => Causes::NONE,
        ErrorKind::Disconnected => Causes::SENSOR.with(Causes::LINK),
        _ => Causes::SENSOR,
    }
}

impl<R: Clock + Drive, S: Station> Clock for Supervised<R, S> {
    fn now(&mut self) -> Result<f64> {
        self.alive();
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.alive();
        let mut left = seconds;
        let mut answer = Ok(());
        while left > 1e-9 {
            let part = left.min(self.due - self.waited).max(1e-9);
            let waited = self.inner.wait(part);
            self.waited += part;
            left -= part;
            if let Err(error) = waited {
                self.seen =
                    self.seen.with(fault(&error)).with_if(error.kind() == ErrorKind::TimedOut, Causes::LINK);
                answer = Err(error);
            }
            if self.waited >= self.due - 1e-9 {
                self.due = self.waited + self.parameters.period;
                self.look();
            }
            if answer.is_err() {
                break;
            }
        }
        answer
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive, S: Station> Drive for Supervised<R, S> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        if !self.may_drive() {
            return Ok(());
        }
        if twist.linear.abs() > 1e-3 {
            self.curvature = twist.angular / twist.linear;
        } else {
            self.curvature = 0.0;
        }
        let answer = self.inner.set_speed(twist);
        self.note(answer)
    }

    fn speed(&mut self) -> Result<Twist> {
        self.alive();
        let answer = self.inner.speed();
        self.note(answer)
    }

    fn pose(&mut self) -> Result<Pose> {
        self.alive();
        let answer = self.inner.pose();
        self.note(answer)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.alive();
        self.odometry.forget();
        self.inner.set_pose(pose)
    }

    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        if !self.may_drive() {
            return Ok(());
        }
        self.curvature = 0.0;
        self.inner.straight(distance, speed)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        if !self.may_drive() {
            return Ok(());
        }
        self.curvature = 0.0;
        self.inner.turn(angle, speed)
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        if !self.may_drive() {
            return Ok(());
        }
        self.curvature = if length.abs() > 1e-3 { angle / length } else { 0.0 };
        self.inner.curve(length, angle, speed)
    }

    fn remaining(&mut self) -> Result<f64> {
        self.alive();
        self.inner.remaining()
    }

    fn is_done(&mut self) -> Result<bool> {
        self.alive();
        self.inner.is_done()
    }

    fn wait_done(&mut self) -> Result<()> {
        // A manoeuvre that stopped is none that runs: what brakes is a speed.
        while !self.inner.is_done()? && !self.inner.is_stalled()? && self.core.state().lets_drive() {
            self.wait(self.parameters.period)?;
        }
        Ok(())
    }

    fn is_stalled(&mut self) -> Result<bool> {
        self.alive();
        self.inner.is_stalled()
    }
}

impl<R: Clock + Drive + Motors, S: Station> Motors for Supervised<R, S> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        if self.may_drive() { self.inner.set_motor(motor, fraction) } else { Ok(()) }
    }
}

impl<R: Clock + Drive + Servos, S: Station> Servos for Supervised<R, S> {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        if self.may_drive() { self.inner.set_servo(servo, position) } else { Ok(()) }
    }
}

impl<R: Clock + Drive + Lidar, S: Station> Lidar for Supervised<R, S> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.alive();
        let answer = self.inner.scan_into(scan);
        if answer.is_ok() {
            let number = !scan.ranges.iter().any(|range| range.is_nan());
            let shows = scan.ranges.iter().any(|range| range.is_finite());
            let digest = shows.then(|| digest(scan.ranges.iter().map(|range| range.to_bits())));
            let good = self.scans.read(digest, self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(!(number && good), Causes::SENSOR);
        }
        self.note(answer)
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.inner.configure_lidar(settings)
    }
}

impl<R: Clock + Drive + DistanceSensors, S: Station> DistanceSensors for Supervised<R, S> {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        self.alive();
        let answer = self.inner.distance(sensor);
        if let Ok(distance) = answer {
            let digest = distance.is_finite().then(|| distance.to_bits());
            let health = self.distances.entry(sensor).or_default();
            let good = health.read(digest, self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(distance.is_nan() || !good, Causes::SENSOR);
        }
        self.note(answer)
    }
}

impl<R: Clock + Drive + Camera, S: Station> Camera for Supervised<R, S> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.inner.set_resolution(resolution)
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.inner.resolution()
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        self.alive();
        let answer = self.inner.image_into(image);
        if answer.is_ok() {
            let black = image.as_raw().iter().all(|level| *level == 0);
            let digest = digest(image.as_raw().iter().map(|level| u64::from(*level)));
            let good = self.images.read(Some(digest), self.pose, &self.parameters.health);
            self.seen = self.seen.with_if(black || !good, Causes::SENSOR);
        }
        self.note(answer)
    }
}
