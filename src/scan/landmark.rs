use nalgebra::{Matrix2, Matrix2x6, Matrix3, Matrix6, Vector2, Vector6};

use crate::geometry::{Point, Pose, Vector, angle_difference, cross, math, normalize_angle};
use crate::io::{LidarScan, Result};
use crate::kinematics::{
    Differential, Displacement, LEAST_RANGE_ERROR, OUTLIER, OdometryErrors, OdometryStep, arc_between,
};
use crate::parameter::require_positive;

/// A cylindrical landmark, such as a can, at a known position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Position of its axis (m).
    pub position: Point,
    /// Radius (m).
    pub radius: f64,
}

/// Localisation by odometry and lidar observations of known landmarks: an extended Kalman filter. Its state
/// includes the systematic errors of odometry, so it calibrates odometry on the way (the feedback suggested
/// in section 3.7 of the book).
///
/// It starts at a known pose; therefore one landmark suffices. More are better.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::Lidar;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::kinematics::{Differential, OdometryErrors};
/// use roverlab::scan::{Landmark, LandmarkFilter};
/// use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};
/// let (mut world, place) = (World::empty(3.0, 3.0), Point::new(1.5, 1.2));
/// let (radius, height) = (0.04, 0.15);
/// let pole = ObjectKind::new("pole", Shape::Cylinder { radius, height }, Colour::GREEN);
/// world.objects.push(Object::new(pole.into(), Pose::new(place.x, place.y, 0.0)));
/// let truth = Pose::new(0.8, 1.0, 0.0);
/// let scene = Scene::with_robot(world, RobotSpec::s4(), truth);
/// let scan = Simulation::new(&scene, SimOptions::ideal())?.robot(0)?.scan()?;
/// // The robot starts at x = 0.3 m; odometry is 4 cm too large.
/// let errors = OdometryErrors { wheel_scale: 0.1, ..Default::default() };
/// let start = Pose::new(0.3, 1.0, 0.0);
/// let (pole, drive) = (Landmark { position: place, radius }, Differential { track: 0.1 });
/// let mut filter = LandmarkFilter::new(start, start, vec![pole], drive, errors, 0.005)?;
/// filter.predict(Pose::new(0.84, 1.0, 0.0));
/// assert_eq!(filter.correct(&scan), 1, "one landmark is visible");
/// assert!(filter.pose().distance_to(truth.position()) < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkFilter {
    landmarks: Vec<Landmark>,
    drive: Differential,
    errors: OdometryErrors,
    range_error: f64,
    /// Last pose by odometry.
    odometry: Pose,
    pose: Pose,
    /// Estimated errors of scale, mismatch and track.
    systematic: nalgebra::Vector3<f64>,
    covariance: Matrix6<f64>,
}

/// Maximum distance of a hit from a landmark's expected surface (m).
const GATE: f64 = 0.12;

impl LandmarkFilter {
    /// A filter for a robot at a known pose, whose odometry reads `odometry`. `range_error` is the standard
    /// deviation of a lidar range (m).
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(
        pose: Pose,
        odometry: Pose,
        landmarks: Vec<Landmark>,
        drive: Differential,
        errors: OdometryErrors,
        range_error: f64,
    ) -> Result<Self> {
        require_positive("track", drive.track)?;
        for landmark in &landmarks {
            require_positive("radius of a landmark", landmark.radius)?;
        }
        let squares = [errors.wheel_scale, errors.wheel_mismatch, errors.track].map(|sigma| sigma * sigma);
        let variances = Vector6::new(0.0, 0.0, 0.0, squares[0], squares[1], squares[2]);
        Ok(Self {
            landmarks,
            drive,
            errors,
            range_error: range_error.max(LEAST_RANGE_ERROR),
            odometry,
            pose,
            systematic: nalgebra::Vector3::zeros(),
            covariance: Matrix6::from_diagonal(&variances),
        })
    }

