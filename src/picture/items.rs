use super::colours::series;
use super::{Mark, Style};
use crate::geometry::{Aabb, Point, Pose};
use crate::world::{Footprint, World};

/// A picture of a world and of what is added to it.
///
/// Every method that adds something returns the picture, so calls can be chained. Things of one sort are drawn in
/// the order in which they were added; areas lie below walls, walls below points and lines, lines below robots and
/// marks.
#[derive(Debug, Clone)]
pub struct Picture {
    pub(super) world: World,
    pub(super) title: Option<String>,
    pub(super) caption: Option<String>,
    pub(super) areas: Vec<Area>,
    pub(super) clouds: Vec<Cloud>,
    pub(super) lines: Vec<Line>,
    pub(super) robots: Vec<Robot>,
    pub(super) marks: Vec<Marked>,
    /// Whether its lengths are metres of a world.
    pub(super) to_scale: bool,
    coloured_robots: usize,
    true_paths: usize,
    odometry_paths: usize,
}

/// Something with an inside, below the walls.
#[derive(Debug, Clone)]
pub(super) struct Area {
    pub(super) outline: Outline,
    pub(super) style: Style,
}

#[derive(Debug, Clone)]
pub(super) enum Outline {
    Disc { centre: Point, radius: f64 },
    Polygon(Vec<Point>),
}

#[derive(Debug, Clone)]
pub(super) struct Cloud {
    pub(super) points: Vec<Point>,
    pub(super) style: Style,
}

#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) points: Vec<Point>,
    /// The speed at every point, in metres per second, if the line is coloured by it.
    pub(super) speeds: Option<Vec<f64>>,
    pub(super) style: Style,
}

#[derive(Debug, Clone)]
pub(super) struct Robot {
    pub(super) pose: Pose,
    pub(super) footprint: Footprint,
    pub(super) style: Style,
}

#[derive(Debug, Clone)]
pub(super) struct Marked {
    /// The symbol; `None` for a text alone.
    pub(super) mark: Option<Mark>,
    pub(super) position: Point,
    pub(super) text: Option<String>,
}

impl Picture {
    /// A picture of a world without robots. The world is copied: what moves later does not move in the picture.
    pub fn new(world: &World) -> Self {
        Self {
            world: world.clone(),
            title: None,
            caption: None,
            areas: Vec::new(),
            clouds: Vec::new(),
            lines: Vec::new(),
            robots: Vec::new(),
            marks: Vec::new(),
            to_scale: true,
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

    /// A robot's outline and heading. Several robots take the colours of [`SERIES`](super::SERIES) in turn, as their
    /// true paths do.
    pub fn robot(&mut self, pose: Pose, footprint: &Footprint) -> &mut Self {
        let style = Style::new(series(self.coloured_robots));
        self.coloured_robots += 1;
        self.robot_with(pose, footprint, style)
    }

    /// A robot in a style of its own: pale for where it started, say.
    pub fn robot_with(&mut self, pose: Pose, footprint: &Footprint, style: Style) -> &mut Self {
        self.robots.push(Robot { pose, footprint: *footprint, style });
        self
    }

    /// Where a robot really was: a solid line.
    pub fn true_path(&mut self, points: impl IntoIterator<Item = Point>) -> &mut Self {
        let style = Style::true_path().colour(series(self.true_paths));
        self.true_paths += 1;
        self.line(points, style)
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
        let size = |speed: f64| if speed.is_finite() { speed.abs() } else { 0.0 };
        let (points, speeds) = points.into_iter().map(|(point, speed)| (point, size(speed))).unzip();
        let style = Style::true_path().width(3.2);
        self.true_paths += 1;
        self.lines.push(Line { points, speeds: Some(speeds), style });
        self
    }

    /// A line through some points.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.lines.push(Line { points: points.into_iter().collect(), speeds: None, style });
        self
    }

    /// A cloud of points; the style's width is their diameter.
    pub fn points(&mut self, points: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        self.clouds.push(Cloud { points: points.into_iter().collect(), style });
        self
    }

    /// A disc on the floor, `radius` metres from its middle to its edge.
    pub fn disc(&mut self, centre: Point, radius: f64, style: Style) -> &mut Self {
        self.areas.push(Area { outline: Outline::Disc { centre, radius }, style });
        self
    }

    /// A polygon on the floor, given by its corners. A corner that is not finite is left out.
    pub fn polygon(&mut self, corners: impl IntoIterator<Item = Point>, style: Style) -> &mut Self {
        let finite = corners.into_iter().filter(is_finite).collect();
        self.areas.push(Area { outline: Outline::Polygon(finite), style });
        self
    }

    /// A marked point. The legend explains the symbols that occur.
    pub fn mark(&mut self, mark: Mark, position: Point) -> &mut Self {
        self.marks.push(Marked { mark: Some(mark), position, text: None });
        self
    }

    /// A marked point with a short name beside it, such as `H1`. A name for which there is no room without touching
    /// another one is left out.
    pub fn mark_named(&mut self, mark: Mark, position: Point, name: impl Into<String>) -> &mut Self {
        self.marks.push(Marked { mark: Some(mark), position, text: Some(name.into()) });
        self
    }

    /// A short text beside a point, without a symbol; left out, as a mark's name, where there is no room.
    pub fn text(&mut self, position: Point, text: impl Into<String>) -> &mut Self {
        self.marks.push(Marked { mark: None, position, text: Some(text.into()) });
        self
    }

    /// The marked points that are somewhere.
    pub(super) fn finite_marks(&self) -> impl Iterator<Item = &Marked> {
        self.marks.iter().filter(|marked| is_finite(&marked.position))
    }

    /// The part of the world that the picture shows: the world, and what was added not too far from it.
    pub(super) fn region(&self) -> Aabb {
        let thickest = self.world.walls.iter().fold(0.0, |most: f64, wall| most.max(wall.thickness));
        let world = self.world.site().inflated(0.5 * thickest);
        let longest = world.size().max();
        let near = world.inflated(0.5 * longest);
        // A world without extent limits nothing: then what was added is all there is to show.
        let empty = longest <= 0.0;
        let added = Aabb::around(self.added().filter(|p| is_finite(p) && (empty || near.contains(*p))));
        match added {
            Some(added) if empty => added,
            Some(added) => world.union(&added),
            None => world,
        }
    }

    /// Every point that was added, and the corners of boxes around what has an extent.
    fn added(&self) -> impl Iterator<Item = Point> {
        let areas = self.areas.iter().flat_map(|area| area.outline.corners());
        let clouds = self.clouds.iter().flat_map(|cloud| cloud.points.iter().copied());
        let lines = self.lines.iter().flat_map(|line| line.points.iter().copied());
        let robots =
            self.robots.iter().flat_map(|r| around(r.pose.position(), r.footprint.bounding_radius()));
        let marks = self.marks.iter().map(|mark| mark.position);
        areas.chain(clouds).chain(lines).chain(robots).chain(marks)
    }
}

impl Outline {
    fn corners(&self) -> Vec<Point> {
        match self {
            Outline::Disc { centre, radius } => around(*centre, *radius).to_vec(),
            Outline::Polygon(corners) => corners.clone(),
        }
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
