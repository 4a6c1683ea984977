use std::ops::{Bound, RangeBounds};

use super::colours::series;
use super::{Mark, Style};
use crate::geometry::{Aabb, Point, Pose};
use crate::world::{Footprint, World};

/// A picture of a world and of what is added to it, still or moving.
///
/// Every method that adds something returns the picture, so calls can be chained. Things of one sort are drawn in
/// the order in which they were added; areas lie below walls, walls below points and lines, lines below start and goal,
/// these below robots, and other marks above all.
///
/// What has times moves. The still picture shows the last moment, [`at`](Self::at) any other one.
#[derive(Debug, Clone)]
pub struct Picture {
    pub(super) world: World,
    pub(super) title: Option<String>,
    pub(super) caption: Option<String>,
    pub(super) items: Vec<Item>,
    /// Whether its lengths are metres of a world.
    pub(super) to_scale: bool,
    /// When what is added next is seen.
    from: f64,
    until: f64,
    coloured_robots: usize,
    true_paths: usize,
    odometry_paths: usize,
}

/// A thing in a picture, for other ways of drawing than SVG: see [`Picture::items`].
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What it is.
    pub figure: Figure,
    /// How it looks; marks and texts have looks of their own.
    pub style: Style,
    /// The first second in which it is seen.
    pub from: f64,
    /// The last second in which it is seen, or infinity.
    pub until: f64,
}

/// What can be drawn, in metres and seconds.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Figure {
    /// A disc on the floor.
    Disc {
        /// Its middle.
        centre: Point,
        /// Metres from there to its edge.
        radius: f64,
    },
    /// The corners of an area on the floor.
    Polygon(Vec<Point>),
    /// A cloud of points.
    Points(Vec<Point>),
    /// A line.
    Line {
        /// The points it goes through.
        points: Vec<Point>,
        /// When it reaches each of them; empty for a line that does not grow.
        times: Vec<f64>,
        /// The speed at each of them, in metres per second; empty for a line that is not coloured by it.
        speeds: Vec<f64>,
    },
    /// A line that changes its shape: when it has which. All shapes have as many points as the first.
    Moving(Vec<(f64, Vec<Point>)>),
    /// A robot.
    Robot {
        /// When it is where; a single one for a robot that stands.
        poses: Vec<(f64, Pose)>,
        /// Its outline.
        footprint: Footprint,
    },
    /// A marked point.
    Mark {
        /// The symbol; `None` for a text alone.
        mark: Option<Mark>,
        /// Where it is.
        position: Point,
        /// A short name beside it.
        text: Option<String>,
    },
}

impl Picture {
    /// A picture of a world without robots. The world is copied: what moves later does not move in the picture.
    pub fn new(world: &World) -> Self {
        Self {
            world: world.clone(),
            title: None,
            caption: None,
            items: Vec::new(),
            to_scale: true,
            from: 0.0,
            until: f64::INFINITY,
            coloured_robots: 0,
            true_paths: 0,
            odometry_paths: 0,
        }
    }

    /// The line above the picture.
    pub fn title(&mut self, text: impl Into<String>) -> &mut Self {
        self.title = Some(text.into());
        self
    }

    /// A smaller line below the title: the outcome of a run, say.
    pub fn caption(&mut self, text: impl Into<String>) -> &mut Self {
        self.caption = Some(text.into());
        self
    }

    /// Leaves out scale bar and grid: for charts, whose lengths are no metres.
    pub fn without_scale(&mut self) -> &mut Self {
        self.to_scale = false;
        self
    }

    /// Whether its lengths are metres of a world, as they are unless it is [without a scale](Self::without_scale).
    pub fn is_to_scale(&self) -> bool {
        self.to_scale
    }

    /// What is added from now on is seen in these seconds of a moving picture, `2.0..3.5` or `2.0..`; a still one shows
    /// what is seen at its end. Without a call, everything is seen all the time.
    pub fn during(&mut self, seconds: impl RangeBounds<f64>) -> &mut Self {
        let number = |bound: Bound<&f64>, open: f64| match bound {
            Bound::Included(&time) | Bound::Excluded(&time) if !time.is_nan() => time,
            _ => open,
        };
        self.from = number(seconds.start_bound(), 0.0);
        self.until = number(seconds.end_bound(), f64::INFINITY);
        self
    }

    /// Adds a figure.
    pub fn add(&mut self, figure: Figure, style: Style) -> &mut Self {
        self.items.push(Item { figure, style, from: self.from, until: self.until });
        self
    }

    /// All that was added, in that order.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The time at which nothing changes any more, in seconds; 0 if nothing moves.
    pub fn duration(&self) -> f64 {
        self.items.iter().flat_map(Item::changes).filter(|time| time.is_finite()).fold(0.0, f64::max)
    }

