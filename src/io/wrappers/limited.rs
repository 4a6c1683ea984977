use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors,
    Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// Time between two speed commands of a gradual change of speed (s).
const RAMP_STEP: f64 = 0.01;

/// Limits on a program's commands. Infinity, the default, is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Forward and backward speed (m/s).
    pub linear: f64,
    /// Turn rate in either direction (rad/s).
    pub angular: f64,
    /// Linear acceleration (m/s²); for [`Drive::set_speed`] alone.
    pub linear_acceleration: f64,
    /// Angular acceleration (rad/s²); for [`Drive::set_speed`] alone.
    pub angular_acceleration: f64,
    /// Fraction of a single motor's full speed; for [`Motors::set_motor`] alone.
    pub motor: f64,
    /// Treatment of a command beyond the limits.
    pub excess: Excess,
}

/// Treatment of a command beyond the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Excess {
    /// Reduces it to the limits: speeds at once, with the same curvature; changes of speed are spread over
    /// time.
    #[default]
    Clamp,
    /// Rejects it with the kind [`InvalidInput`](crate::io::ErrorKind::InvalidInput); the robot continues as
    /// before. A change of speed is too large if it exceeds what the acceleration allows since the last
    /// command.
    Refuse,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            linear: f64::INFINITY,
            angular: f64::INFINITY,
            linear_acceleration: f64::INFINITY,
            angular_acceleration: f64::INFINITY,
            motor: f64::INFINITY,
            excess: Excess::Clamp,
        }
    }
}

impl Limits {
    /// Fails with the name of a limit that is negative or NaN, or of an acceleration that is zero.
    pub fn validate(&self) -> Result<()> {
        for (name, limit) in
            [("speed limit", self.linear), ("turning limit", self.angular), ("motor limit", self.motor)]
        {
            if limit.is_nan() || limit < 0.0 {
                return Err(Error::invalid_input(name, limit, "0 or more"));
            }
        }
        for (name, limit) in [
            ("acceleration limit", self.linear_acceleration),
            ("turning acceleration limit", self.angular_acceleration),
        ] {
            if limit.is_nan() || limit <= 0.0 {
                return Err(Error::invalid_input(name, limit, "more than 0"));
            }
        }
        Ok(())
    }

    fn limits_acceleration(&self) -> bool {
        self.linear_acceleration.is_finite() || self.angular_acceleration.is_finite()
    }
}

/// A robot with limits on its speeds and accelerations.
///
/// During a gradual change of speed, every call reads the robot's clock and updates the speed, and waits are
/// split into steps of 10 ms; at other times calls go straight through. A call that blocks in the wrapped
/// robot, such as waiting for a key, keeps the current speed.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::wrappers::{Limited, Limits};
/// use roverlab::io::{Call, Drive, MockRobot};
/// let limits = Limits { linear: 0.2, ..Limits::default() };
/// let mut robot = Limited::new(MockRobot::new(), limits)?;
/// robot.set_speed(Twist::new(1.0, 0.5))?;
/// let slower = Twist::new(0.2, 0.1);
/// assert_eq!(robot.inner().calls(), [Call::SetSpeed(slower)], "on the same circle");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Limited<R> {
    inner: R,
    limits: Limits,
    /// The commanded speed, if not reached yet.
    target: Option<Twist>,
    /// Time and value of the last speed given to the robot, if its last command was a speed.
    told: Option<(f64, Twist)>,
}