    /// Estimated pose.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Covariance of x, y and heading (m, rad).
    pub fn covariance(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Prediction step, to a new pose by odometry.
    pub fn predict(&mut self, odometry: Pose) {
        let measured = arc_between(self.odometry, odometry);
        self.odometry = odometry;
        if measured == Displacement::default() {
            return;
        }
        let [scale, mismatch, track] = self.systematic.into();
        let width = self.drive.track;
        let motion = Displacement {
            length: measured.length * (1.0 + scale) + 0.25 * width * measured.angle * mismatch,
            angle: measured.angle * (1.0 + scale - track) + measured.length * mismatch / width,
        };
        let step = OdometryStep::new(self.pose, motion, self.drive, &self.errors);
        let mut transition = Matrix6::identity();
        transition.fixed_view_mut::<3, 3>(0, 0).copy_from(&step.by_pose);
        transition.fixed_view_mut::<3, 3>(0, 3).copy_from(&step.by_errors);
        self.covariance = transition * self.covariance * transition.transpose();
        let mut pose = self.covariance.fixed_view_mut::<3, 3>(0, 0);
        pose += step.slip;
        self.pose = step.end;
    }

    /// Correction step, with the landmarks in a scan. Returns the number of landmarks detected.
    pub fn correct(&mut self, scan: &LidarScan) -> usize {
        let landmarks = std::mem::take(&mut self.landmarks);
        let seen = landmarks.iter().filter(|landmark| self.correct_by(landmark, scan)).count();
        self.landmarks = landmarks;
        seen
    }

    fn correct_by(&mut self, landmark: &Landmark, scan: &LidarScan) -> bool {
        let lidar = self.pose.compose(&scan.mount);
        let Some(sighting) = sighting(landmark, &lidar, scan, self.range_error) else { return false };
        let away = landmark.position - lidar.position();
        let distance = away.norm();
        let expected = normalize_angle(math::atan2(away.y, away.x) - lidar.heading);
        let innovation =
            Vector2::new(sighting.distance - distance, angle_difference(sighting.bearing, expected));
        let measurement = sensitivity(away, lidar.position() - self.pose.position());
        let noise = Matrix2::from_diagonal(&sighting.variances);
        let spread = measurement * self.covariance * measurement.transpose() + noise;
        let Some(inverse) = spread.try_inverse() else { return false };
        if (innovation.transpose() * inverse * innovation)[0] > OUTLIER * OUTLIER {
            return false;
        }
        let gain = self.covariance * measurement.transpose() * inverse;
        let change = gain * innovation;
        self.pose = Pose::new(
            self.pose.x + change[0],
            self.pose.y + change[1],
            normalize_angle(self.pose.heading + change[2]),
        );
        self.systematic += change.fixed_rows::<3>(3);
        // Joseph's form keeps the covariance symmetric and positive definite.
        let rest = Matrix6::identity() - gain * measurement;
        self.covariance = rest * self.covariance * rest.transpose() + gain * noise * gain.transpose();
        true
    }
}

/// Jacobian of a landmark's distance and bearing with respect to the state. `away` leads from lidar to
/// landmark, `arm` from robot to lidar, both in the world frame.
fn sensitivity(away: Vector, arm: Vector) -> Matrix2x6<f64> {
    let distance = away.norm();
    let along = away / distance;
    let across = Vector::new(-along.y, along.x) / distance;
    // Rotation of the robot swings the lidar around it.
    let swing = Vector::new(-arm.y, arm.x);
    let mut by_state = Matrix2x6::zeros();
    by_state.fixed_view_mut::<1, 3>(0, 0).copy_from_slice(&[-along.x, -along.y, -along.dot(&swing)]);
    by_state.fixed_view_mut::<1, 3>(1, 0).copy_from_slice(&[-across.x, -across.y, -across.dot(&swing) - 1.0]);
    by_state
}

/// Detection of a landmark in a scan.
struct Sighting {
    /// Distance from the lidar to the landmark's axis (m); `bearing` in rad.
    distance: f64,
    bearing: f64,
    variances: Vector2<f64>,
}

/// Detects a landmark in the beams that hit it at its expected position.
fn sighting(landmark: &Landmark, lidar: &Pose, scan: &LidarScan, range_error: f64) -> Option<Sighting> {
    let expected = lidar.to_local(landmark.position);
    let reach = landmark.radius + GATE;
    if expected.coords.norm() <= reach {
        return None;
    }
    let meets = |(index, &range): (usize, &f64)| {
        let angle = scan.angle_min + scan.angle_increment * index as f64;
        let (sin, cos) = math::sin_cos(angle);
        let hit = Vector::new(cos, sin) * range;
        let near = range.is_finite() && (hit - expected.coords).norm() <= reach;
        near.then_some((angle, range, hit))
    };
    let hits: Vec<(f64, f64, Vector)> = scan.ranges.iter().enumerate().filter_map(meets).collect();
    let count = hits.len() as f64;
    if hits.is_empty() {
        return None;
    }
    let middle = math::atan2(expected.y, expected.x);
    let bearing =
        middle + hits.iter().map(|(angle, ..)| angle_difference(*angle, middle)).sum::<f64>() / count;
    let axis = crate::geometry::direction(bearing);
    let to_axis = |hit: &Vector| {
        let aside = cross(axis, *hit);
        let depth = (landmark.radius * landmark.radius - aside * aside).max(0.0).sqrt();
        hit.dot(&axis) + depth
    };
    let distance = hits.iter().map(|(_, _, hit)| to_axis(hit)).sum::<f64>() / count;
    let range_variance = range_error * range_error / count + LEAST_RANGE_ERROR * LEAST_RANGE_ERROR;
    // A beam may meet it anywhere within its width: the variance of even numbers.
    let bearing_variance = scan.angle_increment * scan.angle_increment / 12.0;
    Some(Sighting { distance, bearing, variances: Vector2::new(range_variance, bearing_variance) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;

    const POLE: Landmark = Landmark { position: Point::new(1.0, 0.5), radius: 0.04 };
    const ERRORS: OdometryErrors =
        OdometryErrors { wheel_scale: 0.02, wheel_mismatch: 0.001, track: 0.005, slip: 0.001 };

    /// Scan of the pole without noise, for a robot pose and a lidar mount.
    fn scan(robot: Pose, mount: Pose) -> LidarScan {
        let lidar = robot.compose(&mount);
        let increment = std::f64::consts::TAU / 360.0;
        let range = |index: usize| {
            let ray = direction(lidar.heading + increment * index as f64);
            let away = POLE.position - lidar.position();
            let (ahead, aside) = (ray.dot(&away), cross(ray, away));
            if ahead > 0.0 && aside.abs() < POLE.radius {
                ahead - (POLE.radius * POLE.radius - aside * aside).sqrt()
            } else {
                f64::INFINITY
            }
        };
        LidarScan {
            angle_min: 0.0,
            angle_increment: increment,
            range_max: 10.0,
            mount,
            ranges: (0..360).map(range).collect(),
        }
    }

    fn filter(errors: OdometryErrors) -> LandmarkFilter {
        let drive = Differential { track: 0.09 };
        LandmarkFilter::new(Pose::default(), Pose::default(), vec![POLE], drive, errors, 0.002).unwrap()
    }

    #[test]
    fn a_pole_corrects_wheels_that_are_too_large() {
        for mount in [Pose::default(), Pose::new(0.1, 0.02, 0.5)] {
            let (mut with, mut without) = (filter(ERRORS), filter(ERRORS));
            let mut truth = Pose::default();
            for step in 1..=100 {
                let odometry = Pose::new(0.008 * f64::from(step), 0.0, 0.0);
                truth = Pose::new(1.03 * odometry.x, 0.0, 0.0);
                with.predict(odometry);
                without.predict(odometry);
                assert_eq!(with.correct(&scan(truth, mount)), 1);
            }
            let error = |filter: &LandmarkFilter| filter.pose().distance_to(truth.position());
            assert!(error(&with) < 0.004 && error(&without) > 0.02, "{} {}", error(&with), error(&without));
            assert!(with.covariance()[(0, 0)] < 0.05 * without.covariance()[(0, 0)]);
        }
    }

    #[test]
    fn what_is_elsewhere_is_no_landmark() {
        let mut filter = filter(ERRORS);
        let before = filter.clone();
        // From one metre farther back, the pole appears where there is none.
        assert_eq!(filter.correct(&scan(Pose::new(-1.0, 0.0, 0.0), Pose::default())), 0);
        let nothing =
            LidarScan { ranges: vec![f64::INFINITY; 360], ..scan(Pose::default(), Pose::default()) };
        assert_eq!(filter.correct(&nothing), 0);
        assert_eq!(filter, before);
    }

    #[test]
    fn without_errors_odometry_is_believed() {
        let mut filter = filter(OdometryErrors::default());
        filter.predict(Pose::new(0.1, 0.0, 0.0));
        filter.correct(&scan(Pose::new(0.12, 0.0, 0.0), Pose::default()));
        assert_eq!(filter.pose(), Pose::new(0.1, 0.0, 0.0));
        assert!(
            LandmarkFilter::new(
                Pose::default(),
                Pose::default(),
                vec![Landmark { radius: -1.0, ..POLE }],
                Differential { track: 0.09 },
                ERRORS,
                0.0
            )
            .is_err()
        );
    }
}
