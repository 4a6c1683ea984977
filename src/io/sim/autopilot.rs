use super::TICKS_PER_SECOND;
use super::wheels::Wheels;
use crate::kinematics::Displacement;

/// The robot's on-board speed and manoeuvre controller: RoBIOS's v-omega layer.
#[derive(Debug, Clone)]
pub(super) struct Autopilot<const N: usize> {
    mode: Mode<N>,
}

#[derive(Debug, Clone)]
enum Mode<const N: usize> {
    /// Rim speeds until the next command.
    Speeds([f64; N]),
    /// Rolling each wheel to a measured position.
    Manoeuvre(Manoeuvre<N>),
}

#[derive(Debug, Clone)]
struct Manoeuvre<const N: usize> {
    /// Encoder targets.
    target: [f64; N],
    /// The fastest wheel's rim speed.
    speed: f64,
    /// Value in `remaining` of one metre of the farther wheel's roll: metres, or radians for a turn.
    unit: f64,
    /// Number of ticks for which all wheels have been near their targets.
    settling: u32,
}

/// Fraction of the motors' deceleration that a manoeuvre plans to brake with.
const BRAKING: f64 = 0.5;
/// Rate at which the last millimetres are closed (1/s).
const APPROACH_RATE: f64 = 20.0;
/// Distance from its target (in resolutions) within which a wheel is nearly there.
const NEARLY: f64 = 4.0;
/// Ticks after which wheels near their targets stop. If both targets are half an encoder tick away, each
/// wheel's correction moves the other off its target, and they could hunt for ever.
const LONGEST_SETTLING: u32 = TICKS_PER_SECOND as u32;
/// Rim speed below which a wheel at its target is at rest (m/s).
const STANDING: f64 = 1e-5;

impl<const N: usize> Autopilot<N> {
    pub(super) fn new() -> Self {
        Self { mode: Mode::Speeds([0.0; N]) }
    }

    /// Drives all wheels at rim speeds until the next command.
    pub(super) fn set_speeds(&mut self, speeds: [f64; N]) {
        self.mode = Mode::Speeds(speeds);
    }

    /// Drives one wheel at a rim speed and leaves the others unchanged.
    pub(super) fn set_motor(&mut self, wheel: usize, speed: f64) {
        let mut speeds = match self.mode {
            Mode::Speeds(speeds) => speeds,
            Mode::Manoeuvre(_) => [0.0; N],
        };
        speeds[wheel] = speed;
        self.mode = Mode::Speeds(speeds);
    }

    /// Shortest duration of a motion with these wheel rolls.
    pub(super) fn least_seconds(
        wheels: &Wheels<N>,
        rolls: [f64; N],
        motion: Displacement,
        speed: f64,
    ) -> f64 {
        (whole(motion) / speed).abs().max(farthest(rolls) / wheels.speed_limit())
    }

    /// Starts a motion along one arc with these wheel rolls. `speed` is along the arc in m/s, or in rad/s for
    /// a turn on the spot.
    pub(super) fn start(&mut self, wheels: &Wheels<N>, rolls: [f64; N], motion: Displacement, speed: f64) {
        let farther = farthest(rolls);
        if farther == 0.0 {
            self.mode = Mode::Speeds([0.0; N]);
            return;
        }
        let whole = whole(motion).abs();
        let measured = wheels.measured();
        self.mode = Mode::Manoeuvre(Manoeuvre {
            target: std::array::from_fn(|w| measured[w] + rolls[w]),
            speed: (speed.abs() * farther / whole).min(wheels.speed_limit()),
            unit: whole / farther,
            settling: 0,
        });
    }

    /// Rim speed commands for the next tick.
    pub(super) fn command(&mut self, wheels: &Wheels<N>) -> [f64; N] {
        match &mut self.mode {
            Mode::Speeds(speeds) => *speeds,
            Mode::Manoeuvre(manoeuvre) => manoeuvre.command(wheels).unwrap_or_else(|| {
                self.mode = Mode::Speeds([0.0; N]);
                [0.0; N]
            }),
        }
    }

    pub(super) fn is_done(&self) -> bool {
        matches!(self.mode, Mode::Speeds(_))
    }

    /// Whether the wheels are commanded to turn.
    pub(super) fn is_driving(&self) -> bool {
        match self.mode {
            Mode::Speeds(speeds) => speeds != [0.0; N],
            Mode::Manoeuvre(_) => true,
        }
    }

    /// Remainder of the manoeuvre; zero if the encoders cannot distinguish it from the end.
    pub(super) fn remaining(&self, wheels: &Wheels<N>) -> f64 {
        match &self.mode {
            Mode::Speeds(_) => 0.0,
            Mode::Manoeuvre(manoeuvre) => {
                let rest = manoeuvre.rest(wheels);
                let farther = farthest(rest);
                if farther <= wheels.resolution() { 0.0 } else { farther * manoeuvre.unit }
            }
        }
    }
}

impl<const N: usize> Manoeuvre<N> {
    fn rest(&self, wheels: &Wheels<N>) -> [f64; N] {
        let measured = wheels.measured();
        std::array::from_fn(|w| self.target[w] - measured[w])
    }

    /// Rim speeds for the next tick; `None` if all wheels are at rest at their targets.
    ///
    /// The wheel with the longest remaining roll sets the pace; the others are slowed so that all arrive
    /// together. This also brings a robot that was already moving back onto its arc.
    fn command(&mut self, wheels: &Wheels<N>) -> Option<[f64; N]> {
        let rest = self.rest(wheels);
        let farther = farthest(rest);
        let speeds = wheels.speeds();
        if farther <= NEARLY * wheels.resolution() {
            self.settling += 1;
        }
        if farther <= wheels.resolution() || self.settling > LONGEST_SETTLING {
            let standing = farthest(speeds) < STANDING;
            return if standing { None } else { Some(speeds.map(|v| follow(0.0, v, wheels.decay()))) };
        }
        let braking = BRAKING * wheels.max_acceleration();
        let pace = self.speed.min((2.0 * braking * farther).sqrt()).min(APPROACH_RATE * farther);
        Some(std::array::from_fn(|w| follow(pace * rest[w] / farther, speeds[w], wheels.decay())))
    }
}

/// The command with which a lagging wheel follows the desired speed. While speeding up it is the desired
/// speed. While slowing down it compensates the lag, because a robot that brakes late misses its target.
fn follow(wish: f64, speed: f64, decay: f64) -> f64 {
    let slows_down = wish.abs() < speed.abs() || wish * speed < 0.0;
    if slows_down { (wish - speed * decay) / (1.0 - decay) } else { wish }
}

/// Length of a motion, or angle of a turn on the spot.
fn whole(motion: Displacement) -> f64 {
    if motion.length == 0.0 { motion.angle } else { motion.length }
}

/// Largest absolute value of some rolls or speeds.
fn farthest<const N: usize>(rolls: [f64; N]) -> f64 {
    rolls.into_iter().map(f64::abs).fold(0.0, f64::max)
}
