use std::collections::BTreeMap;

use image::RgbImage;

use super::fault::{Fault, FaultKind, Sensor};
use super::memory::{Disturbance, Memory};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, ErrorKind, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres,
    Motors, Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// A robot with faults injected at set times.
///
/// Times are those of the wrapped robot's clock. Every call reads that clock once, which may take time on the
/// wrapped robot; with an empty schedule the clock is not read and nothing changes.
///
/// ```
/// use roverlab::io::wrappers::Faulty;
/// use roverlab::io::{Clock, DistanceSensors, MockRobot, Psd};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let robot = MockRobot::new().with_distance(Psd::LEFT, vec![0.5, 0.4, 0.3]);
/// let mut robot = Faulty::new(robot, vec!["stuck:left@1".parse()?]);
/// assert_eq!(robot.distance(Psd::LEFT)?, 0.5);
/// robot.wait(1.0)?;
/// assert_eq!(robot.distance(Psd::LEFT)?, 0.5);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Faulty<R> {
    inner: R,
    schedule: Vec<Scheduled>,
    /// How long readings are kept (s).
    horizon: f64,
    distances: BTreeMap<Psd, Memory<f64>>,
    scans: Memory<LidarScan>,
    images: Memory<RgbImage>,
    poses: Memory<Pose>,
    speeds: Memory<Twist>,
    attitudes: Memory<Attitude>,
    turn_rates: Memory<Vector3>,
    accelerations: Memory<Vector3>,
    depths: Memory<f64>,
}

#[derive(Debug, Clone)]
struct Scheduled {
    fault: Fault,
    progress: Progress,
}

/// Progress of a fault.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Progress {
    /// No effect yet.
    Waiting,
    /// The new frame of odometry.
    Jumped(Pose),
    /// The effect is over.
    Spent,
}

impl<R> Faulty<R> {
    /// Injects faults into a robot. If several affect one reading, the order is delay, stuck, jump, NaN.
    pub fn new(inner: R, faults: Vec<Fault>) -> Self {
        let delay = |fault: &Fault| match fault.kind {
            FaultKind::Late(_, delay) => delay,
            _ => 0.0,
        };
        let horizon = faults.iter().map(delay).fold(0.0, f64::max);
        let schedule =
            faults.into_iter().map(|fault| Scheduled { fault, progress: Progress::Waiting }).collect();
        Self {
            inner,
            schedule,
            horizon,
            distances: BTreeMap::new(),
            scans: Memory::new(horizon),
            images: Memory::new(horizon),
            poses: Memory::new(horizon),
            speeds: Memory::new(horizon),
            attitudes: Memory::new(horizon),
            turn_rates: Memory::new(horizon),
            accelerations: Memory::new(horizon),
            depths: Memory::new(horizon),
        }
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the faults.
    pub fn into_inner(self) -> R {
        self.inner
    }

    fn any(&self, time: f64, is_it: impl Fn(FaultKind) -> bool) -> bool {
        self.schedule.iter().any(|s| s.fault.is_active(time) && is_it(s.fault.kind))
    }

    fn is_nan(&self, time: f64, sensor: Sensor) -> bool {
        self.any(time, |kind| matches!(kind, FaultKind::Nan(s) if s.covers(sensor)))
    }

    fn require(&self, time: f64, sensor: Sensor, name: impl std::fmt::Display) -> Result<()> {
        if self.any(time, |kind| matches!(kind, FaultKind::Lost(s) if s.covers(sensor))) {
            return Err(Error::new(ErrorKind::Disconnected, format!("the {name} is gone")));
        }
        Ok(())
    }

    fn disturbance(&self, time: f64, sensor: Sensor) -> Disturbance {
        let stuck = self.any(time, |kind| matches!(kind, FaultKind::Stuck(s) if s.covers(sensor)));
        let delays =
            self.schedule.iter().filter(|s| s.fault.is_active(time)).filter_map(|s| match s.fault.kind {
                FaultKind::Late(late, delay) if late.covers(sensor) => Some(delay),
                _ => None,
            });
        Disturbance { stuck, delay: delays.reduce(f64::max) }
    }

    /// The reading of odometry with its jumps, for the undisturbed reading `pose`.
    fn jumped(&mut self, time: f64, mut pose: Pose) -> Pose {
        for Scheduled { fault, progress } in &mut self.schedule {
            let FaultKind::Jump(jump) = fault.kind else { continue };
            if !fault.is_active(time) {
                continue;
            }
            if *progress == Progress::Waiting {
                *progress = Progress::Jumped(pose.compose(&jump).compose(&pose.inverse()));
            }
            if let Progress::Jumped(frame) = progress {
                pose = frame.compose(&pose);
            }
        }
        pose
    }

    /// Ends past jumps, as odometry has been set.
    fn cure_jumps(&mut self, time: f64) {
        for Scheduled { fault, progress } in &mut self.schedule {
            if matches!(fault.kind, FaultKind::Jump(_)) && fault.at <= time {
                *progress = Progress::Spent;
            }
        }
    }

    /// The reading of a faulty clock at the true time `time`.
    fn shown(&self, time: f64) -> f64 {
        let active = self.schedule.iter().map(|s| s.fault).filter(|fault| fault.is_active(time));
        active.fold(time, |shown, fault| match fault.kind {
            FaultKind::ClockJump(seconds) => shown + seconds,
            FaultKind::ClockStop => shown - (time - fault.at),
            _ => shown,
        })
    }
}

impl<R: Clock> Faulty<R> {
    /// Starts a call: it hangs, fails, or gets the wrapped robot's time. `None` without a schedule.
    fn begin(&mut self) -> Result<Option<f64>> {
        if self.schedule.is_empty() {
            return Ok(None);
        }
        let mut time = self.inner.now()?;
        let hang = self.take_hang(time);
        if hang > 0.0 {
            self.inner.wait(hang)?;
            time = self.inner.now()?;
        }
        if self.any(time, |kind| kind == FaultKind::Link) {
            return Err(Error::new(ErrorKind::Disconnected, "the link to the robot is gone"));
        }
        Ok(Some(time))
    }

