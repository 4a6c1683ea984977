use super::health::{OdometryHealth, ReadingHealth, Trust};
use super::{
    Causes, Deadline, Debounce, Heartbeat, Panel, SafetyCore, SafetyInputs, SafetyState, Station,
    SupervisedParameters, is_inside,
};
use crate::geometry::{Pose, Twist};
use crate::io::{Clock, Drive, Error, ErrorKind, Odometry, Result};

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
/// whenever time passes, every control period, in waits and at calls, it looks at the buttons, the heartbeat of the base
/// station, the fence, the pedals, the program and the sensors. When something is wrong, it brakes, and keeps the curvature
/// that was being driven until the vehicle stands; then it stands until somebody arms it again. While it brakes gently for want
/// of a heartbeat, or of a program that has come back, the program's commands still steer, as long as all sensors are well; its
/// speeds count for nothing.
///
/// # What it notices, and how soon
///
/// What can be noticed is answered by the look after that, so within one control period; during a call of the robot inside that
/// takes longer, when the call has ended. With the [parameters](SupervisedParameters) it can be noticed
///
/// | what | seconds after it began |
/// |---|---|
/// | a button, a pedal, the steering wheel, a stop of the base station | 0 |
/// | the heartbeat is missing | `heartbeat`, from the last one |
/// | the vehicle is outside the fence | `fence_debounce - 1` periods |
/// | the program is silent | `watchdog`, from what showed that it lived |
/// | the link is gone; odometry is lost, reads no numbers, or jumps | 0 |
/// | the clock stands, goes back or leaps | one period |
/// | odometry stays as it is | `health.repeats` periods, and as long as 10 mm take at the speed that it tells |
/// | odometry gets late | as a jump or as one that stays, whichever its first late readings look like |
/// | odometry has not been read for longer than `health.age`, as a call hung | with the end of that call |
/// | a sensor that the program reads is lost, reads no numbers, or takes longer than `health.age` | with that reading |
/// | such a sensor stays as it is, or gets late | with `health.repeats` such readings of a vehicle that moves |
///
/// While the program's last command keeps the vehicle going without an end, a [speed](Drive::set_speed) or a
/// [motor](crate::io::Motors), it lives as long as it commands again in time: that it reads sensors, or waits, shows no more that it
/// drives. While the vehicle is told to stand, or to drive a way that has an end, as by [`straight`](crate::io::Manoeuvres::straight), any call
/// shows that it lives, and so does a wait while it goes on; a call of the robot inside that hangs does not.
///
/// # What it cannot notice
///
/// Readings have no time stamps, so that a sensor gets late is seen, but not that it is: one that has been late since before it
/// was first read is trusted, and so is odometry that gets stuck while the vehicle stands, and one whose error grows slowly.
/// Ranges and images that jump are not noticed, as they do so at every edge. Sensors that nobody reads are not looked at, but for
/// odometry.
///
/// Therefore a sensor that was found at fault stays a [cause](Causes::SENSOR) until somebody vouches for it
/// ([`Panel::sensors_checked`]), and so long the vehicle is not armed. Who vouches for a sensor that is still late is believed;
/// one that is lost, stuck or reads no numbers is found out again.
///
/// # Memory, panics, and time without end
///
/// All memory is allocated by [`new`](Self::new), some 300 kB. After that, nothing here allocates or panics: what the robot inside
/// and the station do is their own. A wait of more than a day fails with [`ErrorKind::InvalidInput`].
///
/// ```
/// use roverlab::safety::{Heartbeat, Panel, Requests, SafetyState, Supervised, SupervisedParameters};
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Clock, Drive, MockRobot, Odometry};
///
/// # fn main() -> roverlab::io::Result<()> {
/// // Armed and started at once; the stop button is pressed after a second.
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
    /// What calls of the program have shown since the last look.
    pub(super) seen: Causes,
    heartbeat: Deadline,
    heard: Option<u64>,
    sent: u64,
    /// Seconds that have passed: those of the clock, and at least those that were waited, as a clock may stop.
    pub(super) waited: f64,
    /// What the clock showed when nothing had passed.
    origin: Option<f64>,
    /// When it looks next, in that time.
    pub(super) due: f64,
    watchdog: Deadline,
    outside: Debounce,
    /// The corners of the fence, so that no look has to allocate.
    fence: Vec<[f64; 2]>,
    pub(super) odometry: OdometryHealth,
    pub(super) scans: ReadingHealth,
    pub(super) images: ReadingHealth,
    /// Of every distance sensor that there can be, so that no reading has to allocate.
    pub(super) distances: Box<[ReadingHealth]>,
    trust: Trust,
    clock: Option<f64>,
    pub(super) pose: Pose,
    /// The speed measured last, and the curvature driven last.
    speed: f64,
    pub(super) curvature: f64,
    /// The speed that the program asked for last; infinite if it drives by other means than speeds.
    pub(super) wanted: f64,
    /// Whether it turns motors and servos itself, so that the curvature has to be measured.
    pub(super) direct: bool,
    going: Going,
    /// The speed asked for while it brakes.
    braking: Option<f64>,
    causes: Causes,
    stop: Option<StopRecord>,
}

