use crate::geometry::{Pose, Twist, Vector3};
use crate::io::Result;
use crate::io::sim::course::Course;
use crate::io::sim::drive_mechanics::Mechanics;
use crate::io::sim::{NoiseModel, TICK, TICKS_PER_SECOND};
use crate::kinematics::marine::{Allocation, Craft, CraftMotion, MAX_THRUSTERS, Wrench};
use crate::kinematics::{Displacement, PlanarTwist};
use crate::random::Stream;

/// The thrusters of a craft and who commands them: the program, or RoBIOS's v-omega layer in closed loop on
/// the speed.
///
/// Odometry is dead reckoning: the way through the water that a log measures, along the heading that follows
/// from the turn rate. Neither knows of a current; a Doppler log that sees the ground does. Both know how the
/// craft is tilted, as logs with a tilt sensor do, and measure along the level.
#[derive(Debug, Clone)]
pub(in crate::io::sim) struct CraftDrive {
    craft: Craft,
    allocation: Allocation,
    mode: Mode,
    odometry: Course,
    /// The speed through the water.
    measured: Twist,
    doppler: Option<Doppler>,
    /// What the forces that hold a speed have come to, in N s/kg and rad/s, besides what the model says.
    learnt: Twist,
    /// Factors of the log and of the turn rate.
    scale: [f64; 2],
    command: f64,
    factors: [f64; 2],
    stream: Stream,
}

/// A log that measures the speed over ground by the echoes of the ground.
#[derive(Debug, Clone)]
struct Doppler {
    /// Metres.
    range: f64,
    scale: f64,
    /// Standard deviation of a tick's speed (m/s).
    sigma: f64,
    stream: Stream,
}

#[derive(Debug, Clone, Copy)]
enum Mode {
    /// Shares of each thruster's full speed.
    Thrusters([f64; MAX_THRUSTERS]),
    /// A speed ahead and a turn rate.
    Speed(Twist),
    Manoeuvre(Manoeuvre),
}

/// A way along one arc.
#[derive(Debug, Clone, Copy)]
struct Manoeuvre {
    rest: Displacement,
    whole: Displacement,
    speed: f64,
}

/// Time in which a difference in speed is reduced (s).
const CLOSING: f64 = 0.5;
/// Time in which the distance to the end of a manoeuvre is reduced (s).
const APPROACH: f64 = 1.5;
/// Time in which a lasting difference is estimated (s).
const LEARNING: f64 = 2.0;
/// Distance (m) and angle (rad) from the end of a manoeuvre at which it is complete.
const NEAR: Displacement = Displacement { length: 0.01, angle: 0.01 };

impl CraftDrive {
    pub(in crate::io::sim) fn new(
        craft: Craft,
        dvl: Option<f64>,
        noise: &NoiseModel,
        mut stream: Stream,
    ) -> Self {
        let doppler = dvl.map(|range| {
            let mut stream = stream.child("doppler", 0);
            let scale = 1.0 + noise.doppler * stream.normal();
            Doppler { range, scale, sigma: noise.doppler * TICKS_PER_SECOND.sqrt(), stream }
        });
        let scale = [noise.wheel_scale, noise.track].map(|sigma| (1.0 + sigma * stream.normal()).max(0.1));
        Self {
            allocation: Allocation::new(&craft),
            craft,
            mode: Mode::Thrusters([0.0; MAX_THRUSTERS]),
            odometry: Course::new(Pose::default()),
            measured: Twist::default(),
            doppler,
            learnt: Twist::default(),
            scale,
            command: noise.command,
            factors: [1.0; 2],
            stream,
        }
    }

    /// The body that it drives.
    pub(in crate::io::sim) fn craft(&self) -> &Craft {
        &self.craft
    }

    /// Commands to the thrusters for the next tick.
    pub(super) fn commands(&mut self) -> [f64; MAX_THRUSTERS] {
        let wish = match self.mode {
            Mode::Thrusters(commands) => return commands,
            Mode::Speed(twist) => twist,
            Mode::Manoeuvre(manoeuvre) => {
                if manoeuvre.is_over() {
                    self.mode = Mode::Speed(Twist::default());
                    Twist::default()
                } else {
                    manoeuvre.twist()
                }
            }
        };
        self.hold(wish)
    }

    /// The commands that bring the craft to a speed and hold it there: what damping takes, what closes the
    /// rest, and what the model does not know.
    fn hold(&mut self, wish: Twist) -> [f64; MAX_THRUSTERS] {
        let wish = Twist::new(wish.linear * self.factors[0], wish.angular * self.factors[1]);
        let wanted = CraftMotion { linear: Vector3::x() * wish.linear, angular: Vector3::z() * wish.angular };
        let (drag, inertia) = (self.craft.drag(&wanted), self.craft.inertia());
        let off = Twist::new(wish.linear - self.measured.linear, wish.angular - self.measured.angular);
        let ahead = drag.force.x + inertia[0] / CLOSING * (off.linear + self.learnt.linear);
        let turning = drag.moment.z + inertia[5] / CLOSING * (off.angular + self.learnt.angular);
        let wrench = Wrench { force: Vector3::x() * ahead, moment: Vector3::z() * turning };
        let shared = self.allocation.share(&wrench);
        // At the thrusters' limits there is nothing to learn.
        if shared.share == 1.0 {
            self.learnt.linear += off.linear * TICK / LEARNING;
            self.learnt.angular += off.angular * TICK / LEARNING;
        }
        shared.commands
    }