impl<R> Limited<R> {
    /// Limits a robot's speeds. Fails for an invalid limit.
    pub fn new(inner: R, limits: Limits) -> Result<Self> {
        limits.validate()?;
        Ok(Self { inner, limits, target: None, told: None })
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the limits.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// The value, reduced to the limit with its sign, or an error if it is beyond the limit.
    fn reduce(&self, name: &str, value: f64, limit: f64) -> Result<f64> {
        // NaN is for the robot to reject.
        if value.is_nan() || value.abs() <= limit {
            return Ok(value);
        }
        match self.limits.excess {
            Excess::Clamp => Ok(limit.copysign(value)),
            Excess::Refuse => Err(Error::invalid_input(name, value, &format!("at most {limit} either way"))),
        }
    }

    /// The speeds within the limits, with the same curvature.
    fn reduce_twist(&self, twist: Twist) -> Result<Twist> {
        let linear = self.reduce("speed", twist.linear, self.limits.linear)?;
        let angular = self.reduce("turning speed", twist.angular, self.limits.angular)?;
        if linear == twist.linear && angular == twist.angular {
            return Ok(twist);
        }
        let share = |reduced: f64, wanted: f64| if wanted == 0.0 { 1.0 } else { reduced / wanted };
        let scale = share(linear, twist.linear).min(share(angular, twist.angular));
        // The component that sets the scale keeps its exact limit.
        let scaled = |reduced: f64, wanted: f64| {
            if share(reduced, wanted) == scale { reduced } else { wanted * scale }
        };
        Ok(Twist::new(scaled(linear, twist.linear), scaled(angular, twist.angular)))
    }

    /// A manoeuvre's speed within the limits, given its curvature (rad/m).
    fn reduce_curve(&self, speed: f64, curvature: f64) -> Result<f64> {
        let limit = if curvature == 0.0 {
            self.limits.linear
        } else {
            self.limits.linear.min(self.limits.angular / curvature)
        };
        self.reduce("speed", speed, limit)
    }

    fn start_manoeuvre(&mut self) {
        self.target = None;
        self.told = None;
    }
}

impl<R: Clock + Drive + Odometry> Limited<R> {
    fn set_speed_gradually(&mut self, twist: Twist) -> Result<()> {
        let now = self.inner.now()?;
        let (before, from) = match self.told {
            Some(told) => told,
            None => (now, self.inner.speed()?),
        };
        let next = self.approach(from, twist, now - before);
        if next != twist && self.limits.excess == Excess::Refuse {
            let change = format!("from {} m/s, {} rad/s", from.linear, from.angular);
            let found = format!("{} m/s, {} rad/s, {change}", twist.linear, twist.angular);
            return Err(Error::invalid_input("speed", found, "a change that the acceleration limits allow"));
        }
        self.inner.set_speed(next)?;
        self.told = Some((now, next));
        self.target = (next != twist).then_some(twist);
        Ok(())
    }

    /// The speed nearest to `target` that can be reached within `seconds`.
    fn approach(&self, from: Twist, target: Twist, seconds: f64) -> Twist {
        let step = |from: f64, target: f64, acceleration: f64| {
            let room = if acceleration.is_finite() { acceleration * seconds.max(0.0) } else { acceleration };
            if (target - from).abs() <= room { target } else { from + room.copysign(target - from) }
        };
        Twist::new(
            step(from.linear, target.linear, self.limits.linear_acceleration),
            step(from.angular, target.angular, self.limits.angular_acceleration),
        )
    }

    /// Updates the speed towards the commanded one.
    fn keep_up(&mut self) -> Result<()> {
        match self.target {
            Some(target) => self.set_speed_gradually(target),
            None => Ok(()),
        }
    }
}

impl<R: Clock + Drive + Odometry> Clock for Limited<R> {
    fn now(&mut self) -> Result<f64> {
        self.keep_up()?;
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let mut left = seconds;
        while self.target.is_some() && left > RAMP_STEP {
            self.inner.wait(RAMP_STEP)?;
            left -= RAMP_STEP;
            self.keep_up()?;
        }
        self.inner.wait(left)?;
        self.keep_up()
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive + Odometry> Drive for Limited<R> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        let twist = self.reduce_twist(twist)?;
        if self.limits.limits_acceleration() && twist.is_finite() {
            return self.set_speed_gradually(twist);
        }
        self.inner.set_speed(twist)
    }
}

impl<R: Clock + Drive + Odometry + Manoeuvres> Manoeuvres for Limited<R> {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        let speed = self.reduce_curve(speed, 0.0)?;
        self.inner.straight(distance, speed)?;
        self.start_manoeuvre();
        Ok(())
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        let speed = self.reduce("turning speed", speed, self.limits.angular)?;
        self.inner.turn(angle, speed)?;
        self.start_manoeuvre();
        Ok(())
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        let speed = self.reduce_curve(speed, (angle / length).abs())?;
        self.inner.curve(length, angle, speed)?;
        self.start_manoeuvre();
        Ok(())
    }

    fn remaining(&mut self) -> Result<f64> {
        self.keep_up()?;
        self.inner.remaining()
    }

    fn is_done(&mut self) -> Result<bool> {
        self.keep_up()?;
        self.inner.is_done()
    }

    fn wait_done(&mut self) -> Result<()> {
        self.keep_up()?;
        self.inner.wait_done()
    }
}

impl<R: Clock + Drive + Odometry + Motors> Motors for Limited<R> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        let fraction = self.reduce("motor fraction", fraction, self.limits.motor)?;
        self.inner.set_motor(motor, fraction)?;
        self.start_manoeuvre();
        Ok(())
    }
}

hooked!(
    Limited,
    keep_up,
    [Clock Drive Odometry],
    Odometry,
    StallDetector,
    DistanceSensors,
    Lidar,
    Camera,
    Display,
    Keys,
    Radio,
    Servos,
    Encoders,
    Inertial,
    DepthSensor
);
