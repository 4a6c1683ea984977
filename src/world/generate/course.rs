use crate::ParameterError;
use std::f64::consts::PI;

use super::layout::Layout;
use super::survey::{Margins, Survey};
use super::{CourseOptions, ObstacleKind};
use crate::geometry::{Point, Pose, Vector};
use crate::random::Stream;
use crate::world::World;

/// Number of draws with the same number of obstacles, before it is reduced by one.
const TRIES_WITH_ALL: usize = 8;

/// Number of candidates for the start.
const START_PLACES: usize = 12;

/// A world with a start, a goal and the reachability of the goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The field with its border, obstacles and objects. Its own start pose is the course's.
    pub world: World,
    /// Start pose.
    pub start: Pose,
    /// Goal.
    pub goal: Point,
    /// Whether the goal is reachable.
    pub reachable: bool,
    /// Obstacles in the order of their placement, without objects.
    pub obstacles: Vec<ObstacleKind>,
}

/// Draws a course.
///
/// Start and goal have room for a disc as wide as the narrowest corridor, and are often in difficult places:
/// in a cove, a room, a corridor or close to a wall. The path between them tends to be longer than the
/// straight line. An unreachable goal is within a closed line of walls with the start outside, or vice versa.
///
/// Reachability is determined by a flood fill of the finished world's free cells, each a sixth of the robot's
/// radius wide. It holds for every disc from the robot's radius to half the narrowest corridor: fields with
/// an accessible passage or niche between these widths are drawn again. After many such failures the number
/// of obstacles is reduced, so that a course is always found.
///
/// The run time is about 20 ms with default options.
///
/// ```
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{CourseOptions, obstacle_course};
/// let options = CourseOptions { unreachable_share: 0.0, ..CourseOptions::default() };
/// let course = obstacle_course(&mut Stream::new(1), &options)?;
/// assert!(course.reachable && !course.obstacles.is_empty());
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
///
/// # Errors
///
/// If the options do not pass [`CourseOptions::validate`].
pub fn obstacle_course(stream: &mut Stream, options: &CourseOptions) -> Result<Course, ParameterError> {
    draw(stream, options, &ObstacleKind::DRAWN)
}

/// The same with selected kinds of obstacles.
pub(super) fn draw(
    stream: &mut Stream,
    options: &CourseOptions,
    kinds: &[ObstacleKind],
) -> Result<Course, ParameterError> {
    options.validate()?;
    let margins = Margins::new(options);
    let (fewest, most) = options.obstacles;
    let enclosed = stream.chance(options.unreachable_share);
    let mut wanted = (fewest + stream.below(most - fewest + 1)).max(usize::from(enclosed));
    loop {
        for _ in 0..TRIES_WITH_ALL {
            if let Some(course) = try_course(stream, options, margins, (kinds, wanted), enclosed) {
                return Ok(course);
            }
        }
        if wanted == 0 {
            return Ok(plain_course(options, margins, enclosed));
        }
        wanted -= 1;
    }
}