/// What of the program's last commands keeps the vehicle going without an end.
#[derive(Debug, Clone, Copy)]
struct Going {
    /// A speed does.
    rolls: bool,
    /// Which motors do.
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

/// The longest wait, in seconds, and the longest time that a clock is believed to have leapt by: what comes after it has to come.
pub(super) const LONGEST: f64 = 86_400.0;
/// Metres per second above which speeds tell a curvature.
const ROLLS: f64 = 0.05;

impl<R: Clock + Drive + Odometry, S: Station> Supervised<R, S> {
    /// A robot in the hands of a person, with somebody at the other end.
    ///
    /// Fails with the name of the parameter that is out of range.
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

    /// The program calls. What happened in the time since its last call is seen before that counts. That it calls shows no more
    /// that it drives while the vehicle goes on without an end.
    pub(super) fn alive(&mut self) {
        self.pass(0.0);
        self.look_if_due();
        self.shows_life();
    }

    /// A call, or a wait that goes on as the program asked for it, shows that it lives, unless it has to command.
    pub(super) fn shows_life(&mut self) {
        if !self.going.has_no_end() {
            self.watchdog.feed(self.waited);
        }
    }

    /// Time has passed: so many seconds at least, and more if the clock says so.
    pub(super) fn pass(&mut self, seconds: f64) {
        self.waited += seconds;
        let Some(now) = self.inner.peek_time().ok().filter(|now| now.is_finite()) else { return };
        // To the nanosecond, as in recordings.
        let now = (now * 1e9).round() / 1e9;
        let shown = now - *self.origin.get_or_insert(now - self.waited);
        if shown - self.waited <= LONGEST {
            self.waited = self.waited.max(shown);
        }
    }

    /// Looks once in every control period.
    pub(super) fn look_if_due(&mut self) {
        if self.waited < self.due - 1e-6 {
            return;
        }
        let next = self.waited + self.parameters.period;
        self.look();
        // Looking takes time on some robots, but must not take all of it.
        self.pass(0.0);
        self.due = next.max(self.waited + 0.1 * self.parameters.period);
    }

    /// One look at everything, and what follows from it.
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

    /// The clock has to go on while time passes.
    fn read_clock(&mut self) -> Causes {
        match self.inner.now() {
            Err(_) => Causes::LINK,
            Ok(now) => {
                let went_on = self.clock.replace(now).is_none_or(|before| {
                    let passed = now - before;
                    // It may go on in calls for longer, but not stand, and not leap.
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

    /// A sensor that was found at fault is not trusted before somebody vouches for it: that it is late, for one, shows only as it
    /// gets late.
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
            // Sensors may say more than is true: brakes that the program had on are not let go.
            (_, None) => self.speed.abs().min(self.wanted).copysign(self.speed),
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

    /// The speed, in m/s, that the program asked for last: a robot whose link is lost may speed up to it until it stops by itself.
    /// `None` if it drives by other means than speeds.
    pub fn asked(&self) -> Option<f64> {
        Some(self.wanted).filter(|speed| speed.is_finite())
    }

    /// Remembers a command that has reached the wheels: to brake, its curvature is kept.
    pub(super) fn told(&mut self, wanted: f64, curvature: f64) {
        (self.wanted, self.direct) = (wanted.abs(), false);
        self.curvature = if curvature.is_finite() { curvature } else { 0.0 };
    }

    /// The same for one of a motor or a servo.
    pub(super) fn turned(&mut self) {
        (self.wanted, self.direct) = (f64::INFINITY, true);
    }

    /// Whether the program may drive now. By a command it shows that it lives, whether that reaches the wheels or not; `rolls` says
    /// whether it keeps the vehicle going without an end.
    pub(super) fn may_drive(&mut self, rolls: bool) -> bool {
        self.going = Going { rolls, ..Going::default() };
        self.commanded()
    }

    /// The same for a motor, which is powered or not.
    pub(super) fn may_turn(&mut self, motor: u8, powered: bool) -> bool {
        self.going.rolls = false;
        self.going.powered[usize::from(motor)] = powered;
        self.commanded()
    }

    /// The same for what drives nothing, as a servo.
    pub(super) fn commanded(&mut self) -> bool {
        self.alive();
        self.watchdog.feed(self.waited);
        self.core.state().lets_drive()
    }

    /// While it brakes because nobody is heard, or nobody was, a program that lives and sees goes on steering: nobody else keeps the
    /// vehicle on its way. How fast it is the program has no say in.
    pub(super) fn steer_on(&mut self, twist: Twist) {
        let blind = Causes::HEARTBEAT_LOST.with(Causes::WATCHDOG);
        let why = self.stop.map_or(Causes::NONE, |stop| stop.causes).with(self.causes);
        let alone = self.core.state() == SafetyState::SafeStop && why.without(blind).is_empty();
        let wanted = twist.angular / twist.linear;
        if alone && twist.linear * self.speed > 0.0 && twist.linear.abs() > 1e-3 && wanted.is_finite() {
            self.curvature = wanted;
        }
    }

    /// A reading that the program asked for. How long that took tells how late it is.
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

/// What an error of a sensor is a sign of. That it was never there, or that the program asked for nonsense, is none.
pub(super) fn fault(error: &Error) -> Causes {
    match error.kind() {
        ErrorKind::Unsupported | ErrorKind::InvalidInput => Causes::NONE,
        ErrorKind::Disconnected => Causes::SENSOR.with(Causes::LINK),
        _ => Causes::SENSOR,
    }
}
