use std::ops::{Bound, RangeBounds};

use super::colours::series;
use super::{Mark, Style};
use crate::geometry::{Aabb, Point, Pose, Vector};
use crate::world::{Footprint, World};

/// A still or animated picture of a world and of the things added to it.
///
/// Every method that adds something returns the picture, so calls can be chained. Things of one kind are
/// drawn in the order of their addition. The layers from the bottom: areas, walls, points and lines, start
/// and goal, robots, other marks.
///
/// Things with times move. The still picture shows the last moment, [`at`](Self::at) any other one.
#[derive(Debug, Clone)]
pub struct Picture {
    pub(super) world: World,
    /// Floors of panels with water or hills, and how far each is shifted.
    pub(super) grounds: Vec<(World, Vector)>,
    /// Of panels, the first one that is to scale.
    pub(super) first_plan: Option<Box<Picture>>,
    pub(super) title: Option<String>,
    pub(super) caption: Option<String>,
    pub(super) items: Vec<Item>,
    /// Whether lengths are metres of a world.
    pub(super) to_scale: bool,
    /// Time interval in which later additions are visible (s).
    from: f64,
    until: f64,
    coloured_robots: usize,
    true_paths: usize,
    odometry_paths: usize,
}

/// A thing in a picture, for renderers other than SVG: see [`Picture::items`].
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What to draw.
    pub figure: Figure,
    /// Its style; marks and texts have their own.
    pub style: Style,
    /// Start of its visibility (s).
    pub from: f64,
    /// End of its visibility (s), or infinity.
    pub until: f64,
}

/// Something to draw, in metres and seconds.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Figure {
    /// A disc on the floor.
    Disc {
        /// Centre.
        centre: Point,
        /// Radius (m).
        radius: f64,
    },
    /// An area on the floor, given by its corners.
    Polygon(Vec<Point>),
    /// A cloud of points.
    Points(Vec<Point>),
    /// A line.
    Line {
        /// Points of the line.
        points: Vec<Point>,
        /// Times at which it reaches them (s); empty for a line that does not grow.
        times: Vec<f64>,
        /// Speeds at them (m/s); empty for a line not coloured by speed.
        speeds: Vec<f64>,
    },
    /// A line that changes its shape: times and shapes. All shapes have as many points as the first.
    Moving(Vec<(f64, Vec<Point>)>),
    /// A robot.
    Robot {
        /// Times (s) and poses; a single one for a standing robot.
        poses: Vec<(f64, Pose)>,
        /// Its outline.
        footprint: Footprint,
    },
    /// A marked point.
    Mark {
        /// Symbol; `None` for a text alone.
        mark: Option<Mark>,
        /// Position.
        position: Point,
        /// Short name beside it.
        text: Option<String>,
    },
}