/// An empty field, with a box around an unreachable goal: the fallback if no other course was found.
fn plain_course(options: &CourseOptions, margins: Margins, enclosed: bool) -> Course {
    let side = options.size.0;
    let mut world = World::walled(side, side);
    let (start, goal) = (Pose::new(0.2 * side, 0.2 * side, 0.0), Point::new(0.6 * side, 0.6 * side));
    let mut obstacles = Vec::new();
    if enclosed {
        let half = margins.room;
        let corner = |x: f64, y: f64| goal + Vector::new(x * half, y * half);
        world.add_loop(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        obstacles.push(ObstacleKind::Enclosure);
    }
    world.start = Some(start);
    Course { world, start, goal, reachable: !enclosed, obstacles }
}

fn try_course(
    stream: &mut Stream,
    options: &CourseOptions,
    margins: Margins,
    (kinds, wanted): (&[ObstacleKind], usize),
    enclosed: bool,
) -> Option<Course> {
    let mut layout = Layout::new(stream, options, margins.room);
    layout.fill(stream, kinds, wanted, enclosed);
    layout.add_objects(stream, options.objects);
    let survey = Survey::new(&layout.world, margins)?;
    let (start, goal) = if enclosed {
        separated_places(stream, &layout, &survey)?
    } else {
        connected_places(stream, &layout, &survey)?
    };
    let start = Pose::new(start.x, start.y, stream.between(-PI, PI));
    let world = World { start: Some(start), ..layout.world };
    Some(Course { world, start, goal, reachable: !enclosed, obstacles: layout.kinds })
}

/// A start and a goal with a path between them.
fn connected_places(stream: &mut Stream, layout: &Layout, survey: &Survey) -> Option<(Point, Point)> {
    let region = survey.largest_region().filter(|&region| survey.is_sound(region))?;
    let goal = survey.draw_place(stream, region, &layout.pockets)?;
    let steps = survey.steps_from(goal);
    // Ratio of the path length in edge steps to that without obstacles.
    let detour = |start: &Point| {
        let steps = survey.raster().cell_at(*start).and_then(|cell| steps[cell]).unwrap_or(0);
        let straight = (start.x - goal.x).abs() + (start.y - goal.y).abs();
        f64::from(steps) * survey.raster().resolution() / straight
    };
    let starts = starts(stream, layout, survey, region, goal, 0.3);
    let hardest = stream.chance(0.6);
    let start = if hardest {
        starts.into_iter().max_by(|a, b| detour(a).total_cmp(&detour(b)))
    } else {
        starts.into_iter().next()
    };
    Some((start?, goal))
}

/// A start and a goal without a path between them: usually the goal is in the enclosure, sometimes the start.
fn separated_places(stream: &mut Stream, layout: &Layout, survey: &Survey) -> Option<(Point, Point)> {
    let inside = layout.chambers.iter().find_map(|&chamber| survey.region_at(chamber))?;
    let outside = survey.largest_region()?;
    let (from, to) = if stream.chance(0.75) { (outside, inside) } else { (inside, outside) };
    if !survey.are_apart(from, to) || !survey.is_sound(from) {
        return None;
    }
    let places = if to == inside { &layout.chambers } else { &layout.pockets };
    let goal = survey.draw_place(stream, to, places)?;
    let start = starts(stream, layout, survey, from, goal, 0.12).into_iter().next()?;
    Some((start, goal))
}

/// Start candidates in a region, at least a fraction of the field's shorter side from the goal.
fn starts(
    stream: &mut Stream,
    layout: &Layout,
    survey: &Survey,
    region: u32,
    goal: Point,
    share: f64,
) -> Vec<Point> {
    let least = share * layout.field.shorter();
    (0..START_PLACES)
        .filter_map(|_| survey.draw_place(stream, region, &layout.pockets))
        .filter(|start| (start - goal).norm() >= least)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::Reachability;
    use proptest::prelude::*;

    fn course(seed: u64, options: &CourseOptions) -> Course {
        obstacle_course(&mut Stream::new(seed), options).unwrap()
    }

    /// FNV-1a hash of the bits of everything that a robot can encounter.
    fn digest(course: &Course) -> u64 {
        let walls = course
            .world
            .walls
            .iter()
            .flat_map(|w| [w.line.a.x, w.line.a.y, w.line.b.x, w.line.b.y, w.thickness]);
        let objects = course.world.objects.iter().flat_map(|o| [o.pose.x, o.pose.y, o.pose.heading]);
        let ends = [course.start.x, course.start.y, course.start.heading, course.goal.x, course.goal.y];
        let bytes = walls.chain(objects).chain(ends).flat_map(|x| x.to_bits().to_le_bytes());
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }

    /// Properties of every course.
    fn check(course: &Course, options: &CourseOptions) -> Result<(), TestCaseError> {
        let (start, goal) = (course.start.position(), course.goal);
        let size = course.world.floor.size();
        let (least, greatest) = options.size;
        prop_assert!((least..=greatest).contains(&size.x) && (least..=greatest).contains(&size.y));
        prop_assert!(course.obstacles.len() <= options.obstacles.1.max(1));
        prop_assert!(course.world.objects.len() <= options.objects);
        for radius in [options.robot_radius, 0.5 * options.min_corridor] {
            let truth = Reachability::new(&course.world, radius, options.robot_radius / 12.0).unwrap();
            prop_assert!(truth.is_free(start) && truth.is_free(goal), "{}", radius);
            prop_assert_eq!(truth.connected(start, goal), course.reachable, "{}", radius);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(crate::testing::cases(24))]

        #[test]
        fn planners_for_both_radii_agree_with_the_answer(seed: u64) {
            let options = CourseOptions::default();
            check(&course(seed, &options), &options)?;
        }

        #[test]
        fn other_sizes_and_robots_do_as_well(
            seed: u64, radius in 0.05..0.2, width in 1.2..2.0, most in 0usize..12, share in 0.0..1.0,
        ) {
            let min_corridor = width * 2.0 * radius;
            let options = CourseOptions {
                size: (20.0 * min_corridor, 24.0 * min_corridor),
                obstacles: (most / 2, most),
                objects: most,
                min_corridor,
                robot_radius: radius,
                unreachable_share: share,
            };
            check(&course(seed, &options), &options)?;
        }

        #[test]
        fn equal_seeds_give_equal_courses(seed: u64) {
            let options = CourseOptions { obstacles: (2, 4), ..CourseOptions::default() };
            let (one, other) = (course(seed, &options), course(seed, &options));
            prop_assert_eq!(digest(&one), digest(&other));
            prop_assert_eq!(one, other);
        }

        #[test]
        fn plain_courses_hold_what_they_promise(enclosed: bool, radius in 0.02..0.2) {
            let options = CourseOptions {
                size: (45.0 * radius, 50.0 * radius), min_corridor: 3.0 * radius, robot_radius: radius,
                ..CourseOptions::default()
            };
            let course = plain_course(&options, Margins::new(&options), enclosed);
            prop_assert_eq!(course.reachable, !enclosed);
            check(&course, &options)?;
        }
    }

    #[test]
    fn the_shares_of_answers_and_shapes_are_as_asked_for() {
        let options = CourseOptions::default();
        let courses: Vec<Course> = (0..80).map(|seed| course(seed, &options)).collect();
        let unreachable = courses.iter().filter(|c| !c.reachable).count();
        assert!((10..=32).contains(&unreachable), "{unreachable}");
        let concave =
            courses.iter().filter(|c| c.obstacles.iter().filter(|k| k.is_concave()).count() >= 2).count();
        assert!(concave >= 70, "{concave}");
        let mut kinds: Vec<ObstacleKind> = courses.iter().flat_map(|c| c.obstacles.clone()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        assert_eq!(kinds.len(), ObstacleKind::DRAWN.len() + 1);
        for share in [0.0, 1.0] {
            let options = CourseOptions { unreachable_share: share, ..options.clone() };
            assert!((0..5).all(|seed| course(seed, &options).reachable == (share == 0.0)));
        }
    }

    /// Changes whenever the generator changes; users publish seeds of courses.
    #[test]
    fn a_seed_keeps_its_course() {
        assert_eq!(digest(&course(1, &CourseOptions::default())), 12_986_112_471_343_185_681);
    }

    #[test]
    fn bad_options_are_refused() {
        let options = CourseOptions { robot_radius: -1.0, ..CourseOptions::default() };
        let error = obstacle_course(&mut Stream::new(1), &options).unwrap_err();
        assert!(error.to_string().contains("robot radius is -1"));
    }
}