    fn ready(&mut self) -> Result<()> {
        self.begin().map(|_| ())
    }

    /// Extra duration of the next call (s).
    fn take_hang(&mut self, time: f64) -> f64 {
        let mut seconds = 0.0;
        for Scheduled { fault, progress } in &mut self.schedule {
            if let (FaultKind::Hang(more), Progress::Waiting) = (fault.kind, *progress)
                && fault.is_active(time)
            {
                *progress = Progress::Spent;
                seconds += more;
            }
        }
        seconds
    }
}

impl<R: Clock> Clock for Faulty<R> {
    fn now(&mut self) -> Result<f64> {
        match self.begin()? {
            Some(time) => Ok(self.shown(time)),
            None => self.inner.now(),
        }
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let ready = self.ready();
        self.inner.wait(seconds)?;
        ready
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: DistanceSensors + Clock> DistanceSensors for Faulty<R> {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        let Some(time) = self.begin()? else { return self.inner.distance(sensor) };
        let about = Sensor::Psd(sensor);
        self.require(time, about, sensor)?;
        let fresh = self.inner.distance(sensor)?;
        let disturbance = self.disturbance(time, about);
        let horizon = self.horizon;
        let memory = self.distances.entry(sensor).or_insert_with(|| Memory::new(horizon));
        let reading = memory.pass(time, fresh, disturbance);
        Ok(if self.is_nan(time, about) { f64::NAN } else { reading })
    }
}

impl<R: Lidar + Clock> Lidar for Faulty<R> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let Some(time) = self.begin()? else { return self.inner.scan_into(scan) };
        self.require(time, Sensor::Lidar, "lidar")?;
        self.inner.scan_into(scan)?;
        let disturbance = self.disturbance(time, Sensor::Lidar);
        *scan = self.scans.pass(time, std::mem::take(scan), disturbance);
        if self.is_nan(time, Sensor::Lidar) {
            scan.ranges.fill(f64::NAN);
        }
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        if let Some(time) = self.begin()? {
            self.require(time, Sensor::Lidar, "lidar")?;
        }
        self.inner.configure_lidar(settings)
    }
}