    /// Takes notice of how the craft has moved in a tick, along the level: through the water, and over ground
    /// so many metres below.
    pub(super) fn sense(&mut self, through: &CraftMotion, over: &CraftMotion, altitude: f64) {
        let ahead = through.linear.x * self.scale[0];
        let left = through.linear.y * self.scale[0];
        let turning = through.angular.z * self.scale[1];
        self.measured = Twist::new(ahead, turning);
        let [ahead, left] = match &mut self.doppler {
            Some(log) if altitude <= log.range => log.measure(over),
            _ => [ahead, left],
        };
        let motion = PlanarTwist::new(ahead, left, turning).during(TICK);
        self.odometry.advance(motion);
        if let Mode::Manoeuvre(manoeuvre) = &mut self.mode {
            manoeuvre.rest.length -= motion.forward;
            manoeuvre.rest.angle -= motion.angle;
        }
    }
}

impl Doppler {
    /// The speed ahead and to the left.
    fn measure(&mut self, over: &CraftMotion) -> [f64; 2] {
        [over.linear.x, over.linear.y].map(|speed| speed * self.scale + self.sigma * self.stream.normal())
    }
}

impl Manoeuvre {
    /// Whether it turns on the spot, where the way of a craft that coasts is no part of it.
    fn is_turn(&self) -> bool {
        self.whole.length == 0.0
    }

    fn is_over(&self) -> bool {
        let is_there = self.is_turn() || self.rest.length.abs() < NEAR.length;
        is_there && self.rest.angle.abs() < NEAR.angle
    }

    /// The speed at which it is to move: both parts arrive together, and slow down before their end.
    fn twist(&self) -> Twist {
        let turns = self.is_turn();
        let (whole, angle) = (self.whole.length.abs(), self.whole.angle.abs());
        let seconds = if turns { angle } else { whole } / self.speed;
        let part = |rest: f64, whole: f64| (rest / APPROACH).clamp(-whole / seconds, whole / seconds);
        let hold = |rest: f64, whole: f64| if whole == 0.0 { rest / APPROACH } else { part(rest, whole) };
        let length = if turns { 0.0 } else { part(self.rest.length, whole) };
        Twist::new(length, hold(self.rest.angle, angle).clamp(-1.0, 1.0))
    }
}

impl Mechanics for CraftDrive {
    fn begin_command(&mut self) {
        if self.command > 0.0 {
            for factor in &mut self.factors {
                *factor = 1.0 + self.command * self.stream.normal();
            }
        }
    }

    fn set_twist(&mut self, twist: Twist) {
        self.mode = Mode::Speed(twist);
    }

    fn least_seconds(&self, motion: Displacement, speed: f64) -> Result<f64> {
        let whole = if motion.length == 0.0 { motion.angle } else { motion.length };
        Ok((whole / speed).abs())
    }

    fn start(&mut self, motion: Displacement, speed: f64) {
        self.mode = if motion == Displacement::default() {
            Mode::Speed(Twist::default())
        } else {
            Mode::Manoeuvre(Manoeuvre { rest: motion, whole: motion, speed: speed.abs() })
        };
    }

    fn set_motor(&mut self, motor: usize, fraction: f64) {
        let mut commands = match self.mode {
            Mode::Thrusters(commands) => commands,
            Mode::Speed(_) | Mode::Manoeuvre(_) => [0.0; MAX_THRUSTERS],
        };
        commands[motor] = fraction;
        self.mode = Mode::Thrusters(commands);
    }

    fn motors(&self) -> usize {
        self.craft.thrusters().len()
    }

    fn encoders(&self) -> usize {
        0
    }

    fn is_done(&self) -> bool {
        !matches!(self.mode, Mode::Manoeuvre(_))
    }

    fn is_driving(&self) -> bool {
        match self.mode {
            Mode::Thrusters(commands) => commands != [0.0; MAX_THRUSTERS],
            Mode::Speed(twist) => twist != Twist::default(),
            Mode::Manoeuvre(_) => true,
        }
    }

    fn remaining(&self) -> f64 {
        match self.mode {
            Mode::Manoeuvre(way) if way.is_turn() => way.rest.angle.abs(),
            Mode::Manoeuvre(way) => way.rest.length.abs(),
            Mode::Thrusters(_) | Mode::Speed(_) => 0.0,
        }
    }

    fn twist(&self) -> Twist {
        self.measured
    }

    fn odometry(&self) -> Pose {
        self.odometry.pose()
    }

    fn set_odometry(&mut self, pose: Pose) {
        self.odometry = Course::new(pose);
    }

    fn count(&self, _motor: usize) -> i64 {
        0
    }
}
