use super::health::{OdometryHealth, ReadingHealth, Trust};
use super::{
    Causes, Deadline, Debounce, Heartbeat, Panel, SafetyCore, SafetyInputs, SafetyState, Station,
    SupervisedParameters, is_inside,
};
use crate::geometry::{Pose, Twist};
use crate::io::{Clock, Drive, Error, ErrorKind, Odometry, Result};

/// Record of a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopRecord {
    /// Start of the stop (s), on the clock as the safety system counts it.
    pub time: f64,
    /// Causes of the stop.
    pub causes: Causes,
    /// State that the stop led to.
    pub state: SafetyState,
    /// Measured speed at that moment (m/s).
    pub speed: f64,
}

/// A robot supervised by the safety system of a drive-by-wire car (book, sections 14.2 and 14.3).
///
/// It implements the traits of the inner robot, but a program's commands reach the wheels only in the state
/// [`SafetyState::Auto`]. Once per control period, during waits and calls, it checks the buttons, the
/// heartbeat of the base station, the fence, the pedals, the program and the sensors. If a check fails, it
/// brakes at the curvature driven last, stands, and stays until it is armed again. If the only causes of a
/// safe stop are a missing heartbeat or a program that has resumed, the program still steers while the
/// vehicle brakes; its speeds are ignored.
///
/// # What it detects, and how soon
///
/// The reaction follows within one control period of the moment at which a fault is detectable; if a call of
/// the inner robot takes longer, at the end of that call. With the [parameters](SupervisedParameters), a
/// fault is detectable
///
/// | fault | seconds after its start |
/// | what | seconds after it began |
/// |---|---|
/// | button, pedal, steering wheel, stop of the base station | 0 |
/// | heartbeat missing | `heartbeat`, from the last one |
/// | vehicle outside the fence | `fence_debounce - 1` periods |
/// | program silent | `watchdog`, from its last sign of life |
/// | link lost; odometry lost, not a number, or jumping | 0 |
/// | clock stands still, runs backwards or leaps | one period |
/// | odometry frozen | `health.repeats` periods, and the time for 10 mm at the reported speed |
/// | odometry becomes late | as for a jump or a freeze, whichever its first late readings resemble |
/// | odometry not read for longer than `health.age`, because a call hung | at the end of that call |
/// | sensor used by the program lost, not a number, or slower than `health.age` | at that reading |
/// | such a sensor frozen, or becoming late | after `health.repeats` such readings while the vehicle moves |
///
/// While the last command keeps the vehicle moving indefinitely (a [speed](Drive::set_speed) or a
/// [motor](crate::io::Motors)), only further commands keep the program alive; sensor reads and waits do not.
/// While the last command was to stand, or a manoeuvre with an end such as
/// [`straight`](crate::io::Manoeuvres::straight), every call keeps it alive, and so does a wait in progress.
/// A call of the inner robot that hangs does not.
///
/// # What it cannot detect
///
/// Readings carry no time stamps. A sensor that becomes late is detected; one that was late from its first
/// reading on is trusted. So are odometry that freezes while the vehicle stands, and odometry whose error
/// grows slowly. Jumps of ranges and images are not detected, because they jump at every edge. Sensors that
/// the program does not read are not checked, except odometry.
///
/// Therefore a sensor fault stays a [cause](Causes::SENSOR) until somebody confirms the sensors
/// ([`Panel::sensors_checked`]); until then the vehicle cannot be armed. Confirming a sensor that is still
/// late hides its fault. A sensor that is still lost, frozen or not a number is detected again.
///
/// # Memory, panics, endless waits
///
/// [`new`](Self::new) allocates all memory, about 300 kB. Afterwards nothing here allocates or panics; the
/// inner robot and the station may. A wait of more than a day fails with [`ErrorKind::InvalidInput`].
///
/// ```
/// use roverlab::safety::{Heartbeat, Panel, Requests, SafetyState, Supervised, SupervisedParameters};
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Clock, Drive, MockRobot, Odometry};
///
/// # fn main() -> roverlab::io::Result<()> {
/// // Armed and started at once; the stop button is pressed after one second.
/// let station = |now: f64, heartbeat: Heartbeat| Panel {
///     heartbeat: Some(heartbeat.count),
///     requests: Requests { arm: now > 0.01, start: now > 0.05, disarm: false },
///     remote_stop: now > 1.0,
///     ..Panel::default()
/// };
/// let robot = MockRobot::new().with_ideal_drive();
/// let mut car = Supervised::new(robot, station, SupervisedParameters::default())?;
/// car.wait(0.1)?;
/// for _ in 0..20 {
///     car.set_speed(Twist::new(0.5, 0.0))?;
///     car.wait(0.1)?;
/// }
/// assert_eq!((car.state(), car.speed()?), (SafetyState::EmergencyStop, Twist::STOP));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Supervised<R, S> {
    pub(super) inner: R,
    station: S,
    pub(super) parameters: SupervisedParameters,
    pub(super) core: SafetyCore,
    /// Causes found in calls of the program since the last check.
    pub(super) seen: Causes,
    heartbeat: Deadline,
    heard: Option<u64>,
    sent: u64,
    /// Time passed (s): by the clock, but at least the time waited, because a clock may stop.
    pub(super) waited: f64,
    /// Clock reading at time zero (s).
    origin: Option<f64>,
    /// Time of the next check (s).
    pub(super) due: f64,
    watchdog: Deadline,
    outside: Debounce,
    /// Corners of the fence, kept so that a check does not allocate.
    fence: Vec<[f64; 2]>,
    pub(super) odometry: OdometryHealth,
    pub(super) scans: ReadingHealth,
    pub(super) images: ReadingHealth,
    /// One entry per possible distance sensor, so that a reading does not allocate.
    pub(super) distances: Box<[ReadingHealth]>,
    trust: Trust,
    clock: Option<f64>,
    pub(super) pose: Pose,
    /// Last measured speed (m/s); `curvature` is the one driven last (1/m).
    speed: f64,
    pub(super) curvature: f64,
    /// Speed that the program last commanded (m/s); infinite if it drives by other means.
    pub(super) wanted: f64,
    /// Whether the program commands motors and servos itself, so that the curvature must be measured.
    pub(super) direct: bool,
    going: Going,
    /// Speed commanded while braking (m/s).
    braking: Option<f64>,
    causes: Causes,
    stop: Option<StopRecord>,
}