impl Picture {
    /// A picture of a world without robots. The world is copied; later changes do not show.
    pub fn new(world: &World) -> Self {
        Self {
            world: world.clone(),
            grounds: Vec::new(),
            first_plan: None,
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

    /// Sets the title above the picture.
    pub fn title(&mut self, text: impl Into<String>) -> &mut Self {
        self.title = Some(text.into());
        self
    }

    /// Sets the smaller line below the title, such as the outcome of a run.
    pub fn caption(&mut self, text: impl Into<String>) -> &mut Self {
        self.caption = Some(text.into());
        self
    }

    /// Omits scale bar and grid: for charts, whose lengths are not metres.
    pub fn without_scale(&mut self) -> &mut Self {
        self.to_scale = false;
        self
    }

    /// The part whose coordinates are those of the world: the picture itself, or of [`panels`](Self::panels)
    /// the first such panel. `None` if all is [without a scale](Self::without_scale).
    pub fn plan(&self) -> Option<&Self> {
        self.first_plan.as_deref().or_else(|| self.to_scale.then_some(self))
    }

    /// Sets the time interval in which later additions are visible in an animated picture, `2.0..3.5` or
    /// `2.0..` (s); a still picture shows what is visible at its end. By default everything is always
    /// visible.
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

    /// All additions, in order.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// Time of the last change (s); 0 if nothing moves.
    pub fn duration(&self) -> f64 {
        self.items.iter().flat_map(Item::changes).filter(|time| time.is_finite()).fold(0.0, f64::max)
    }

    /// The picture at a time (s).
    #[must_use]
    pub fn at(&self, time: f64) -> Self {
        let seen = self.items.iter().filter(|item| item.from <= time && time <= item.until);
        Self { items: seen.map(|item| item.at(time)).collect(), ..self.clone() }
    }

    /// Adds a robot's outline and heading. Several robots take the colours of [`SERIES`](super::SERIES) in
    /// turn, like their true paths.
    pub fn robot(&mut self, pose: Pose, footprint: &Footprint) -> &mut Self {
        self.add_robot(vec![(0.0, pose)], footprint)
    }

    /// Adds a robot in its own style, such as a pale one for its start.
    pub fn robot_with(&mut self, pose: Pose, footprint: &Footprint, style: Style) -> &mut Self {
        self.add(Figure::Robot { poses: vec![(0.0, pose)], footprint: *footprint }, style)
    }

    /// Adds a driving robot and its true path: times (s) and poses.
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

    /// Adds a robot's true path: a solid line.
    pub fn true_path(&mut self, points: impl IntoIterator<Item = Point>) -> &mut Self {
        let style = self.next_true_path();
        self.line(points, style)
    }

    fn next_true_path(&mut self) -> Style {
        self.true_paths += 1;
        Style::true_path().colour(series(self.true_paths - 1))
    }

    /// Adds a robot's path by odometry: a dashed line.
    pub fn odometry_path(&mut self, points: impl IntoIterator<Item = Point>) -> &mut Self {
        let style = match self.odometry_paths {
            0 => Style::odometry(),
            n => Style::odometry().colour(series(n)),
        };
        self.odometry_paths += 1;
        self.line(points, style)
    }

    /// Adds a robot's true path, coloured by speed (m/s). The legend shows the scale, which ends at the
    /// highest speed of the picture. The sign of a speed is ignored; one that is not finite counts as 0.
    pub fn speed_path(&mut self, points: impl IntoIterator<Item = (Point, f64)>) -> &mut Self {
        let (points, speeds) = points.into_iter().unzip();
        self.add_speeds(points, Vec::new(), speeds)
    }

    /// The same for a growing line: time (s), point and speed (m/s).
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

    /// Adds a line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        let points = points.into_iter().collect();
        self.add(Figure::Line { points, times: Vec::new(), speeds: Vec::new() }, style)
    }

    /// Adds a growing line: times (s) and points.
    pub fn trace(&mut self, points: impl IntoIterator<Item = (f64, Point)>, style: Style) -> &mut Self {
        let (times, points) = points.into_iter().unzip();
        self.add(Figure::Line { points, times, speeds: Vec::new() }, style)
    }

    /// Adds a line that changes its shape, such as a limb: times (s) and shapes. Shapes with a number of
    /// points that differs from the first are omitted.
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

    /// Adds a cloud of points; the style's width is their diameter.
    pub fn points(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.add(Figure::Points(points.into_iter().collect()), style)
    }

    /// Adds a disc on the floor with a radius in metres.
    pub fn disc(&mut self, centre: Point, radius: f64, style: Style) -> &mut Self {
        self.add(Figure::Disc { centre, radius }, style)
    }

    /// Adds a polygon on the floor, given by its corners. Corners that are not finite are omitted.
    pub fn polygon(&mut self, corners: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.add(Figure::Polygon(corners.into_iter().filter(is_finite).collect()), style)
    }

    /// Adds a marked point. The legend explains its symbol.
    pub fn mark(&mut self, mark: Mark, position: Point) -> &mut Self {
        self.add_mark(Some(mark), position, None)
    }

    /// Adds a marked point with a short name beside it, such as `H1`. The name is omitted if it would overlap
    /// another one.
    pub fn mark_named(&mut self, mark: Mark, position: Point, name: impl Into<String>) -> &mut Self {
        self.add_mark(Some(mark), position, Some(name.into()))
    }

    /// Adds a short text beside a point, without a symbol; omitted where there is no room, like the name of a
    /// mark.
    pub fn text(&mut self, position: Point, text: impl Into<String>) -> &mut Self {
        self.add_mark(None, position, Some(text.into()))
    }

    fn add_mark(&mut self, mark: Option<Mark>, position: Point, text: Option<String>) -> &mut Self {
        self.add(Figure::Mark { mark, position, text }, Style::aid())
    }

    /// The region to show: the world, and additions not too far from it.
    pub(super) fn region(&self) -> Aabb {
        let thickest = self.world.walls.iter().fold(0.0, |most: f64, wall| most.max(wall.thickness));
        let world = self.world.site().inflated(0.5 * thickest);
        let longest = world.size().max();
        let near = world.inflated(0.5 * longest);
        // A world without extent limits nothing: the additions alone determine the region.
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
    /// Times of its changes (s).
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

/// The last change up to a time, or the first one.
fn latest<T: Clone>(changes: &[(f64, T)], time: f64) -> Vec<(f64, T)> {
    let count = changes.partition_point(|(happened, _)| *happened <= time);
    changes.get(count.saturating_sub(1)).cloned().into_iter().collect()
}

impl Figure {
    /// Its points, and the corners of its bounding box if it has an extent.
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

    /// Whether it is visible; a line must be longer than `shortest` metres.
    pub(super) fn is_visible(&self, shortest: f64) -> bool {
        let bounds = Aabb::around(self.extent().into_iter().filter(is_finite));
        let is_line = matches!(self, Figure::Line { .. });
        bounds.is_some_and(|bounds| !is_line || bounds.size().max() >= shortest)
    }
}

/// Two opposite corners of the bounding square of a circle.
fn around(centre: Point, radius: f64) -> [Point; 2] {
    let bounds = Aabb { min: centre, max: centre }.inflated(radius);
    [bounds.min, bounds.max]
}

/// Whether both coordinates are finite.
pub(super) fn is_finite(point: &Point) -> bool {
    point.x.is_finite() && point.y.is_finite()
}
