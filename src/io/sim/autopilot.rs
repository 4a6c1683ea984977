use super::drivetrain::Drivetrain;
use crate::geometry::Twist;
use crate::kinematics::Displacement;

/// The robot's on-board speed and manoeuvre controller: RoBIOS's v-omega layer.
#[derive(Debug, Clone)]
pub(super) struct Autopilot {
    mode: Mode,
}

#[derive(Debug, Clone)]
enum Mode {
    /// Rim speeds until the next command.
    Speeds([f64; 2]),
    /// Rolling each wheel to a measured position.
    Manoeuvre(Manoeuvre),
}

#[derive(Debug, Clone)]
struct Manoeuvre {
    /// What the encoders of both wheels shall measure at the end.
    target: [f64; 2],
    /// The faster wheel's rim speed.
    speed: f64,
    /// What a metre of the farther wheel's roll is worth in `remaining`: metres, or radians for a turn.
    unit: f64,
}

/// The part of what the motors can do that a manoeuvre plans to brake with.
const BRAKING: f64 = 0.5;
/// How fast the last millimetres are closed, per second.
const APPROACH_RATE: f64 = 20.0;
/// The rim speed, in m/s, below which a wheel at its target stands.
const STANDING: f64 = 1e-5;

impl Autopilot {
    pub(super) fn new() -> Self {
        Self { mode: Mode::Speeds([0.0; 2]) }
    }

    pub(super) fn set_twist(&mut self, drive: &Drivetrain, twist: Twist) {
        let wheels = drive.wheels_for(twist);
        self.mode = Mode::Speeds([wheels.left, wheels.right]);
    }

    /// Drives one wheel with a fraction of its full speed and leaves the other as it is.
    pub(super) fn set_motor(&mut self, drive: &Drivetrain, wheel: usize, fraction: f64) {
        let mut speeds = match self.mode {
            Mode::Speeds(speeds) => speeds,
            Mode::Manoeuvre(_) => [0.0; 2],
        };
        speeds[wheel] = fraction * drive.speed_limit();
        self.mode = Mode::Speeds(speeds);
    }

    /// Starts a motion along one arc. `speed` is along the arc in m/s, or in rad/s for a turn on the spot.
    pub(super) fn start(&mut self, drive: &Drivetrain, motion: Displacement, speed: f64) {
        let rolls = drive.rolls_for(motion);
        let farther = rolls[0].abs().max(rolls[1].abs());
        if farther == 0.0 {
            self.mode = Mode::Speeds([0.0; 2]);
            return;
        }
        let whole = if motion.length == 0.0 { motion.angle.abs() } else { motion.length.abs() };
        let measured = drive.measured();
        self.mode = Mode::Manoeuvre(Manoeuvre {
            target: [measured[0] + rolls[0], measured[1] + rolls[1]],
            speed: (speed.abs() * farther / whole).min(drive.speed_limit()),
            unit: whole / farther,
        });
    }

    /// The rim speeds to command for the next tick.
    pub(super) fn command(&mut self, drive: &Drivetrain) -> [f64; 2] {
        match &self.mode {
            Mode::Speeds(speeds) => *speeds,
            Mode::Manoeuvre(manoeuvre) => manoeuvre.command(drive).unwrap_or_else(|| {
                self.mode = Mode::Speeds([0.0; 2]);
                [0.0; 2]
            }),
        }
    }

    pub(super) fn is_done(&self) -> bool {
        matches!(self.mode, Mode::Speeds(_))
    }

    /// Whether the wheels are asked to turn.
    pub(super) fn is_driving(&self) -> bool {
        match self.mode {
            Mode::Speeds(speeds) => speeds != [0.0; 2],
            Mode::Manoeuvre(_) => true,
        }
    }

    /// What is left of the manoeuvre; nothing, once the encoders cannot tell it from its end.
    pub(super) fn remaining(&self, drive: &Drivetrain) -> f64 {
        match &self.mode {
            Mode::Speeds(_) => 0.0,
            Mode::Manoeuvre(manoeuvre) => {
                let rest = manoeuvre.rest(drive);
                let farther = rest[0].abs().max(rest[1].abs());
                if farther <= drive.resolution() { 0.0 } else { farther * manoeuvre.unit }
            }
        }
    }
}

impl Manoeuvre {
    fn rest(&self, drive: &Drivetrain) -> [f64; 2] {
        let measured = drive.measured();
        [self.target[0] - measured[0], self.target[1] - measured[1]]
    }