    /// The picture at a time: what is seen then, as it is then.
    #[must_use]
    pub fn at(&self, time: f64) -> Self {
        let seen = self.items.iter().filter(|item| item.from <= time && time <= item.until);
        Self { items: seen.map(|item| item.at(time)).collect(), ..self.clone() }
    }

    /// A robot's outline and heading. Several robots take the colours of [`SERIES`](super::SERIES) in turn, as their
    /// true paths do.
    pub fn robot(&mut self, pose: Pose, footprint: &Footprint) -> &mut Self {
        self.add_robot(vec![(0.0, pose)], footprint)
    }

    /// A robot in a style of its own: pale for where it started, say.
    pub fn robot_with(&mut self, pose: Pose, footprint: &Footprint, style: Style) -> &mut Self {
        self.add(Figure::Robot { poses: vec![(0.0, pose)], footprint: *footprint }, style)
    }

    /// A robot that drives, and its true path: when it was where, in seconds.
    pub fn drive(&mut self, trail: &[(f64, Pose)], footprint: &Footprint) -> &mut Self {
        let style = self.next_true_path();
        self.trace(trail.iter().map(|(time, pose)| (*time, pose.position())), style);
        self.add_robot(trail.to_vec(), footprint)
    }

    fn add_robot(&mut self, poses: Vec<(f64, Pose)>, footprint: &Footprint) -> &mut Self {
        let style = Style::new(series(self.coloured_robots));
        self.coloured_robots += 1;
        self.add(Figure::Robot { poses, footprint: *footprint }, style)
    }

    /// Where a robot really was: a solid line.
    pub fn true_path(&mut self, points: impl IntoIterator<Item = Point>) -> &mut Self {
        let style = self.next_true_path();
        self.line(points, style)
    }

    fn next_true_path(&mut self) -> Style {
        self.true_paths += 1;
        Style::true_path().colour(series(self.true_paths - 1))
    }

    /// Where a robot believed to be: a dashed line.
    pub fn odometry_path(&mut self, points: impl IntoIterator<Item = Point>) -> &mut Self {
        let style = match self.odometry_paths {
            0 => Style::odometry(),
            n => Style::odometry().colour(series(n)),
        };
        self.odometry_paths += 1;
        self.line(points, style)
    }

    /// Where a robot really was, coloured by its speed there in metres per second. The legend shows the scale, which
    /// ends at the highest speed of the picture; the sign of a speed is ignored, and one that is not finite counts as 0.
    pub fn speed_path(&mut self, points: impl IntoIterator<Item = (Point, f64)>) -> &mut Self {
        let (points, speeds) = points.into_iter().unzip();
        self.add_speeds(points, Vec::new(), speeds)
    }

    /// The same for a line that grows: time, point and speed.
    pub fn speed_trace(&mut self, points: impl IntoIterator<Item = (f64, Point, f64)>) -> &mut Self {
        let (mut places, mut times, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        for (time, point, speed) in points {
            times.push(time);
            places.push(point);
            speeds.push(speed);
        }
        self.add_speeds(places, times, speeds)
    }

    fn add_speeds(&mut self, points: Vec<Point>, times: Vec<f64>, mut speeds: Vec<f64>) -> &mut Self {
        for speed in &mut speeds {
            *speed = if speed.is_finite() { speed.abs() } else { 0.0 };
        }
        self.true_paths += 1;
        self.add(Figure::Line { points, times, speeds }, Style::true_path().width(3.2))
    }

    /// A line through some points.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Figure::Line { points, times: Vec::new(), speeds: Vec::new() }, style)
    }

    /// A line that grows: when it reaches which point, in seconds.
    pub fn trace(&mut self, points: impl IntoIterator<Item = (f64, Point)>, style: Style) -> &mut Self {
        let (times, points) = points.into_iter().unzip();
        self.add(Figure::Line { points, times, speeds: Vec::new() }, style)
    }

    /// A line that changes its shape, a limb for instance: when it has which. Shapes with another number of points than
    /// the first are left out.
    pub fn moving_line(
        &mut self,
        shapes: impl IntoIterator<Item = (f64, Vec<Point>)>,
        style: Style,
    ) -> &mut Self {
        let mut shapes: Vec<_> = shapes.into_iter().collect();
        let count = shapes.first().map_or(0, |(_, points)| points.len());
        shapes.retain(|(time, points)| {
            time.is_finite() && points.len() == count && points.iter().all(is_finite)
        });
        self.add(Figure::Moving(shapes), style)
    }

    /// A cloud of points; the style's width is their diameter.
    pub fn points(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.add(Figure::Points(points.into_iter().collect()), style)
    }

    /// A disc on the floor, `radius` metres from its middle to its edge.
    pub fn disc(&mut self, centre: Point, radius: f64, style: Style) -> &mut Self {
        self.add(Figure::Disc { centre, radius }, style)
    }

