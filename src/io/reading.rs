//! What behaviours require of readings before they decide by them.

use image::{GrayImage, RgbImage};

use super::{Attitude, Error, LidarScan, Result};
use crate::geometry::{Point, Pose, Twist};

/// Fails with the name of a reading that is none.
fn require(name: &str, good: bool, found: impl std::fmt::Display, expected: &str) -> Result<()> {
    if good { Ok(()) } else { Err(Error::invalid_input(name, found, expected)) }
}

/// A point as messages print it.
pub(crate) fn point_in_words(point: Point) -> String {
    format!("({}, {}) m", point.x, point.y)
}

/// A pose as messages print it.
pub(crate) fn pose_in_words(pose: &Pose) -> String {
    format!("{} with a heading of {} rad", point_in_words(pose.position()), pose.heading)
}

/// Fails for a pose that is not finite.
pub(crate) fn check_pose(pose: &Pose) -> Result<()> {
    // Every step of a behaviour comes here; words are only made of a pose that is wrong.
    if pose.is_finite() {
        return Ok(());
    }
    Err(Error::invalid_input("observed pose", pose_in_words(pose), "finite numbers"))
}

/// Fails for a velocity that is not finite.
pub(crate) fn check_speed(speed: &Twist) -> Result<()> {
    let found = format_args!("{} m/s and {} rad/s", speed.linear, speed.angular);
    require("observed speed", speed.is_finite(), found, "finite numbers")
}

/// Fails for an attitude that is not finite.
pub(crate) fn check_attitude(attitude: &Attitude) -> Result<()> {
    let Attitude { roll, pitch, yaw } = *attitude;
    let good = [roll, pitch, yaw].iter().all(|angle| angle.is_finite());
    let found = format_args!("roll {roll}, pitch {pitch}, yaw {yaw} rad");
    require("observed attitude", good, found, "finite numbers")
}

/// Fails for the first of some distances that is NaN or negative. Infinity is that of nothing in range.
pub(crate) fn check_distances(name: &str, distances: &[f64]) -> Result<()> {
    let wrong = distances.iter().find(|&&distance| !is_distance(distance));
    let expected = "metres, or infinity without a return";
    wrong.map_or(Ok(()), |wrong| require(name, false, wrong, expected))
}

/// Fails for scans that cannot be trusted to show what is around.
///
/// A beam without a distance (NaN or negative) is tolerated between two beams that have one, which see what
/// stands there; two neighbours without one hide it.
pub(crate) fn check_scan(scan: &LidarScan) -> Result<()> {
    let layout = [scan.angle_min, scan.angle_increment];
    let laid_out = layout.iter().all(|angle| angle.is_finite()) && scan.mount.is_finite();
    require("layout of the lidar scan", laid_out, format_args!("{layout:?}"), "finite numbers")?;
    let blind = |beam: usize| !is_distance(scan.ranges[beam]);
    // The last beam of a full turn is the first one's neighbour.
    let next = |beam: usize| (beam + 1) % scan.ranges.len();
    let Some(beam) = (0..scan.ranges.len()).find(|&beam| blind(beam) && blind(next(beam))) else {
        return Ok(());
    };
    let (one, other) = (scan.ranges[beam], scan.ranges[next(beam)]);
    let found = format!("{one} and {other} at beams {beam} and {}", next(beam));
    Err(Error::invalid_input("lidar scan", found, "a distance at one of two neighbours at least"))
}

impl LidarScan {
    /// Fails for a scan that cannot be trusted to show what is around, as behaviours do that drive by it: two
    /// neighbouring beams have no distance (NaN or negative), or the layout is not finite. A single beam
    /// without a distance is tolerated: its neighbours see what stands there.
    ///
    /// ```
    /// use roverlab::io::LidarScan;
    /// let mut scan = LidarScan { angle_increment: 0.1, ranges: vec![1.0; 60], ..LidarScan::default() };
    /// scan.ranges[7] = f64::NAN;
    /// assert!(scan.validate().is_ok());
    /// scan.ranges[8] = f64::NAN;
    /// assert!(scan.validate().unwrap_err().to_string().contains("beams 7 and 8"));
    /// ```
    pub fn validate(&self) -> Result<()> {
        check_scan(self)
    }
}

/// Fails for a black image: the camera has no picture.
pub(crate) fn check_image(image: &RgbImage) -> Result<()> {
    check_levels(image.as_raw(), image.dimensions())
}

/// The same for a gray image.
pub(crate) fn check_gray_image(image: &GrayImage) -> Result<()> {
    check_levels(image.as_raw(), image.dimensions())
}

fn check_levels(levels: &[u8], (width, height): (u32, u32)) -> Result<()> {
    let good = levels.iter().any(|&value| value != 0);
    require("camera image", good, format_args!("black, {width} x {height} pixels"), "a picture")
}

fn is_distance(range: f64) -> bool {
    range >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_beams_may_lack_a_distance_but_no_two_neighbours() {
        let scan = |ranges: &[f64]| LidarScan {
            angle_increment: 0.1,
            ranges: ranges.to_vec(),
            ..LidarScan::default()
        };
        for ranges in [&[][..], &[f64::NAN, 1.0, -0.1, f64::INFINITY], &[0.0, 2.0]] {
            check_scan(&scan(ranges)).unwrap();
        }
        let error = check_scan(&scan(&[1.0, f64::NAN, f64::NEG_INFINITY])).unwrap_err();
        let expected = "lidar scan is NaN and -inf at beams 1 and 2; \
                        expected a distance at one of two neighbours at least";
        assert_eq!(error.to_string(), expected);
        assert!(
            check_scan(&scan(&[f64::NAN])).is_err() && check_scan(&scan(&[f64::NAN, 1.0, f64::NAN])).is_err()
        );
        let askew = LidarScan { angle_min: f64::NAN, ..scan(&[1.0, 1.0]) };
        assert!(check_scan(&askew).unwrap_err().to_string().starts_with("layout of the lidar scan"));
    }

    #[test]
    fn poses_speeds_and_distances_are_numbers() {
        assert!(check_pose(&Pose::new(0.0, f64::INFINITY, 0.0)).is_err());
        assert!(check_speed(&Twist::new(f64::NAN, 0.0)).is_err());
        assert!(check_attitude(&Attitude { pitch: f64::NAN, ..Attitude::default() }).is_err());
        check_distances("front range", &[0.0, f64::INFINITY]).unwrap();
        let error = check_distances("front range", &[1.0, -0.5]).unwrap_err().to_string();
        assert_eq!(error, "front range is -0.5; expected metres, or infinity without a return");
    }
}
