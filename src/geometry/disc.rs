use super::{Point, Vector, cross};

/// How far a disc about the origin can move in a direction, a unit vector, until it touches one of some points, and which: in
/// metres, infinite where none is in the way. Less than 0 for a point ahead that lies within the disc already; what lies
/// behind its middle does not count.
///
/// ```
/// use roverlab::geometry::{Point, Vector, free_distance};
/// let points = [Point::new(1.0, 0.03), Point::new(2.0, 0.0), Point::new(-0.01, 0.0)];
/// let (free, touched) = free_distance(&points, Vector::x(), 0.05);
/// assert!((free - 0.96).abs() < 1e-12 && touched == Some(points[0]));
/// ```
pub fn free_distance(points: &[Point], towards: Vector, radius: f64) -> (f64, Option<Point>) {
    let mut free = (f64::INFINITY, None);
    for point in points {
        let along = point.coords.dot(&towards);
        if along <= 0.0 {
            continue;
        }
        let across = cross(towards, point.coords);
        let depth = radius * radius - across * across;
        if depth > 0.0 {
            let distance = along - depth.sqrt();
            if distance < free.0 {
                free = (distance, Some(*point));
            }
        }
    }
    free
}
