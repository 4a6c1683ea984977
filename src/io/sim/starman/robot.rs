use std::sync::Arc;

use ambassador::Delegate;

use super::physics::{Build, Figure, StarmanTruth};
use super::{BodyPlan, StarmanSpec};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::delegate::{
    Colour, DisplayImage, DisplayOption, Fill, Font, Key, LidarScan, LidarSettings, Pixel, Psd, RadioMessage,
    Resolution, Result, RgbImage, Viewport, ambassador_impl_Display,
};
use crate::io::sim::Lcd;
use crate::io::sim::lockstep::{Lockstep, Program};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, DistanceSensors, Drive, Encoders, Error, ErrorKind, Inertial, Keys,
    Lidar, Manoeuvres, Motors, Odometry, Radio, Servos, StallDetector,
};

/// A simulated Starman in virtual time.
///
/// Servos 1 to 5 move the limbs: the first one is up, the others follow clockwise. [`Odometry::pose`] is its
/// position along the floor. It has no wheels, distance sensors or camera. The display works, and key presses
/// can be scheduled.
#[derive(Debug, Delegate)]
#[delegate(crate::io::Display, target = "lcd")]
pub struct Starman {
    program: Program<Figure>,
    lcd: Lcd,
    /// Offset of the odometry from the position along the floor.
    origin: Pose,
    /// Scheduled key presses, earliest first.
    keys: Vec<(f64, Key)>,
}

/// Duration of a call on the robot's clock (s), so that time passes in a loop without a pause.
const CALL: f64 = 1e-4;
/// Seconds to wait for other programs in its world; there are none.
const PATIENCE: f64 = 0.0;

impl Starman {
    /// A Starman in its initial standing position. Fails for a specification out of range.
    pub fn new(spec: &StarmanSpec) -> Result<Self> {
        spec.validate()?;
        Self::built(&Build::star(spec), spec.time_step)
    }

    /// Another body that walks: its first limb is moved by servo 1. Fails for a plan out of range.
    pub fn of(plan: &BodyPlan) -> Result<Self> {
        plan.validate()?;
        Self::built(&Build::of(plan), plan.time_step)
    }

    fn built(build: &Build, time_step: f64) -> Result<Self> {
        let world = Arc::new(Lockstep::new(Figure::new(build), time_step, 1, PATIENCE));
        Ok(Self {
            program: Program::claim(&world, 0, CALL, None)?,
            lcd: Lcd::new(),
            origin: Pose::default(),
            keys: Vec::new(),
        })
    }

    /// Schedules key presses, in seconds on the robot's clock.
    pub fn press_keys(&mut self, presses: impl IntoIterator<Item = (f64, Key)>) {
        self.keys.extend(presses);
        self.keys.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Ground truth, which behaviours cannot access.
    pub fn truth(&self) -> StarmanTruth {
        self.program.shared().lock().world.truth()
    }

    /// Content of its display.
    pub fn display(&self) -> &Lcd {
        &self.lcd
    }

    /// Makes a request to the figure after the duration of a call.
    fn call<T>(&mut self, ask: impl FnOnce(&mut Figure) -> Result<T>) -> Result<T> {
        self.program.charge();
        self.program.look(|figure, _| ask(figure))
    }
}

impl Clock for Starman {
    fn now(&mut self) -> Result<f64> {
        self.call(|_| Ok(()))?;
        Ok(self.program.time())
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.program.pass(seconds)?;
        self.program.look(|_, _| Ok(()))
    }
}

impl Servos for Starman {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        self.call(|figure| {
            let limb = usize::from(servo).wrapping_sub(1);
            if limb >= figure.servos() {
                return Err(Error::unsupported(format!("servo {servo}")));
            }
            if !(-1.0..=1.0).contains(&position) {
                return Err(Error::invalid_input("servo position", position, "-1 to 1"));
            }
            figure.send(limb, position);
            Ok(())
        })
    }
}

impl Odometry for Starman {
    fn speed(&mut self) -> Result<Twist> {
        Ok(Twist::new(self.call(|figure| Ok(figure.speed()))?, 0.0))
    }

    fn pose(&mut self) -> Result<Pose> {
        let travelled = self.call(|figure| Ok(figure.travelled()))?;
        Ok(Pose { x: self.origin.x + travelled, ..self.origin })
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        let travelled = self.call(|figure| Ok(figure.travelled()))?;
        if !pose.is_finite() {
            let found = format!("{} m, {} m, {} rad", pose.x, pose.y, pose.heading);
            return Err(Error::invalid_input("pose", found, "finite numbers"));
        }
        self.origin = Pose { x: pose.x - travelled, ..pose };
        Ok(())
    }
}

impl Keys for Starman {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.call(|_| Ok(()))?;
        let now = self.program.time();
        let due = self.keys.first().is_some_and(|(time, _)| *time <= now);
        Ok(due.then(|| self.keys.remove(0).1))
    }

    fn wait_key(&mut self) -> Result<Key> {
        let Some(&(time, key)) = self.keys.first() else {
            let message = "the program waits for a key, and no key press is scheduled";
            return Err(Error::new(ErrorKind::Other, message));
        };
        self.wait(time - self.program.time())?;
        self.keys.remove(0);
        Ok(key)
    }

    fn read_touch(&mut self) -> Result<Option<(i32, i32)>> {
        self.call(|_| Ok(None))
    }
}

/// Capabilities of a full robot that it lacks.
macro_rules! lacks {
    ($what:literal $capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl $capability for Starman {
            $( fn $name(&mut self $(, _: $type)*) -> Result<$result> {
                Err(Error::unsupported($what))
            } )*
        }
    };
}

