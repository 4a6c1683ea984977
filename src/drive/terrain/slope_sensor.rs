use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use crate::geometry::{Point3, Pose3, Vector, Vector3, direction, math, normalize_angle};
use crate::io::reading::{check_distances, check_scan};
use crate::io::{Attitude, DistanceSensors, Error, Lidar, LidarScan, LidarSettings, Psd, Result};
use crate::world::{Mount, PsdSpec, RobotSpec};

/// Measures the slope of the ground around a robot, with a lidar tilted down or with distance sensors that
/// point down.
///
/// ```
/// use roverlab::drive::terrain::SlopeSensor;
/// use roverlab::world::RobotSpec;
/// let plain = RobotSpec::blizzard();
/// assert!(SlopeSensor::lidar(&plain).is_some() && SlopeSensor::psds(&plain).is_none());
/// assert!(SlopeSensor::psds(&SlopeSensor::equip(plain)).is_some());
/// ```
///
/// Either measures points of the ground in the robot's frame. The robot rests on that ground, so these points
/// alone show its curvature but not its slope: the attitude from the inertial unit is needed too.
#[derive(Debug, Clone, PartialEq)]
pub struct SlopeSensor {
    /// Where the lidar sits, if that is what looks.
    lidar: Option<Pose3>,
    rays: Vec<Ray>,
    scan: LidarScan,
}

/// A distance sensor's ray in the robot's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ray {
    psd: Psd,
    origin: Point3,
    direction: Vector3,
}

/// The number of the first of the distance sensors that a robot is given.
const FIRST: u8 = 11;
/// How many there are around it.
const COUNT: u8 = 8;
/// A sensor that looks down more than this many radians shows the ground.
const LOOKS_DOWN: f64 = 0.3;
/// The tilt of the lidar's beams, in radians.
const TILT: f64 = -0.5;
/// Beams of a scan.
const BEAMS: usize = 72;
/// Ground points beyond this many metres say nothing of the place where the robot is.
const REACH: f64 = 1.0;

impl SlopeSensor {
    /// The lidar of a robot; `None` without one.
    pub fn lidar(spec: &RobotSpec) -> Option<Self> {
        let frame = spec.lidar?.mount.frame();
        Some(Self { lidar: Some(frame), rays: Vec::new(), scan: LidarScan::default() })
    }

    /// The distance sensors of a robot that point down; `None` with fewer than three.
    pub fn psds(spec: &RobotSpec) -> Option<Self> {
        let down = spec.psds.iter().filter(|psd| psd.mount.pitch > LOOKS_DOWN);
        let rays: Vec<Ray> = down
            .map(|psd| {
                let frame = psd.mount.frame();
                Ray { psd: Psd(psd.id), origin: frame.position, direction: frame.rotate(Vector3::x()) }
            })
            .collect();
        (rays.len() >= 3).then(|| Self { lidar: None, rays, scan: LidarScan::default() })
    }

    /// Adds eight distance sensors to a robot, at its top, pointing outwards and down by 45 degrees.
    #[must_use]
    pub fn equip(mut spec: RobotSpec) -> RobotSpec {
        let z = spec.height;
        spec.psds.extend((0..COUNT).map(|number| {
            let yaw = normalize_angle(FRAC_PI_4 * f64::from(number));
            let mount = Mount { z, pitch: FRAC_PI_4, yaw, ..Mount::default() };
            PsdSpec {
                id: FIRST + number,
                name: format!("PSD_DOWN_{number}"),
                mount,
                max_range: PsdSpec::DEFAULT_MAX_RANGE,
            }
        }));
        spec
    }

    /// Configures the lidar, if the robot looks with one.
    pub(super) fn prepare<R: Lidar + ?Sized>(&self, robot: &mut R) -> Result<()> {
        match self.lidar {
            Some(_) => robot.configure_lidar(LidarSettings { field_of_view: TAU, tilt: TILT, points: BEAMS }),
            None => Ok(()),
        }
    }

    /// Measures points of the ground, in the robot's frame.
    pub(super) fn look<R: DistanceSensors + Lidar + ?Sized>(
        &mut self,
        robot: &mut R,
        points: &mut Vec<Point3>,
    ) -> Result<()> {
        if self.lidar.is_some() {
            self.look_by_lidar(robot, points)
        } else {
            self.look_by_psds(robot, points)
        }
    }