/// Which of the program's last commands keep the vehicle moving indefinitely.
#[derive(Debug, Clone, Copy)]
struct Going {
    /// A speed command.
    rolls: bool,
    /// Powered motors.
    powered: [bool; 256],
}

impl Default for Going {
    fn default() -> Self {
        Self { rolls: false, powered: [false; 256] }
    }
}

impl Going {
    fn has_no_end(&self) -> bool {
        self.rolls || self.powered.contains(&true)
    }
}

/// Longest wait, and largest forward leap of the clock that is accepted (s).
pub(super) const LONGEST: f64 = 86_400.0;
/// Speed above which the curvature is computed from measured speeds (m/s).
const ROLLS: f64 = 0.05;

impl<R: Clock + Drive + Odometry, S: Station> Supervised<R, S> {
    /// Wraps a robot, in the state `Manual`, with `station` as the remote end.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(inner: R, station: S, parameters: SupervisedParameters) -> Result<Self> {
        parameters.validate()?;
        let mut watchdog = Deadline::checked(parameters.watchdog);
        watchdog.feed(0.0);
        Ok(Self {
            inner,
            station,
            core: SafetyCore::new(),
            seen: Causes::NONE,
            heartbeat: Deadline::checked(parameters.heartbeat),
            heard: None,
            sent: 0,
            waited: 0.0,
            origin: None,
            due: 0.0,
            watchdog,
            outside: Debounce::new(parameters.fence_debounce),
            fence: parameters.fence.iter().map(|corner| [corner.x, corner.y]).collect(),
            odometry: OdometryHealth::new(&parameters.health),
            scans: ReadingHealth::default(),
            images: ReadingHealth::default(),
            distances: vec![ReadingHealth::default(); 256].into_boxed_slice(),
            trust: Trust::default(),
            clock: None,
            pose: Pose::default(),
            speed: 0.0,
            curvature: 0.0,
            wanted: f64::INFINITY,
            direct: false,
            going: Going::default(),
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

    /// Causes active in the last control period.
    pub fn causes(&self) -> Causes {
        self.causes
    }

    /// The last stop.
    pub fn last_stop(&self) -> Option<StopRecord> {
        self.stop
    }

    /// The remote end.
    pub fn station_mut(&mut self) -> &mut S {
        &mut self.station
    }

    /// The inner robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The inner robot, without supervision.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// Command of the driver. It reaches the wheels only in the state [`SafetyState::Manual`]. Returns
    /// whether it did.
    ///
    /// # Errors
    ///
    /// If the inner robot reports one.
    pub fn drive_by_hand(&mut self, twist: Twist) -> Result<bool> {
        let manual = self.core.state() == SafetyState::Manual;
        if manual {
            self.inner.set_speed(twist)?;
        }
        Ok(manual)
    }

    /// Records a call of the program, after a check of the time since its last call. While the vehicle moves
    /// indefinitely, a call does not keep the program alive.
    pub(super) fn alive(&mut self) {
        self.pass(0.0);
        self.look_if_due();
        self.shows_life();
    }

    /// Feeds the watchdog, unless the program has to send commands to stay alive.
    pub(super) fn shows_life(&mut self) {
        if !self.going.has_no_end() {
            self.watchdog.feed(self.waited);
        }
    }

    /// Advances the time by at least `seconds`, and by more if the clock says so.
    pub(super) fn pass(&mut self, seconds: f64) {
        self.waited += seconds;
        let Some(now) = self.inner.peek_time().ok().filter(|now| now.is_finite()) else { return };
        // Rounded to nanoseconds, as in recordings.
        let now = (now * 1e9).round() / 1e9;
        let shown = now - *self.origin.get_or_insert(now - self.waited);
        if shown - self.waited <= LONGEST {
            self.waited = self.waited.max(shown);
        }
    }

    /// Runs the checks once per control period.
    pub(super) fn look_if_due(&mut self) {
        if self.waited < self.due - 1e-6 {
            return;
        }
        let next = self.waited + self.parameters.period;
        self.look();
        // On some robots the checks take time, but they must not take all of it.
        self.pass(0.0);
        self.due = next.max(self.waited + 0.1 * self.parameters.period);
    }

    /// Runs all checks and acts on the result.
    fn look(&mut self) {
        let mut causes = std::mem::take(&mut self.seen);
        causes = causes.with(self.read_clock());
        let (odometry, standing) = self.read_odometry();
        causes = causes.with(odometry);
        causes = causes.with_if(self.watchdog.is_over(self.waited), Causes::WATCHDOG);
        self.sent += 1;
        let heartbeat = Heartbeat { count: self.sent, state: self.core.state(), causes: self.causes };
        let panel = self.station.exchange(self.waited, heartbeat);
        causes = causes.with(self.read_panel(&panel));
        causes = causes.with(self.distrusted(causes, panel.sensors_checked));
        let before = self.core.state();
        let state = self.core.step(SafetyInputs { causes, requests: panel.requests, standing });
        self.causes = causes;
        if state.severity() > before.severity() {
            self.stop = Some(StopRecord { time: self.waited, causes, state, speed: self.speed });
        }
        self.act(before, state, standing);
    }

    /// Checks that the clock advances while time passes.
    fn read_clock(&mut self) -> Causes {
        match self.inner.now() {
            Err(_) => Causes::LINK,
            Ok(now) => {
                let went_on = self.clock.replace(now).is_none_or(|before| {
                    let passed = now - before;
                    // Calls may take longer than a period, but the clock must not stand still or leap.
                    passed > 0.2 * self.parameters.period && passed < self.parameters.period + 0.5
                });
                Causes::NONE.with_if(!went_on, Causes::CLOCK)
            }
        }
    }

    /// Causes found by odometry, and whether the vehicle stands.
    fn read_odometry(&mut self) -> (Causes, bool) {
        match (self.inner.pose(), self.inner.speed()) {
            (Ok(pose), Ok(speed)) => {
                let limits = self.parameters.health;
                if !self.odometry.read(self.waited, pose, speed, &limits) {
                    return (Causes::SENSOR, false);
                }
                self.pose = pose;
                self.speed = speed.linear;
                if self.direct && self.core.state().lets_drive() && speed.linear.abs() > ROLLS {
                    self.curvature = speed.angular / speed.linear;
                }
                let outside = !self.fence.is_empty() && !is_inside(&self.fence, [pose.x, pose.y]);
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
        // NaN counts as an action of the driver.
        let quiet = |value: f64| value.abs() <= threshold;
        let driver = panel.disengage
            || !(quiet(panel.accelerator) && quiet(panel.brake) && quiet(panel.steering_force));
        Causes::NONE
            .with_if(panel.emergency_button, Causes::EMERGENCY_BUTTON)
            .with_if(panel.remote_stop, Causes::REMOTE_STOP)
            .with_if(self.heartbeat.is_over(self.waited), Causes::HEARTBEAT_LOST)
            .with_if(driver, Causes::DRIVER)
    }

    /// Sensor cause that stays after a fault until somebody confirms the sensors: lateness, for example,
    /// shows only while it builds up.
    fn distrusted(&mut self, causes: Causes, vouches: bool) -> Causes {
        if self.trust.begins(vouches) {
            self.odometry.trust();
            self.scans.trust();
            self.images.trust();
            self.distances.iter_mut().for_each(ReadingHealth::trust);
        }
        let lost = self.trust.is_lost(causes.has(Causes::SENSOR));
        Causes::NONE.with_if(lost, Causes::SENSOR)
    }

    /// Brakes in the states that require it. Errors are ignored here: the next period checks the link again.
    fn act(&mut self, before: SafetyState, state: SafetyState, standing: bool) {
        if !state.is_stop() {
            self.braking = None;
            if before == SafetyState::Auto && state == SafetyState::Manual {
                // The driver has control: cancel the program's last command.
                let _ = self.inner.set_speed(Twist::STOP);
            }
            return;
        }
        let slower = match (state, self.braking) {
            (SafetyState::EmergencyStop, _) => 0.0,
            // Odometry may report too high a speed: never brake less than the program did.
            (_, None) => self.speed.abs().min(self.wanted).copysign(self.speed),
            (_, Some(speed)) => speed,
        };
        let step = self.parameters.gentle * self.parameters.period;
        let speed = slower - slower.clamp(-step, step);
        self.braking = Some(speed);
        // Keep the curvature by a tiny speed: the brakes act before the steering does.
        let least = if standing { 0.0 } else { 1e-6_f64.copysign(self.speed) };
        let speed = if speed == 0.0 { least } else { speed };
        let _ = self.inner.set_speed(Twist::new(speed, speed * self.curvature));
    }

    /// Speed that the program last commanded (m/s). A robot whose link is lost may accelerate to it before it
    /// stops by itself. `None` if the program drives by other means.
    pub fn asked(&self) -> Option<f64> {
        Some(self.wanted).filter(|speed| speed.is_finite())
    }

    /// Stores a command that reached the wheels; braking keeps its curvature.
    pub(super) fn told(&mut self, wanted: f64, curvature: f64) {
        (self.wanted, self.direct) = (wanted.abs(), false);
        self.curvature = if curvature.is_finite() { curvature } else { 0.0 };
    }

    /// Records that a motor or servo command reached the wheels.
    pub(super) fn turned(&mut self) {
        (self.wanted, self.direct) = (f64::INFINITY, true);
    }

    /// Records a command and returns whether it may reach the wheels. The command keeps the program alive
    /// either way. `rolls`: it keeps the vehicle moving indefinitely.
    pub(super) fn may_drive(&mut self, rolls: bool) -> bool {
        self.going = Going { rolls, ..Going::default() };
        self.commanded()
    }

    /// The same for a motor command.
    pub(super) fn may_turn(&mut self, motor: u8, powered: bool) -> bool {
        self.going.rolls = false;
        self.going.powered[usize::from(motor)] = powered;
        self.commanded()
    }

    /// The same for a command that drives nothing, such as that of a servo.
    pub(super) fn commanded(&mut self) -> bool {
        self.alive();
        self.watchdog.feed(self.waited);
        self.core.state().lets_drive()
    }

    /// Lets a running program steer while the vehicle brakes because of a missing heartbeat or a program that
    /// was silent. The commanded speed is ignored.
    pub(super) fn steer_on(&mut self, twist: Twist) {
        let blind = Causes::HEARTBEAT_LOST.with(Causes::WATCHDOG);
        let why = self.stop.map_or(Causes::NONE, |stop| stop.causes).with(self.causes);
        let alone = self.core.state() == SafetyState::SafeStop && why.without(blind).is_empty();
        let wanted = twist.angular / twist.linear;
        if alone && twist.linear * self.speed > 0.0 && twist.linear.abs() > 1e-3 && wanted.is_finite() {
            self.curvature = wanted;
        }
    }

    /// Reads a sensor for the program, and records a fault if the call takes too long.
    pub(super) fn reading<T>(&mut self, read: impl FnOnce(&mut R) -> Result<T>) -> Result<T> {
        self.alive();
        let before = self.waited;
        let answer = read(&mut self.inner);
        self.pass(0.0);
        let late = self.waited - before > self.parameters.health.age;
        self.seen = self.seen.with_if(late, Causes::SENSOR);
        self.note(answer)
    }

    pub(super) fn note<T>(&mut self, answer: Result<T>) -> Result<T> {
        if let Err(error) = &answer {
            self.seen = self.seen.with(fault(error));
        }
        answer
    }
}

/// Causes that an error of a sensor indicates. A missing sensor or an invalid argument is not a fault.
pub(super) fn fault(error: &Error) -> Causes {
    match error.kind() {
        ErrorKind::Unsupported | ErrorKind::InvalidInput => Causes::NONE,
        ErrorKind::Disconnected => Causes::SENSOR.with(Causes::LINK),
        _ => Causes::SENSOR,
    }
}