    /// The rim speeds for the next tick; `None` when both wheels stand at their targets.
    ///
    /// The wheel with more to go sets the pace and the other is paced so that both arrive together, which also
    /// brings a robot that was already moving back onto its arc.
    fn command(&self, drive: &Drivetrain) -> Option<[f64; 2]> {
        let rest = self.rest(drive);
        let farther = rest[0].abs().max(rest[1].abs());
        let speeds = drive.speeds();
        if farther <= drive.resolution() {
            let standing = speeds[0].abs().max(speeds[1].abs()) < STANDING;
            return if standing { None } else { Some(speeds.map(|v| follow(0.0, v, drive.decay()))) };
        }
        let braking = BRAKING * drive.max_acceleration();
        let pace = self.speed.min((2.0 * braking * farther).sqrt()).min(APPROACH_RATE * farther);
        Some([0, 1].map(|w| follow(pace * rest[w] / farther, speeds[w], drive.decay())))
    }
}

/// The command that makes a lagging wheel do as wished: simply the wish while it speeds up, and when it must slow
/// down, the command that undoes the lag, for a robot that brakes late misses its target.
fn follow(wish: f64, speed: f64, decay: f64) -> f64 {
    let slows_down = wish.abs() < speed.abs() || wish * speed < 0.0;
    if slows_down { (wish - speed * decay) / (1.0 - decay) } else { wish }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, units};
    use crate::io::sim::drivetrain::DifferentialSpec;
    use crate::io::sim::{NoiseModel, TICK};
    use crate::kinematics::advance;
    use crate::random::Stream;
    use crate::world::MotorSpec;
    use proptest::prelude::*;

    fn s4(ideal_encoders: bool) -> Drivetrain {
        let spec = DifferentialSpec {
            wheel_diameter: 0.054,
            track: 0.09,
            max_wheel_speed: units::from_deg(3600.0),
            ticks_per_turn: 1100.0,
        };
        Drivetrain::new(&spec, MotorSpec::default(), &NoiseModel::ideal(), ideal_encoders, Stream::new(1))
    }

    /// Runs a manoeuvre to its end; the true pose, and the seconds that it took.
    fn run(drive: &mut Drivetrain, motion: Displacement, speed: f64) -> (Pose, f64) {
        let mut autopilot = Autopilot::new();
        autopilot.start(drive, motion, speed);
        let mut pose = Pose::default();
        let mut ticks = 0;
        while !autopilot.is_done() {
            let command = autopilot.command(drive);
            pose = advance(pose, drive.step(command));
            ticks += 1;
            assert!(ticks < 100_000, "never done: {motion:?} at {speed}");
        }
        for _ in 0..300 {
            let command = autopilot.command(drive);
            pose = advance(pose, drive.step(command));
        }
        (pose, f64::from(ticks) * TICK)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn manoeuvres_end_where_they_should(
            length in -1.0..1.0f64, angle in -6.0..6.0f64, speed in 0.05..0.5f64, ideal: bool,
        ) {
            let motion = Displacement { length, angle };
            let (pose, _) = run(&mut s4(ideal), motion, speed);
            let goal = advance(Pose::default(), motion);
            // An encoder tick is 0.15 mm and a tick of both wheels 0.2 degrees.
            let (position, heading) = if ideal { (1e-3, 0.1) } else { (4e-3, 0.3) };
            let turned = crate::geometry::angle_difference(pose.heading, goal.heading).abs();
            prop_assert!((pose.position() - goal.position()).norm() < position, "{pose:?} {goal:?}");
            prop_assert!(units::to_deg(turned) < heading, "{pose:?} {goal:?}");
        }
    }

    #[test]
    fn a_manoeuvre_takes_about_as_long_as_it_must() {
        let (_, seconds) = run(&mut s4(false), Displacement { length: 1.0, angle: 0.0 }, 0.2);
        assert!((5.0..5.8).contains(&seconds), "{seconds}");
    }

    #[test]
    fn wheels_lag_behind_their_command() {
        let mut drive = s4(true);
        for _ in 0..20 {
            drive.step([0.1, 0.1]);
        }
        // After one time constant of 0.2 s: 63 %.
        assert!((drive.speeds()[0] - 0.0632).abs() < 0.0005, "{:?}", drive.speeds());
    }
}
