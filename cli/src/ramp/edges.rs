use roverlab::geometry::{Point, Pose3};
use roverlab::world::{Footprint, HeightField};

/// Edges of a surface: places where it drops within a cell.
#[derive(Debug, Clone)]
pub(crate) struct Edges {
    /// Middle of a cell, and the elevations of its lowest and highest corner.
    places: Vec<(Point, f64, f64)>,
}

/// Drop within a cell that is an edge (m), and its smallest slope: 45 degrees.
const DROP: f64 = 0.03;
const STEEP: f64 = 1.0;

impl Edges {
    pub(crate) fn of(ground: &HeightField) -> Self {
        let (area, pitch) = (ground.area(), ground.pitch());
        let mut places = Vec::new();
        for row in 0..ground.rows() - 1 {
            for column in 0..ground.columns() - 1 {
                let corners =
                    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| ground.sample(column + x, row + y));
                let low = corners.into_iter().fold(f64::INFINITY, f64::min);
                let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
                if high - low > DROP && high - low > STEEP * pitch.min() {
                    let (x, y) = ((column as f64 + 0.5) * pitch.x, (row as f64 + 0.5) * pitch.y);
                    places.push((Point::new(area.min.x + x, area.min.y + y), low, high));
                }
            }
        }
        Self { places }
    }

    /// Distance between a robot's outline and the nearest edge that it could fall off (m); infinite without
    /// any.
    pub(crate) fn distance(&self, footprint: &Footprint, pose: &Pose3) -> f64 {
        let (level, flat) = (pose.position.z, pose.pose());
        let below = self.places.iter().filter(|(_, low, high)| level > low + DROP && level > high - DROP);
        below.map(|(place, ..)| outside(footprint, flat.to_local(*place))).fold(f64::INFINITY, f64::min)
    }
}

/// Distance of a place in a robot's frame from its outline (m).
fn outside(footprint: &Footprint, place: Point) -> f64 {
    match footprint {
        Footprint::Rectangle(outline) => {
            let away = (outline.min - place).sup(&(place - outline.max));
            away.sup(&roverlab::geometry::Vector::zeros()).norm()
        }
        _ => (place.coords.norm() - footprint.bounding_radius()).max(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roverlab::geometry::{Aabb, Pose};

    #[test]
    fn only_edges_below_the_robot_count() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
        let ground = HeightField::from_fn(201, 201, area, |at| if at.x > 1.0 { 0.0 } else { 0.2 }).unwrap();
        let edges = Edges::of(&ground);
        let footprint = Footprint::Disc { radius: 0.1 };
        let above = Pose3::level(Pose::new(0.5, 1.0, 0.0), 0.2);
        assert!((edges.distance(&footprint, &above) - 0.4).abs() < 0.01);
        let below = Pose3::level(Pose::new(1.5, 1.0, 0.0), 0.0);
        assert_eq!(edges.distance(&footprint, &below), f64::INFINITY);
        let outline = Footprint::Rectangle(Aabb::new(Point::new(-0.2, -0.1), Point::new(0.2, 0.1)));
        assert!((edges.distance(&outline, &above) - 0.3).abs() < 0.01);
    }
}