impl<R: Camera + Clock> Camera for Faulty<R> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        if let Some(time) = self.begin()? {
            self.require(time, Sensor::Camera, "camera")?;
        }
        self.inner.set_resolution(resolution)
    }

    fn resolution(&mut self) -> Result<Resolution> {
        if let Some(time) = self.begin()? {
            self.require(time, Sensor::Camera, "camera")?;
        }
        self.inner.resolution()
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let Some(time) = self.begin()? else { return self.inner.image_into(image) };
        self.require(time, Sensor::Camera, "camera")?;
        self.inner.image_into(image)?;
        let disturbance = self.disturbance(time, Sensor::Camera);
        *image = self.images.pass(time, std::mem::take(image), disturbance);
        if self.is_nan(time, Sensor::Camera) {
            image.fill(0);
        }
        Ok(())
    }
}

impl<R: Odometry + Clock> Odometry for Faulty<R> {
    fn speed(&mut self) -> Result<Twist> {
        let Some(time) = self.begin()? else { return self.inner.speed() };
        self.require(time, Sensor::Odometry, "odometry")?;
        let fresh = self.inner.speed()?;
        let reading = self.speeds.pass(time, fresh, self.disturbance(time, Sensor::Odometry));
        Ok(if self.is_nan(time, Sensor::Odometry) { Twist::new(f64::NAN, f64::NAN) } else { reading })
    }

    fn pose(&mut self) -> Result<Pose> {
        let Some(time) = self.begin()? else { return self.inner.pose() };
        self.require(time, Sensor::Odometry, "odometry")?;
        let fresh = self.inner.pose()?;
        let reading = self.poses.pass(time, fresh, self.disturbance(time, Sensor::Odometry));
        let reading = self.jumped(time, reading);
        let nan = Pose::new(f64::NAN, f64::NAN, f64::NAN);
        Ok(if self.is_nan(time, Sensor::Odometry) { nan } else { reading })
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        let time = self.begin()?;
        if let Some(time) = time {
            self.require(time, Sensor::Odometry, "odometry")?;
        }
        self.inner.set_pose(pose)?;
        if let Some(time) = time {
            self.cure_jumps(time);
        }
        Ok(())
    }
}

impl<R: Inertial + Clock> Inertial for Faulty<R> {
    fn attitude(&mut self) -> Result<Attitude> {
        let Some(time) = self.begin()? else { return self.inner.attitude() };
        self.require(time, Sensor::Inertial, "inertial unit")?;
        let fresh = self.inner.attitude()?;
        let reading = self.attitudes.pass(time, fresh, self.disturbance(time, Sensor::Inertial));
        let nan = Attitude { roll: f64::NAN, pitch: f64::NAN, yaw: f64::NAN };
        Ok(if self.is_nan(time, Sensor::Inertial) { nan } else { reading })
    }

    fn turn_rates(&mut self) -> Result<Vector3> {
        let Some(time) = self.begin()? else { return self.inner.turn_rates() };
        self.require(time, Sensor::Inertial, "inertial unit")?;
        let fresh = self.inner.turn_rates()?;
        let reading = self.turn_rates.pass(time, fresh, self.disturbance(time, Sensor::Inertial));
        Ok(if self.is_nan(time, Sensor::Inertial) { Vector3::repeat(f64::NAN) } else { reading })
    }

    fn acceleration(&mut self) -> Result<Vector3> {
        let Some(time) = self.begin()? else { return self.inner.acceleration() };
        self.require(time, Sensor::Inertial, "inertial unit")?;
        let fresh = self.inner.acceleration()?;
        let reading = self.accelerations.pass(time, fresh, self.disturbance(time, Sensor::Inertial));
        Ok(if self.is_nan(time, Sensor::Inertial) { Vector3::repeat(f64::NAN) } else { reading })
    }
}

impl<R: DepthSensor + Clock> DepthSensor for Faulty<R> {
    fn depth(&mut self) -> Result<f64> {
        let Some(time) = self.begin()? else { return self.inner.depth() };
        self.require(time, Sensor::Depth, "depth sensor")?;
        let fresh = self.inner.depth()?;
        let reading = self.depths.pass(time, fresh, self.disturbance(time, Sensor::Depth));
        Ok(if self.is_nan(time, Sensor::Depth) { f64::NAN } else { reading })
    }
}

hooked! {
    Faulty, ready, [Clock], Drive, Manoeuvres, StallDetector, Display, Keys, Radio, Motors, Servos, Encoders
}