    /// The same with the distance sensors. Fails if the lidar is what looks.
    pub(super) fn look_by_psds<R: DistanceSensors + ?Sized>(
        &self,
        robot: &mut R,
        points: &mut Vec<Point3>,
    ) -> Result<()> {
        if self.lidar.is_some() {
            return Err(Error::invalid_input("slope sensor", "a lidar", "distance sensors"));
        }
        points.clear();
        for ray in &self.rays {
            let range = robot.distance(ray.psd)?;
            check_distances("observed distance", &[range])?;
            points.extend((range < REACH).then(|| ray.origin + ray.direction * range));
        }
        Ok(())
    }

    /// The same with the lidar. Fails if distance sensors are what looks.
    pub(super) fn look_by_lidar<R: Lidar + ?Sized>(
        &mut self,
        robot: &mut R,
        points: &mut Vec<Point3>,
    ) -> Result<()> {
        let Some(lidar) = self.lidar else {
            return Err(Error::invalid_input("slope sensor", "distance sensors", "a lidar"));
        };
        points.clear();
        robot.scan_into(&mut self.scan)?;
        check_scan(&self.scan)?;
        let (rise, run) = math::sin_cos(TILT);
        let beams = self.scan.ranges.iter().enumerate().filter(|(_, range)| **range < REACH);
        points.extend(beams.map(|(index, range)| {
            let flat = direction(self.scan.angle(index));
            lidar.to_world(Point3::from(Vector3::new(flat.x * run, flat.y * run, rise) * *range))
        }));
        Ok(())
    }
}

/// Metres that the ground around rises in a metre ahead and to the left, by the plane through some points of
/// it in the robot's frame; `None` if they do not span one.
pub(super) fn slope(points: &[Point3], attitude: Attitude) -> Option<Vector> {
    let level = Attitude { yaw: 0.0, ..attitude }.frame();
    let points: Vec<Point3> = points.iter().map(|&point| level.to_world(point)).collect();
    let count = points.len() as f64;
    let middle = points.iter().map(|point| point.coords).sum::<Vector3>() / count;
    let [mut xx, mut xy, mut yy, mut xz, mut yz] = [0.0; 5];
    for point in &points {
        let away = point.coords - middle;
        xx += away.x * away.x;
        xy += away.x * away.y;
        yy += away.y * away.y;
        xz += away.x * away.z;
        yz += away.y * away.z;
    }
    let determinant = xx * yy - xy * xy;
    let rise = Vector::new(xz * yy - yz * xy, yz * xx - xz * xy) / determinant;
    // Points on a line span no plane.
    let spans = determinant > 1e-3 * (xx + yy) * (xx + yy);
    (points.len() >= 3 && spans && rise.norm().is_finite()).then_some(rise)
}

/// The angle of a slope.
pub(super) fn steepness(rise: Vector) -> f64 {
    math::atan(rise.norm()).min(FRAC_PI_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Points of a plane as a tilted robot sees them give back its slope in the robot's axes.
        #[test]
        fn the_slope_of_a_plane_is_found(
            (a, b) in (-0.5..0.5f64, -0.5..0.5f64), (roll, pitch) in (-0.5..0.5f64, -0.5..0.5f64),
            places in prop::collection::vec((-0.5..0.5f64, -0.5..0.5f64), 6..20),
        ) {
            let attitude = Attitude { roll, pitch, yaw: 1.0 };
            let level = Attitude { yaw: 0.0, ..attitude }.frame();
            let points: Vec<Point3> =
                places.iter().map(|&(x, y)| level.to_local(Point3::new(x, y, a * x + b * y - 0.1))).collect();
            if let Some(rise) = slope(&points, attitude) {
                prop_assert!((rise - Vector::new(a, b)).norm() < 1e-9, "{}", rise);
            }
        }
    }

    #[test]
    fn robots_get_sensors_that_look_down_all_round() {
        let plain = RobotSpec::blizzard();
        assert_eq!(SlopeSensor::psds(&plain), None);
        let spec = SlopeSensor::equip(plain);
        assert_eq!(spec.validate(), Ok(()));
        let sensor = SlopeSensor::psds(&spec).unwrap();
        assert_eq!(sensor.rays.len(), 8);
        let sum: Vector3 = sensor.rays.iter().map(|ray| ray.direction).sum();
        assert!(sum.xy().norm() < 1e-9 && sum.z < -5.0);
    }

    #[test]
    fn points_on_a_line_say_nothing() {
        let line: Vec<Point3> = (0..9).map(|i| Point3::new(0.1 * f64::from(i), 0.0, 0.0)).collect();
        assert_eq!(slope(&line, Attitude::default()), None);
        assert_eq!(slope(&[], Attitude::default()), None);
    }
}