signatures! { Drive => lacks!("wheels") }
signatures! { Manoeuvres => lacks!("wheels") }
signatures! { StallDetector => lacks!("wheels") }
signatures! { DistanceSensors => lacks!("distance sensors") }
signatures! { Lidar => lacks!("lidar") }
signatures! { Camera => lacks!("camera") }
signatures! { Radio => lacks!("radio") }
signatures! { Motors => lacks!("motors") }
signatures! { Encoders => lacks!("encoders") }
signatures! { Inertial => lacks!("inertial unit") }
signatures! { DepthSensor => lacks!("depth sensor") }

#[cfg(test)]
mod tests {
    use super::super::{LIMBS, LimbPlan};
    use super::*;
    use crate::io::RobotIo;

    fn starman() -> Starman {
        Starman::new(&StarmanSpec::default()).unwrap()
    }

    /// Path of the robot in the book's shuffle: one of the supporting limbs swings forth and back.
    fn shuffle(position: f64) -> Vec<f64> {
        let mut starman = starman();
        starman.wait(2.0).unwrap();
        let mut places = Vec::new();
        for _ in 0..10 {
            places.push(starman.pose().unwrap().x);
            starman.set_servo(3, position).unwrap();
            starman.wait(1.0).unwrap();
            starman.set_servo(3, 0.0).unwrap();
            starman.wait(1.0).unwrap();
        }
        places
    }

    #[test]
    fn one_limb_shuffles_it_to_the_left() {
        let places = shuffle(0.9);
        assert!(places[9] < places[0] - 0.01, "{places:?}");
        assert!(places.windows(2).all(|pair| pair[1] < pair[0]), "always to the same side: {places:?}");
    }

    /// The book's program for its keys: one selects the limb, two others move it.
    fn move_limbs(robot: &mut impl RobotIo) -> Result<[f64; LIMBS]> {
        let (mut positions, mut limb) = ([0.0; LIMBS], 0);
        robot.set_menu(["Leg+", "+", "-", "END"])?;
        loop {
            match robot.wait_key()? {
                Key::Key1 => limb = (limb + 1) % LIMBS,
                Key::Key2 => positions[limb] = f64::min(positions[limb] + 0.2, 1.0),
                Key::Key3 => positions[limb] = f64::max(positions[limb] - 0.2, -1.0),
                Key::Key4 => return Ok(positions),
            }
            for (servo, position) in (1..).zip(positions) {
                robot.set_servo(servo, position)?;
            }
        }
    }

    #[test]
    fn limbs_are_moved_by_keys() {
        let mut starman = starman();
        let keys = [Key::Key2, Key::Key2, Key::Key1, Key::Key3, Key::Key4];
        starman.press_keys((1..).zip(keys).map(|(i, key)| (f64::from(i), key)));
        let positions = move_limbs(&mut starman).unwrap();
        assert_eq!(positions, [0.4, -0.2, 0.0, 0.0, 0.0]);
        let limbs = starman.truth().posture.limbs;
        assert!((limbs[0] - 0.4 * StarmanSpec::default().servo_range).abs() < 0.02, "{limbs:?}");
        assert!(limbs[1] < -0.05, "{limbs:?}");
    }

    #[test]
    fn equal_runs_are_equal_to_the_bit() {
        let run = || {
            let mut starman = starman();
            for i in 0..20_u8 {
                starman.set_servo(1 + i % 5, f64::from(i) / 10.0 - 1.0).unwrap();
                starman.wait(0.25).unwrap();
            }
            (starman.truth(), starman.now().unwrap())
        };
        assert_eq!(run(), run());
    }

    #[test]
    fn what_it_lacks_is_named() {
        let mut starman = starman();
        assert_eq!(starman.set_servo(6, 0.0).unwrap_err().to_string(), "the robot has no servo 6");
        assert_eq!(starman.set_servo(0, 0.0).unwrap_err().to_string(), "the robot has no servo 0");
        let error = starman.set_servo(1, f64::NAN).unwrap_err();
        assert_eq!(error.to_string(), "servo position is NaN; expected -1 to 1");
        assert_eq!(starman.straight(1.0, 1.0).unwrap_err().kind(), ErrorKind::Unsupported);
        assert_eq!(starman.scan_into(&mut LidarScan::default()).unwrap_err().kind(), ErrorKind::Unsupported);
        assert!(starman.wait_key().is_err(), "nobody will press one");
    }

    #[test]
    fn specifications_out_of_range_are_named() {
        let text = |spec: StarmanSpec| Starman::new(&spec).unwrap_err().to_string();
        let book = StarmanSpec::book();
        assert_eq!(
            text(StarmanSpec { limb_mass: -1.0, ..book }),
            "limb mass is -1; expected a positive, finite number"
        );
        assert_eq!(
            text(StarmanSpec { time_step: 0.1, ..book }),
            "time step is 0.1; expected 0.00001 to 0.02 s"
        );
        assert!(text(StarmanSpec { time_step: 1e-300, ..book }).starts_with("time step is"));
        assert!(text(StarmanSpec { servo_range: 1.0, ..book }).starts_with("servo range is 1; expected"));
        let orphan = LimbPlan { parent: Some(usize::MAX), ..LimbPlan::default() };
        let plan = BodyPlan { limbs: vec![orphan], ..BodyPlan::default() };
        assert!(plan.validate().unwrap_err().to_string().contains("parent of limb 1"));
    }
}