    /// A polygon on the floor, given by its corners. A corner that is not finite is left out.
    pub fn polygon(&mut self, corners: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.add(Figure::Polygon(corners.into_iter().filter(is_finite).collect()), style)
    }

    /// A marked point. The legend explains the symbols that occur.
    pub fn mark(&mut self, mark: Mark, position: Point) -> &mut Self {
        self.add_mark(Some(mark), position, None)
    }

    /// A marked point with a short name beside it, such as `H1`. A name for which there is no room without touching
    /// another one is left out.
    pub fn mark_named(&mut self, mark: Mark, position: Point, name: impl Into<String>) -> &mut Self {
        self.add_mark(Some(mark), position, Some(name.into()))
    }

    /// A short text beside a point, without a symbol; left out, as a mark's name, where there is no room.
    pub fn text(&mut self, position: Point, text: impl Into<String>) -> &mut Self {
        self.add_mark(None, position, Some(text.into()))
    }

    fn add_mark(&mut self, mark: Option<Mark>, position: Point, text: Option<String>) -> &mut Self {
        self.add(Figure::Mark { mark, position, text }, Style::aid())
    }

    /// The part of the world that the picture shows: the world, and what was added not too far from it.
    pub(super) fn region(&self) -> Aabb {
        let thickest = self.world.walls.iter().fold(0.0, |most: f64, wall| most.max(wall.thickness));
        let world = self.world.site().inflated(0.5 * thickest);
        let longest = world.size().max();
        let near = world.inflated(0.5 * longest);
        // A world without extent limits nothing: then what was added is all there is to show.
        let empty = longest <= 0.0;
        let added = self.items.iter().flat_map(|item| item.figure.extent());
        let added = Aabb::around(added.filter(|p| is_finite(p) && (empty || near.contains(*p))));
        match added {
            Some(added) if empty => added,
            Some(added) => world.union(&added),
            None => world,
        }
    }
}

impl Item {
    /// When it changes.
    fn changes(&self) -> Vec<f64> {
        let mut times = match &self.figure {
            Figure::Line { times, .. } => times.clone(),
            Figure::Robot { poses, .. } => poses.iter().map(|(time, _)| *time).collect(),
            Figure::Moving(shapes) => shapes.iter().map(|(time, _)| *time).collect(),
            _ => Vec::new(),
        };
        times.extend([self.from, self.until]);
        times
    }

    fn at(&self, time: f64) -> Self {
        let figure = match &self.figure {
            Figure::Line { points, times, speeds } if !times.is_empty() => {
                let count = times.partition_point(|reached| *reached <= time).min(points.len());
                let speeds = speeds[..count.min(speeds.len())].to_vec();
                Figure::Line { points: points[..count].to_vec(), times: Vec::new(), speeds }
            }
            Figure::Robot { poses, footprint } => {
                Figure::Robot { poses: latest(poses, time), footprint: *footprint }
            }
            Figure::Moving(shapes) => Figure::Moving(latest(shapes, time)),
            other => other.clone(),
        };
        Self { figure, ..self.clone() }
    }
}

/// The last of some changes that has happened by a time, or the first one.
fn latest<T: Clone>(changes: &[(f64, T)], time: f64) -> Vec<(f64, T)> {
    let count = changes.partition_point(|(happened, _)| *happened <= time);
    changes.get(count.saturating_sub(1)).cloned().into_iter().collect()
}

impl Figure {
    /// Its points, and the corners of boxes around what has an extent.
    fn extent(&self) -> Vec<Point> {
        match self {
            Figure::Disc { centre, radius } => around(*centre, *radius).to_vec(),
            Figure::Polygon(points) | Figure::Points(points) | Figure::Line { points, .. } => points.clone(),
            Figure::Moving(shapes) => shapes.iter().flat_map(|(_, points)| points).copied().collect(),
            Figure::Robot { poses, footprint } => {
                let radius = footprint.bounding_radius();
                poses.iter().flat_map(|(_, pose)| around(pose.position(), radius)).collect()
            }
            Figure::Mark { position, .. } => vec![*position],
        }
    }

    /// Whether there is anything to see of it: of a line, more than so many metres.
    pub(super) fn is_visible(&self, shortest: f64) -> bool {
        let bounds = Aabb::around(self.extent().into_iter().filter(is_finite));
        let is_line = matches!(self, Figure::Line { .. });
        bounds.is_some_and(|bounds| !is_line || bounds.size().max() >= shortest)
    }
}

/// Two opposite corners of the square around a circle.
fn around(centre: Point, radius: f64) -> [Point; 2] {
    let bounds = Aabb { min: centre, max: centre }.inflated(radius);
    [bounds.min, bounds.max]
}

/// Whether both coordinates are finite numbers.
pub(super) fn is_finite(point: &Point) -> bool {
    point.x.is_finite() && point.y.is_finite()
}
