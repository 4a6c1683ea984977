use crate::ParameterError;
use crate::parameter::{require, require_up_to};

/// Options of [`super::obstacle_course`].
///
/// ```
/// use roverlab::world::generate::CourseOptions;
/// let large = CourseOptions { size: (5.0, 8.0), obstacles: (6, 12), ..CourseOptions::default() };
/// assert!(large.validate().is_ok());
/// assert!(CourseOptions { unreachable_share: 1.5, ..large }.validate().is_err());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CourseOptions {
    /// Smallest and largest length of the field's sides (m). Each side is drawn independently.
    pub size: (f64, f64),
    /// Smallest and largest number of obstacles; fewer if they do not fit.
    pub obstacles: (usize, usize),
    /// Largest number of crates and cans between the obstacles. They are fixed to the floor.
    pub objects: usize,
    /// Smallest width of a passage between solids, unless it is closed (m).
    pub min_corridor: f64,
    /// Radius of the disc-shaped robot for which the course is made (m).
    pub robot_radius: f64,
    /// Fraction of courses with an unreachable goal, 0 to 1.
    pub unreachable_share: f64,
}

impl Default for CourseOptions {
    /// Fields of 4 m to 6 m with three to eight obstacles and up to three objects, for a robot radius of 60
    /// mm and passages of 1.5 robot widths; one goal in four is unreachable.
    fn default() -> Self {
        let robot_radius = 0.060;
        Self {
            size: (4.0, 6.0),
            obstacles: (3, 8),
            objects: 3,
            min_corridor: 1.5 * 2.0 * robot_radius,
            robot_radius,
            unreachable_share: 0.25,
        }
    }
}

impl CourseOptions {
    /// Limit of the numbers of obstacles and objects.
    pub const MAX_COUNT: usize = 100;

    /// Checks that every number is valid, and that the field is larger than the robot.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let radius = self.robot_radius;
        require_up_to("robot radius", radius, 10.0)?;
        let corridor = self.min_corridor;
        require(
            "minimal corridor",
            corridor,
            (2.2 * radius..=6.0 * radius).contains(&corridor),
            "1.1 to 3 times the robot's width",
        )?;
        let (least, greatest) = self.size;
        require(
            "size (least)",
            least,
            least >= 15.0 * corridor && least <= 500.0 * radius,
            "at least 15 minimal corridors and at most 250 robot widths",
        )?;
        require(
            "size (greatest)",
            greatest,
            greatest >= least && greatest <= 500.0 * radius,
            "no less than the least side and at most 250 robot widths",
        )?;
        let (fewest, most) = self.obstacles;
        require("least number of obstacles", fewest as f64, fewest <= Self::MAX_COUNT, "at most 100")?;
        require(
            "greatest number of obstacles",
            most as f64,
            (fewest..=Self::MAX_COUNT).contains(&most),
            "no less than the least number and at most 100",
        )?;
        require("number of objects", self.objects as f64, self.objects <= Self::MAX_COUNT, "at most 100")?;
        let share = self.unreachable_share;
        require("share of unreachable goals", share, (0.0..=1.0).contains(&share), "0 to 1")
    }
}

#[cfg(test)]
mod tests {
    use super::CourseOptions;

    #[test]
    fn the_message_names_parameter_value_and_range() {
        let options = CourseOptions { min_corridor: 0.1, ..CourseOptions::default() };
        assert_eq!(
            options.validate().unwrap_err().to_string(),
            "minimal corridor is 0.1; expected 1.1 to 3 times the robot's width"
        );
    }

    #[test]
    fn nonsense_is_refused() {
        let good = CourseOptions::default();
        assert!(good.validate().is_ok());
        for bad in [
            CourseOptions { robot_radius: 0.0, ..good.clone() },
            CourseOptions { robot_radius: f64::NAN, ..good.clone() },
            CourseOptions { min_corridor: f64::INFINITY, ..good.clone() },
            CourseOptions { size: (0.5, 6.0), ..good.clone() },
            CourseOptions { size: (6.0, 4.0), ..good.clone() },
            CourseOptions { size: (4.0, f64::NAN), ..good.clone() },
            CourseOptions { obstacles: (4, 3), ..good.clone() },
            CourseOptions { obstacles: (0, 1000), ..good.clone() },
            CourseOptions { objects: 101, ..good.clone() },
            CourseOptions { unreachable_share: -0.1, ..good.clone() },
        ] {
            assert!(bad.validate().is_err(), "{bad:?}");
        }
    }
}
