use proptest::prelude::*;

use crate::random::Stream;
use crate::world::road::{RoadCourse, RoadCourseOptions, Traffic, generate};

/// Closed courses by the rules of the CAuDri-Challenge, of either traffic, in the rules' size or half of it,
/// with or without gaps, crossings and crosswalks.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{Config, TestRunner};
/// use roverlab::testing::courses;
/// TestRunner::new(Config::with_cases(4)).run(&courses(), |course| {
///     prop_assert!(course.check().is_ok(), "it is legal");
///     Ok(())
/// }).unwrap();
/// ```
pub fn courses() -> impl Strategy<Value = RoadCourse> {
    any::<u64>().prop_filter_map("options that no course meets", |seed| {
        let mut random = Stream::new(seed).child("course options", 0);
        let traffic = if random.chance(0.5) { Traffic::Right } else { Traffic::Left };
        let size = if random.chance(0.5) { 1.0 } else { 0.5 };
        let options = RoadCourseOptions {
            traffic,
            size,
            gaps: random.between(0.0, 0.3),
            crossings: random.uniform(),
            zebras: random.uniform(),
            ..RoadCourseOptions::default()
        };
        generate(seed, &options).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        /// A place on the lane is found again, wherever the car is.
        #[test]
        fn every_place_of_every_lane_is_found_again(
            course in courses(), share in 0.0..1.0_f64, offset in -0.1..0.1_f64, turn in -0.5..0.5_f64
        ) {
            let along = share * course.line.length();
            let pose = course.pose(along, offset);
            let found = course.locate(&Pose::new(pose.x, pose.y, pose.heading + turn), Some(along));
            prop_assert!((found.offset - offset).abs() < 1e-3, "{:?}", found);
            prop_assert!((found.heading - turn).abs() < 1e-2, "{:?}", found);
            prop_assert!(course.floor().contains(pose.position()));
        }
    }
}
