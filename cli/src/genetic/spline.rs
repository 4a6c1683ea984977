use roverlab::drive::Path;
use roverlab::evolve::Population;
use roverlab::geometry::{Point, Pose};
use roverlab::io::Result;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::World;
use serde_json::{Map, Value, json};

use crate::common::{CommonArgs, millimetres, rounded};

/// Cost of a bend (m³): a bend of radius 0.5 m costs as much as 0.32 m of path.
const BEND: f64 = 0.08;

/// A spline with unknown scale.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spline {
    start: Pose,
    goal: Pose,
}

impl Spline {
    pub(crate) const GENES: usize = 1;

    pub(crate) fn new(common: &CommonArgs) -> Self {
        let start = common.start.unwrap_or(Pose::new(0.3, 0.4, 0.0));
        let goal = common.goal.map_or(Pose::new(2.4, 1.3, std::f64::consts::FRAC_PI_2), |goal| {
            Pose::new(goal.position.x, goal.position.y, goal.heading.unwrap_or(0.0))
        });
        Self { start, goal }
    }

    /// Path length plus the cost of its sharpest bend.
    pub(crate) fn cost(&self, genes: &[f64]) -> Result<f64> {
        let path = self.path(genes)?;
        Ok(path.length() + BEND * path.max_curvature() * path.max_curvature())
    }

    fn path(&self, genes: &[f64]) -> Result<Path> {
        Path::hermite(self.start, self.goal, scale(genes))
    }

    pub(crate) fn found(&self, genes: &[f64]) -> Result<Map<String, Value>> {
        let path = self.path(genes)?;
        let fields = json!({
            "scale": rounded(scale(genes)),
            "length_mm": millimetres(path.length()),
            "radius_mm": millimetres(1.0 / path.max_curvature()),
        });
        Ok(fields.as_object().cloned().unwrap_or_default())
    }

    /// The splines of the last generation, and the best of all.
    pub(crate) fn picture(&self, population: &Population<Vec<f64>>, best: &[f64]) -> Picture {
        let (start, goal) = (self.start, self.goal);
        let corner = |a: f64, b: f64| a.max(b) + 0.5;
        let mut picture = Picture::new(&World::empty(corner(start.x, goal.x), corner(start.y, goal.y)));
        picture.title("splines of the last generation");
        for genes in &population.genomes {
            let style = Style::aid().labelled("last generation");
            picture.line(self.points(&super::evolve::inside(genes)), style);
        }
        picture.line(self.points(best), Style::true_path().labelled("best of all"));
        picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal.position());
        picture
    }

    /// The path's points; empty without a path.
    fn points(&self, genes: &[f64]) -> Vec<Point> {
        let path = self.path(genes);
        path.map_or_else(
            |_| Vec::new(),
            |path| path.points().iter().map(|point| point.pose.position()).collect(),
        )
    }
}

/// Scale encoded by the genes: 0.1 to 6.
fn scale(genes: &[f64]) -> f64 {
    0.1 + 5.9 * genes[0]
}
