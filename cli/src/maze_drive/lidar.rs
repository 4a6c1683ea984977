use std::collections::BTreeMap;

use roverlab::geometry::{Point, Pose};
use roverlab::io::control::{self, Halt, until};
use roverlab::maze::{LidarLeft, LidarLeftParameters};
use roverlab::picture::Style;
use roverlab::world::Wall;

use super::place::Place;
use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres};
use crate::driving::{Conditions, paced};

/// Command line of `maze-lidar`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Follows the left wall of a maze by lidar until the goal or the start is reached, and draws a map",
    after_help = "\
--world accepts a maze in any format (EyeSim's .maz, the micromouse text format, .maze, map, num), including the start.
Cells are 360 mm wide. The map contains all lidar points at their odometry positions, so odometry errors distort it.

JSON fields:
  width, height               cells
  cells                       cells that the robot has truly visited
  map_points                  number of points in the map
  map_error_mm                mean distance of the map's points from the nearest wall
  odometry_error_mm           final true error of odometry
  picture                     always
Outcomes: goal, returned, timed_out, collided, failed."
)]
pub(crate) struct LidarArgs {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(LidarArgs, common: CommonArgs);

/// The command's work.
pub(crate) fn work(args: &LidarArgs) -> Result<Report, Failure> {
    args.common.check_picture()?;
    let place = Place::new(&args.common, false)?;
    let (maze, scale) = (place.maze(), place.scale);
    let scene = place.scene();
    let start = scene.robots[0].pose;
    let conditions = Conditions::new(&args.common, 60.0 + 12.0 * maze.cell_count() as f64)?;
    let parameters = LidarLeftParameters::for_corridor(scale.cell - scale.wall);
    let mut follower = LidarLeft::new(parameters).map_err(Failure::input)?;
    let mut map: Vec<Point> = Vec::new();
    let mut visited = vec![false; maze.cell_count()];
    let mut steps = 0_u32;
    let run = conditions.run_watched(&scene, paced(&args.common), |robot, step| {
        let mut left_start = false;
        control::run(robot, &mut follower, conditions.time_limit, |_, _, at| {
            let truth: Pose = step();
            // One scan in ten is enough for a map.
            if steps.is_multiple_of(10) {
                map.extend(at.seen.points().map(|point| start.to_world(point)));
            }
            steps += 1;
            let Some(cell) = scale.cell_of(maze, truth.position()) else { return until(true) };
            visited[maze.index(cell)] = true;
            let middle = (scale.centre(cell) - truth.position()).norm() < 0.3 * scale.cell;
            left_start |= cell != maze.start();
            until(middle && (maze.is_goal(cell) || (left_start && cell == maze.start())))
        })
    })?;
    let at_goal = place.is_at_goal(run.truth.pose.position());
    let walls = NearWalls::new(&scene.world.walls, scale.cell);
    let error = map.iter().map(|&point| walls.distance(point)).sum::<f64>() / map.len().max(1) as f64;
    let report = run.report(|outcome| match outcome {
        Halt::TimedOut => Outcome::failure("timed_out"),
        Halt::Stopped => Outcome::verdict(if at_goal { "goal" } else { "returned" }),
    });
    let lost = run.truth.pose.distance_to(run.odometry.position());
    let report = report
        .field("width", maze.width())
        .field("height", maze.height())
        .field("cells", visited.iter().filter(|&&visited| visited).count())
        .field("map_points", map.len())
        .field("map_error_mm", millimetres(error))
        .field("odometry_error_mm", millimetres(lost));
    Ok(args.common.draw(report, "maze_lidar.svg", || {
        let mut picture = place.picture_of("Left wall by lidar", format!("{} points", map.len()), &run);
        picture.points(map.iter().copied(), Style::lidar().labelled("map by odometry"));
        picture
    }))
}

/// Walls indexed by the grid squares near them, as a map has millions of points.
struct NearWalls<'a> {
    walls: &'a [Wall],
    side: f64,
    /// By column and row, the walls less than one side length away from the square.
    squares: BTreeMap<(i64, i64), Vec<&'a Wall>>,
}

impl<'a> NearWalls<'a> {
    fn new(walls: &'a [Wall], side: f64) -> Self {
        let mut squares: BTreeMap<_, Vec<&Wall>> = BTreeMap::new();
        for wall in walls {
            let (a, b) = (wall.line.a, wall.line.b);
            let reach = side + 0.5 * wall.thickness;
            let column = |x: f64| (x / side).floor() as i64;
            for x in column(a.x.min(b.x) - reach)..=column(a.x.max(b.x) + reach) {
                for y in column(a.y.min(b.y) - reach)..=column(a.y.max(b.y) + reach) {
                    squares.entry((x, y)).or_default().push(wall);
                }
            }
        }
        Self { walls, side, squares }
    }

    /// Distance of a point from the nearest wall (m); 0 within one.
    fn distance(&self, point: Point) -> f64 {
        let square = ((point.x / self.side).floor() as i64, (point.y / self.side).floor() as i64);
        let near = self.squares.get(&square).map_or(&[][..], Vec::as_slice);
        let distance = nearest(near.iter().copied(), point);
        // Beyond a side length, another wall may be nearer.
        if distance <= self.side { distance } else { nearest(self.walls.iter(), point) }
    }
}

fn nearest<'a>(walls: impl Iterator<Item = &'a Wall>, point: Point) -> f64 {
    let distances = walls.map(|wall| wall.line.distance_to(point) - 0.5 * wall.thickness);
    distances.fold(f64::INFINITY, f64::min).max(0.0)
}

#[cfg(test)]
mod tests {
    use roverlab::maze::{Maze, Scale};

    use super::*;

    #[test]
    fn near_walls_are_as_near_as_all() {
        let world = Scale::DOUBLED.world(&Maze::open(3, 2).unwrap());
        let walls = NearWalls::new(&world.walls, Scale::DOUBLED.cell);
        for (x, y) in (-20..40).flat_map(|x| (-20..40).map(move |y| (x, y))) {
            let point = Point::new(0.05 * f64::from(x), 0.05 * f64::from(y));
            assert_eq!(walls.distance(point), nearest(world.walls.iter(), point), "{point}");
        }
    }
}
